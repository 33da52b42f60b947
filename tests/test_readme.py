"""The examples of the README run, and what they print is what they promise."""

from __future__ import annotations

import contextlib
import io
import re
from pathlib import Path

import pytest

README = (Path(__file__).parents[1] / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```python\n(.*?)^```", README, re.MULTILINE | re.DOTALL)


def test_there_are_examples() -> None:
    assert len(BLOCKS) == 2


@pytest.mark.parametrize("block", BLOCKS, ids=["library", "gymnasium"])
def test_examples_run(block: str) -> None:
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(block, "README.md", "exec"), {})
    if "print(" in block:
        outcome, value, *_ = printed.getvalue().split()
        assert outcome in ("EXIT", "SHOT_DOWN", "LEFT_FIELD", "TIMEOUT")
        assert -600.0 < float(value) < 600.0
