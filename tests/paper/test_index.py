"""`PAPER.md` is true: every item of the paper has one home that names it, and tests; or it is said to be missing."""

from __future__ import annotations

import ast
import dataclasses
import re
from pathlib import Path
from typing import NamedTuple

import pytest

from agents.hyperparameters import FAST, PAPER

ROOT = Path(__file__).parents[2]
TEXT = (ROOT / "PAPER.md").read_text(encoding="utf-8")
ITEMS = [
    *(f"Eq. {n}" for n in range(3, 22)),
    *(f"Algorithm {n}" for n in range(1, 6)),
    *(f"Definition {n}" for n in (1, 2)),
    *(f"Table {n}" for n in range(1, 5)),
    *(f"Fig. {n}" for n in range(8, 14)),
]
"""What must be found, as PAPER.md writes it. Eq. 1 and 2 define return and value; there is nothing to build."""

WORDS = {
    "Eq.": r"Eqs?\.",
    "Algorithm": "Algorithms?",
    "Definition": "Definitions?",
    "Table": "Tables?",
    "Fig.": r"Figs?\.",
}
KIND = "|".join(re.escape(kind) for kind in WORDS)


class Row(NamedTuple):
    """One line of the index."""

    item: str
    file: str
    symbols: tuple[str, ...]
    """Empty when the home is a whole module."""
    tests: tuple[str, ...]


def section(title: str) -> str:
    """The text under a second-level heading."""
    found = re.search(rf"^## {re.escape(title)}\n(.*?)(?=^## |\Z)", TEXT, re.MULTILINE | re.DOTALL)
    assert found, f"PAPER.md has no section '{title}'"
    return found[1]


def rows() -> list[Row]:
    """All lines of the index."""
    result = []
    for line in section("Where to find what").splitlines():
        if not re.match(rf"\| ({KIND}) \d", line):
            continue
        item, _, home, tests = (cell.strip() for cell in line.strip("|").split(" | "))
        file, _, symbols = home.strip("`").partition(":")
        names = tuple(name for name in symbols.split(",") if name)
        result.append(Row(item, file, names, tuple(re.findall(r"`([^`]+)`", tests))))
    return result


def missing() -> list[str]:
    """Items that PAPER.md says are planned."""
    return re.findall(rf"^\* ((?:{KIND}) \d+)\b", section("Not yet here"), re.MULTILINE)


ROWS = rows()


def docstring(file: str, symbol: str) -> str | None:
    """Docstring of a class, function, method or constant (the text below it), of the module for an empty symbol."""
    node: ast.AST = ast.parse((ROOT / file).read_text(encoding="utf-8"))
    for name in filter(None, symbol.split(".")):
        node = member(node, name)
        if isinstance(node, ast.Constant):
            return str(node.value)
    assert isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef)
    return ast.get_docstring(node)


def member(parent: ast.AST, name: str) -> ast.AST:
    """The definition of a name in a module or class; for a constant the text that follows it."""
    body = parent.body  # type: ignore[attr-defined]
    for node, after in zip(body, [*body[1:], ast.Pass()], strict=True):
        if isinstance(node, ast.ClassDef | ast.FunctionDef) and node.name == name:
            return node
        targets = [node.target] if isinstance(node, ast.AnnAssign) else getattr(node, "targets", [])
        if any(isinstance(target, ast.Name) and target.id == name for target in targets):
            assert isinstance(after, ast.Expr) and isinstance(after.value, ast.Constant), f"{name} has no docstring"
            return after.value
    raise AssertionError(f"there is no {name}")


def numbers_named(kind: str, text: str) -> set[int]:
    """Numbers that a text names after a word: `Eq. (10-12)` and `Eq. 16, 20` name 10, 11, 12 and 16, 20."""
    found: set[int] = set()
    for listed in re.findall(WORDS[kind] + r"\s+((?:\(?\d+\)?(?:\s*(?:-|–|,|and)\s*)?)+)", text):
        for first, last in re.findall(r"(\d+)\)?(?:\s*[-–]\s*\(?(\d+))?", listed):
            found |= set(range(int(first), int(last or first) + 1))
    return found


@pytest.mark.parametrize("item", ITEMS)
def test_every_item_has_exactly_one_place(item: str) -> None:
    homes = [row for row in ROWS if row.item == item]
    planned = missing().count(item)
    assert len(homes) + planned == 1, f"{item}: {len(homes)} rows, {planned} times planned"


def test_nothing_else_is_listed() -> None:
    assert {row.item for row in ROWS} | set(missing()) == set(ITEMS)


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.item)
def test_the_home_exists_and_names_the_item(row: Row) -> None:
    kind, _, number = row.item.rpartition(" ")
    for symbol in row.symbols or ("",):
        text = docstring(row.file, symbol)
        assert text, f"{row.file}:{symbol} has no docstring"
        assert int(number) in numbers_named(kind, text), f"{row.file}:{symbol} does not name {row.item}: {text}"


@pytest.mark.parametrize("row", ROWS, ids=lambda row: row.item)
def test_the_tests_exist(row: Row) -> None:
    assert row.tests
    for test in row.tests:
        assert (ROOT / test).is_file(), f"{row.item}: no {test}"
        assert re.search(r"^ *def test_", (ROOT / test).read_text(encoding="utf-8"), re.MULTILINE)


def test_every_test_of_the_paper_is_in_the_index() -> None:
    listed = {test for row in ROWS for test in row.tests}
    present = {str(path.relative_to(ROOT)) for path in (ROOT / "tests/paper").glob("test_*.py")}
    assert present - listed == {"tests/paper/test_index.py"}


def written(value: object) -> str:
    """A setting as PAPER.md writes it."""
    return str(value) if isinstance(value, bool | str | tuple) else f"{value:g}"


def test_the_fast_profile_differs_exactly_as_listed() -> None:
    table = section("What the `fast` profile does differently")
    listed = re.findall(r"^\| `(\w+)` \| (\S+) \| (\S+) \| .+ \|$", table, re.MULTILINE)
    names = [field.name for field in dataclasses.fields(PAPER)]
    different = [
        (name, written(getattr(PAPER, name)), written(getattr(FAST, name)))
        for name in names
        if getattr(PAPER, name) != getattr(FAST, name)
    ]
    assert listed == different, "PAPER.md should list " + "; ".join(map(str, different))


@pytest.mark.parametrize(
    ("text", "named"),
    [
        ("Eq. (13), §3.3.1.", {13}),
        ("reward terms (Eq. 9-11)", {9, 10, 11}),
        ("Eq. 16 and 20, or", {16, 20}),
        ("Eq. (20) with δ_α, Eq. (21) with δ_ε", {20, 21}),
        ("Algorithm 4, line 24 (Eq. 16, 20)", {16, 20}),
        ("Equation-free", set()),
        ("Eq. 5–6 and Table 1", {5, 6}),
    ],
)
def test_how_numbers_are_read(text: str, named: set[int]) -> None:
    assert numbers_named("Eq.", text) == named
