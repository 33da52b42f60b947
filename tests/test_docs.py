"""Documentation is unit-tested: what exists is mentioned, and what is mentioned exists."""

from __future__ import annotations

import ast
import importlib
import re
from pathlib import Path

import pytest

from agents.config import VARIANTS
from agents.hyperparameters import PROFILES
from sim.scenario_file import scenario_names
from workbench.app import PAGES
from workbench.cli import COMMANDS
from workbench.policies import EXPERTS, shipped_policies

ROOT = Path(__file__).parents[1]
DOCUMENTS = ["README.md", "ARCHITECTURE.md", "PAPER.md", "CONTRIBUTING.md"]
TEXTS = {name: (ROOT / name).read_text(encoding="utf-8") for name in DOCUMENTS}
PACKAGES = ("sim", "agents", "layouts", "workbench")


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_is_in_the_readme(command: str) -> None:
    assert f"workbench {command}" in TEXTS["README.md"]


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_and_option_has_help(command: str) -> None:
    module = importlib.import_module(f"workbench.commands.{command}")
    assert module.Args.__doc__
    tree = ast.parse(Path(module.__file__).read_text(encoding="utf-8"))
    (arguments,) = (node for node in tree.body if isinstance(node, ast.ClassDef) and node.name == "Args")
    for node, after in zip(arguments.body, [*arguments.body[1:], ast.Pass()], strict=True):
        if isinstance(node, ast.AnnAssign):
            assert isinstance(after, ast.Expr), f"{command} {ast.unparse(node.target)} has no help"


def test_no_other_command_is_promised() -> None:
    promised = set(re.findall(r"^workbench ([a-z]+)", TEXTS["README.md"], re.MULTILINE))
    promised |= {word for text in TEXTS.values() for word in re.findall(r"`workbench ([a-z]+)", text)}
    assert promised <= set(COMMANDS)


@pytest.mark.parametrize("name", [*scenario_names(), *EXPERTS, *shipped_policies()])
def test_every_scenario_and_policy_is_in_the_readme(name: str) -> None:
    assert f"`{name}`" in TEXTS["README.md"]


@pytest.mark.parametrize("page", PAGES.values())
def test_every_page_is_in_the_readme(page: str) -> None:
    assert f"**{page}**" in TEXTS["README.md"]


@pytest.mark.parametrize("name", PROFILES)
def test_profiles_are_told_in_the_help_of_training(name: str) -> None:
    assert name in (ROOT / "workbench/commands/train.py").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", VARIANTS)
def test_variants_are_told_in_the_help_of_training_or_in_the_index(name: str) -> None:
    assert name in (ROOT / "workbench/commands/train.py").read_text(encoding="utf-8") + TEXTS["PAPER.md"]


@pytest.mark.parametrize("name", DOCUMENTS)
def test_every_file_that_is_mentioned_exists(name: str) -> None:
    text = TEXTS[name]
    mentioned = re.findall(r"`((?:sim|agents|layouts|workbench|assets|tests|scripts)/[\w./-]*)", text)
    mentioned += re.findall(r"\]\((?!https?:)([^)#]+)\)", text)
    absent = [path for path in mentioned if not (ROOT / path).exists()]
    assert not absent


@pytest.mark.parametrize("name", DOCUMENTS)
def test_every_symbol_that_is_mentioned_with_its_file_exists(name: str) -> None:
    for file, symbols in re.findall(r"`(\w+/[\w/]+\.py):([\w.,]+)`", TEXTS[name]):
        source = (ROOT / file).read_text(encoding="utf-8")
        for symbol in symbols.split(","):
            last = symbol.split(".")[-1]
            assert re.search(rf"^\s*(def|class) {last}\b|^{last}\b.*=", source, re.MULTILINE), f"{file} has no {symbol}"


@pytest.mark.parametrize("package", PACKAGES)
def test_every_module_of_the_map_says_what_it_is(package: str) -> None:
    for path in (ROOT / package).rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        assert ast.get_docstring(tree), f"{path} has no docstring"


@pytest.mark.parametrize("package", PACKAGES)
def test_no_grab_bags(package: str) -> None:
    names = {path.stem for path in (ROOT / package).rglob("*.py")}
    assert not names & {"utils", "util", "helpers", "common", "misc"}


def test_nothing_unpickles() -> None:
    for package in PACKAGES:
        for path in (ROOT / package).rglob("*.py"):
            source = path.read_text(encoding="utf-8")
            assert not re.search(r"\bimport (pickle|dill|cloudpickle|shelve|marshal)\b|torch\.load\(", source), path


def test_every_module_of_sim_has_its_tests() -> None:
    for path in (ROOT / "sim").glob("*.py"):
        if path.stem != "__init__":
            assert (ROOT / f"tests/sim/test_{path.stem}.py").is_file(), f"no tests/sim/test_{path.stem}.py"
