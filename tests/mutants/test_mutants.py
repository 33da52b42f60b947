"""The mutants fit the source: what each replaces stands there once, and its tests exist (they run by a script)."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

import pytest

from tests.mutants.catalogue import BEFORE_RELEASE, MUTANTS
from tests.mutants.mutant import Mutant, MutantError, mutant

ROOT = Path(__file__).parents[2]


@cache
def text_of(file: str) -> str:
    return (ROOT / file).read_text("utf-8")


@cache
def names_in(file: str) -> frozenset[str]:
    tree = ast.parse(text_of(file))
    return frozenset(node.name for node in tree.body if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef))


def named(each: Mutant) -> str:
    return f"{each.bar}, {each.fault}"


@pytest.mark.parametrize("each", MUTANTS, ids=named)
def test_a_mutant_can_be_made_and_its_tests_exist(each: Mutant) -> None:
    broken = each.broken(text_of(each.file))
    assert broken != text_of(each.file) and each.tests
    if each.file.endswith(".py"):
        ast.parse(broken)
    for test in each.tests:
        file, _, name = test.partition("::")
        assert name.partition("[")[0] in names_in(file), test


def test_every_bar_before_release_has_a_mutant() -> None:
    assert BEFORE_RELEASE - {each.bar for each in MUTANTS} == set()


def test_no_mutant_is_there_twice() -> None:
    assert len({(each.file, each.old, each.new, each.tests) for each in MUTANTS}) == len(MUTANTS)
    assert len({named(each) for each in MUTANTS}) == len(MUTANTS)


@pytest.mark.parametrize("old", ["not there", "e"])
def test_a_mutant_that_does_not_fit_is_a_sentence(old: str) -> None:
    with pytest.raises(MutantError, match=r"R1, nothing: .* stands .* times in x\.py"):
        mutant("R1", "nothing", "x.py", old, "", "tests/x.py::test_x").broken("there there")
