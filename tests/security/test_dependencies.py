"""S16: what is installed is what was tested, floors keep known holes out, and nothing is used that is not declared."""

from __future__ import annotations

import ast
import importlib.metadata
import importlib.util
import sys
import tomllib
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from tests.security.sources import PACKAGES, ROOT, trees

PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
DECLARED = {canonicalize_name(each.name): each for each in map(Requirement, PROJECT["dependencies"])}
EXTRAS = {
    canonicalize_name(each.name): each
    for group in PROJECT["optional-dependencies"].values()
    for each in map(Requirement, group)
}
PINS = {
    canonicalize_name(pin.name): Version(str(pin.specifier).removeprefix("=="))
    for line in (ROOT / "constraints.txt").read_text().splitlines()
    if (text := line.partition("#")[0].strip()) and (pin := Requirement(text))
}
HOLES = {
    "bokeh": ("3.8.2", "websocket origins of look-alike hosts (CVE-2026-21883)"),
    "viser": ("1.1.1", "any file of the machine was served"),
    "torch": ("2.10", "weights_only could be passed by (CVE-2025-32434, CVE-2026-24747)"),
    "tornado": ("6.5", "requests were smuggled and headers cost the square of their length"),
    "pillow": ("11.3", "a picture could write past its buffer"),
    "pyarrow": ("14.0.1", "reading IPC or Parquet could run code (CVE-2023-47248)"),
    "numpy": ("1.16.3", "np.load unpickled by default (CVE-2019-6446)"),
    "jinja2": ("3.1.6", "the sandbox could be left (CVE-2025-27516)"),
}
"""The first version without it, and what the hole was."""
OPTIONAL = {
    canonicalize_name(Requirement(each).name)
    for group, wanted in PROJECT["optional-dependencies"].items()
    if group != "test"
    for each in wanted
} | {"tensorboard", "playwright"}
"""What the program may import when a person asks for it; Playwright only to measure the pages."""
MODULES = {"warp": "warp-lang", "rerun": "rerun-sdk", "rerun_cli": "rerun-sdk", "PIL": "pillow", "av": "av",
           "stable_baselines3": "stable-baselines3", "panel_material_ui": "panel-material-ui"}  # fmt: skip


@pytest.mark.parametrize("name", sorted(DECLARED | EXTRAS))
def test_the_tested_version_is_within_what_is_declared(name: str) -> None:
    wanted = (DECLARED | EXTRAS)[name]
    if name not in PINS:
        assert name in EXTRAS and importlib.util.find_spec(name) is None, f"{name} is used and not in constraints.txt"
        return
    assert wanted.specifier.contains(PINS[name], prereleases=True), f"{wanted} does not take the tested {PINS[name]}"


@pytest.mark.parametrize("name", sorted(PINS))
def test_what_is_installed_is_what_was_tested(name: str) -> None:
    try:
        found = Version(importlib.metadata.version(name))
    except importlib.metadata.PackageNotFoundError:
        assert name not in DECLARED
        return
    assert found.public == PINS[name].public or found.base_version == PINS[name].base_version


@pytest.mark.parametrize("name", HOLES)
def test_no_version_with_a_known_hole_is_taken(name: str) -> None:
    safe, what = HOLES[name]
    assert PINS[name] >= Version(safe), what
    if name in DECLARED:
        below = f"{Version(safe).major - 1 if '.' not in safe else safe}.dev0"
        assert not DECLARED[name].specifier.contains(below, prereleases=True), f"{name} before {safe}: {what}"
        assert any(each.operator in (">=", "==", "~=") for each in DECLARED[name].specifier), "there is a floor"


def test_every_dependency_has_a_floor() -> None:
    floorless = [
        name for name, each in DECLARED.items() if not {"==", ">=", "~="} & {s.operator for s in each.specifier}
    ]
    assert floorless == []


def test_the_installed_metadata_declares_the_same() -> None:
    # `make run` installs by pyproject.toml; the doctor compares with the metadata.
    requires = map(Requirement, importlib.metadata.requires("submas-workbench") or [])
    installed = {canonicalize_name(each.name) for each in requires if each.marker is None}
    assert installed <= set(DECLARED), "a dependency was dropped; install again"


def test_nothing_is_imported_that_is_not_declared() -> None:
    own = {*PACKAGES, "tests", "assets"}
    undeclared = set()
    for path, tree in trees(*PACKAGES).items():
        for node in ast.walk(tree):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom) and node.module and not node.level:
                names = [node.module]
            for top in {name.partition(".")[0] for name in names} - own - set(sys.stdlib_module_names):
                if canonicalize_name(MODULES.get(top, top)) not in {*DECLARED, *OPTIONAL}:
                    undeclared.add(f"{top} in {path.relative_to(ROOT)}")
    assert undeclared == set()


@pytest.mark.parametrize("name", sorted(DECLARED))
def test_every_declared_package_can_be_imported(name: str) -> None:
    module = {distribution: module for module, distribution in MODULES.items() if module != "rerun_cli"}.get(name, name)
    assert importlib.util.find_spec(module.replace("-", "_")) is not None


def test_no_file_of_the_repository_is_fetched_from_elsewhere() -> None:
    loads = ('<script src="http', 'import("http', 'from "http', "@import url(http", "url(http", 'fetch("http')
    files = [path for kind in ("js", "css", "html") for path in Path(ROOT, "workbench").rglob(f"*.{kind}")]
    assert len(files) > 30
    assert [path.name for path in files if any(each in path.read_text("utf-8") for each in loads)] == []
