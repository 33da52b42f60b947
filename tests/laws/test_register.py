"""The register of laws in docs/fidelity.md is true: every law, its test and its control exist, and none is left out."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs/fidelity.md"
# Determinism is a law and a bar of reliability at once; it stands with the bars.
LAWS = [*Path(__file__).parent.glob("test_*.py"), ROOT / "tests/reliability/test_determinism.py"]
NAMED = re.compile(r"`(test_\w+\.py)::(test_\w+)`")


def register(text: str) -> list[list[str]]:
    """Rows law, test, tolerance, negative control."""
    table = text.partition("| law | test | tolerance | negative control |")[2].partition("\n\n")[0]
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in table.splitlines()[2:]]
    return [row for row in rows if len(row) == 4]


def absent(text: str) -> list[str]:
    """Tests that a text names and that do not exist."""
    sources = {path.name: path.read_text(encoding="utf-8") for path in LAWS}
    return [f"{file}::{name}" for file, name in NAMED.findall(text) if f"def {name}(" not in sources.get(file, "")]


def test_every_test_that_is_named_exists() -> None:
    assert not absent(PAGE.read_text(encoding="utf-8"))


def test_every_law_names_its_test_its_tolerance_and_its_control() -> None:
    rows = register(PAGE.read_text(encoding="utf-8"))
    assert len(rows) >= 20
    for law, test, tolerance, control in rows:
        assert NAMED.search(test), law
        assert tolerance, law
        assert control, law


def test_every_law_of_flight_is_in_the_register() -> None:
    # These hold what is not about flying: imports, evaluation, this register.
    others = {"test_imports.py", "test_evaluation.py", "test_register.py"}
    named = {file for file, _ in NAMED.findall(PAGE.read_text(encoding="utf-8"))}
    assert {path.name for path in LAWS} - others == named


def test_every_file_the_page_mentions_exists() -> None:
    text = PAGE.read_text(encoding="utf-8")
    paths = re.findall(r"`((?:sim|tests|assets)/[\w./-]*)(?::\w+)?`", text)
    assert len(paths) > 8
    assert not [path for path in paths if not (ROOT / path).exists()]
    for file, symbol in re.findall(r"`(sim/[\w/]+\.py):(\w+)`", text):
        assert f"def {symbol}(" in (ROOT / file).read_text(encoding="utf-8"), symbol


@pytest.mark.parametrize("wrong", ["`test_energy.py::test_of_nothing`", "`test_of_nothing.py::test_aircraft_balance`"])
def test_a_test_that_does_not_exist_would_be_noticed(wrong: str) -> None:
    assert absent(wrong)
