"""Seeds as people write them."""

from __future__ import annotations

import pytest

from sim.errors import UsageError
from workbench.seeds import parse_seeds


@pytest.mark.parametrize(
    ("text", "seeds"), [("0", [0]), ("0,1,2", [0, 1, 2]), ("0-4", [0, 1, 2, 3, 4]), ("3, 0-2,3", [3, 0, 1, 2])]
)
def test_seeds(text: str, seeds: list[int]) -> None:
    assert parse_seeds(text) == seeds


@pytest.mark.parametrize(
    "text", ["", "-1", "1-0", "0-100", "a", "1,,2", "1e3", "9999999999", "0-50,51-102", "x" * 10_000, "0 1"]
)
def test_anything_else_is_refused_in_one_sentence(text: str) -> None:
    with pytest.raises(UsageError, match="seeds") as refused:
        parse_seeds(text)
    assert len(str(refused.value)) < 200
