"""Every promise of the pages on security and reliability names tests, and the tests exist."""

from __future__ import annotations

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGES = ("docs/reliability.md", "docs/security.md")
NAMED = re.compile(r"`(tests/[\w/]+\.py)(?:::(\w+))?`")


@pytest.mark.parametrize("document", PAGES)
def test_every_promise_names_a_test(document: str) -> None:
    table = (ROOT / document).read_text("utf-8").partition("## What is promised")[2].partition("\n## ")[0]
    lines = [line for line in table.splitlines() if line.startswith("| ") and not line.startswith("| promise")]
    assert len(lines) > 10
    assert [line for line in lines if not NAMED.search(line.rpartition(" | ")[2])] == []


@pytest.mark.parametrize("document", PAGES)
def test_every_named_test_exists(document: str) -> None:
    missing = []
    for path, name in NAMED.findall((ROOT / document).read_text("utf-8")):
        file = ROOT / path
        tree = ast.parse(file.read_text("utf-8")) if file.is_file() else ast.Module([], [])
        known = {node.name for node in tree.body if isinstance(node, ast.FunctionDef) and node.name.startswith("test_")}
        if not file.is_file() or (name and name not in known):
            missing.append(f"{path}::{name}")
    assert missing == []


@pytest.mark.parametrize("folder", ["security", "reliability"])
def test_every_file_of_these_tests_is_named(folder: str) -> None:
    named = {path for page in PAGES for path, _ in NAMED.findall((ROOT / page).read_text("utf-8"))}
    there = {str(path.relative_to(ROOT)) for path in (ROOT / "tests" / folder).glob("test_*.py")}
    assert there - named == set()


def test_the_policy_leads_to_both_pages() -> None:
    text = (ROOT / "SECURITY.md").read_text("utf-8")
    assert all(f"({page})" in text for page in PAGES)
