"""The project's own sources, read and parsed once."""

from __future__ import annotations

import ast
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[2]
PACKAGES = ("sim", "agents", "layouts", "workbench", "scripts")


@cache
def trees(*folders: str) -> dict[Path, ast.Module]:
    """The syntax tree of every Python file below these folders of the repository."""
    paths = (path for folder in folders for path in sorted((ROOT / folder).rglob("*.py")))
    return {path: _tree(path) for path in paths}


@cache
def _tree(path: Path) -> ast.Module:
    return ast.parse(path.read_text("utf-8"))


def calls(tree: ast.Module) -> list[ast.Call]:
    """Every call in a file."""
    return [node for node in ast.walk(tree) if isinstance(node, ast.Call)]
