"""The doctor names what is wrong and what to do; every check is made to fail once."""

from __future__ import annotations

import importlib.metadata
import json
import os
import platform
import shutil
import socket
from collections.abc import Callable
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from agents import numerics
from agents.config import TrainingConfig
from workbench import cli
from workbench.commands import doctor, doctor_folders, doctor_machine
from workbench.commands.doctor_machine import REINSTALL, Missing, dependency
from workbench.run_files import take_lock
from workbench.run_index.file import NAME
from workbench.run_index.index import RunIndex
from workbench.runs import RunStore

Patch = pytest.MonkeyPatch


def test_what_it_says_is_one_json_object(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code = doctor.run(doctor.Args(runs=tmp_path, port=0, json=True))
    said = json.loads(capsys.readouterr().out)
    assert code == (0 if said["ok"] else 1)
    found = {check["name"]: check for check in said["checks"]}
    assert {name for name, _, _ in doctor.probes(tmp_path, 0)} | {"torch", "panel", "viser"} <= set(found)
    assert found["torch"]["found"].startswith("2.13.0")
    assert all(check["ok"] or check["advice"] for check in said["checks"])
    assert {check["state"] for check in said["checks"]} <= {"ok", "note", "wrong"}
    assert all((check["state"] == "wrong") == (check["needed"] and not check["ok"]) for check in said["checks"])
    assert list(tmp_path.iterdir()) == [], "looking leaves nothing behind"


def test_something_needed_that_is_wrong_fails_with_what_to_do(
    tmp_path: Path, monkeypatch: Patch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "runs").write_text("")
    only = [("runs folder", lambda: doctor_folders.writable(tmp_path / "runs"), True)]
    monkeypatch.setattr(doctor, "dependencies", lambda: iter(()))
    monkeypatch.setattr(doctor, "probes", lambda runs, port: only)
    assert cli.main(["doctor", "--runs", str(tmp_path / "runs")]) == 1
    line = capsys.readouterr().out.splitlines()[1]
    assert line.startswith("wrong") and "choose another with --runs" in line
    monkeypatch.setattr(doctor, "probes", lambda runs, port: [(name, probe, False) for name, probe, _ in only])
    assert doctor.run(doctor.Args(runs=tmp_path / "runs")) == 0
    assert capsys.readouterr().out.splitlines()[1].startswith("note")


@pytest.mark.parametrize(
    ("wanted", "found"),
    [
        ("numpy>=1", ""),
        ("numpy>=99", "needs >=99"),
        ("numpy==2.4.*,<2", "needs"),
        ("no-such-thing>=1", "not installed"),
    ],
)
def test_a_dependency_is_compared_with_what_is_declared(wanted: str, found: str) -> None:
    if not found:
        assert dependency(Requirement(wanted)) == importlib.metadata.version("numpy")
        return
    with pytest.raises(Missing, match=found) as caught:
        dependency(Requirement(wanted))
    assert caught.value.advice == REINSTALL


def no_such(*_: object, **__: object) -> None:
    raise importlib.metadata.PackageNotFoundError


def served_elsewhere(runs: Path) -> int:
    """A port that a stranger holds; given back when the test process ends."""
    held = socket.create_server(("127.0.0.1", 0))
    KEPT.append(held)
    return held.getsockname()[1]


KEPT: list[socket.socket] = []


def damaged_index(runs: Path) -> None:
    RunStore(runs).create(TrainingConfig(profile="smoke", missiles=1))
    index = RunIndex(runs)
    index.look()
    index.close()
    content = bytearray((runs / NAME).read_bytes())
    content[:16] = b"not a database!!"
    (runs / NAME).write_bytes(content)


def old_index(runs: Path) -> None:
    shutil.copyfile(Path(__file__).parents[1] / "golden" / "first-index.sqlite", runs / NAME)


def bad_run(runs: Path) -> None:
    store = RunStore(runs)
    store.create(TrainingConfig(profile="smoke", missiles=1))
    (store.create(TrainingConfig(profile="smoke", missiles=1)).path / "config.json").write_text("{")


def token_in_lock(runs: Path) -> None:
    (runs / ".serve.lock").write_text("http://127.0.0.1:1/?token=x\n")


FAILURES: dict[str, tuple[Callable[[Patch, Path], object], str, str]] = {
    "Python": (lambda m, _: m.setattr(platform, "python_version", lambda: "3.10.2"), "3.10.2", "install Python 3.11"),
    "tested versions": (
        lambda m, _: m.setattr(importlib.metadata, "version", lambda name: "0.0.1"), "0.0.1 (tested: ", "install again",
    ),
    "simulator kernel": (
        lambda m, _: m.setattr("sim.world.World.step", lambda *_: 1 / 0), "ZeroDivisionError", "install again",
    ),
    "Warp device": (
        lambda m, _: m.setattr("warp.is_cpu_available", lambda: False), "cannot compile", "force-reinstall warp-lang",
    ),
    "matrix products": (
        lambda m, _: m.setattr(numerics, "relative_error", lambda *_: 1e-3), "wrong by 1.0e-03", "the paper's",
    ),
    "graphics card": (lambda m, _: m.setattr("torch.cuda.is_available", lambda: False), "none", "nothing to do"),
    "shipped policies": (
        lambda m, _: m.setattr("workbench.policies.shipped_policies", list), "none", "get assets/policies",
    ),
    "runs folder": (lambda _, runs: (runs.rmdir(), runs.write_text("")), "File exists", "choose another with --runs"),
    "locks": (
        lambda m, _: m.setattr("workbench.run_files.is_locked", lambda path: False), "no effect", "on a local disk",
    ),
    "permissions": (lambda _, runs: runs.chmod(0o777), "everybody may write", "chmod o-w"),
    "free disk": (
        lambda m, _: m.setattr(shutil, "disk_usage", lambda _: shutil._ntuple_diskusage(1, 1, 10**8)), "0.1", "free",
    ),
    "runs": (lambda _, runs: bad_run(runs), "1 of 2 cannot be read", "workbench runs delete"),
    "index of the runs": (lambda _, runs: damaged_index(runs), "cannot be read", "makes it anew"),
    "port": (lambda _, runs: None, "in use", "--port 0"),
    "Rerun viewer": (
        lambda m, _: m.setattr("workbench.viewer_files.ensure_viewer", lambda: 1 / 0), "ZeroDivisionError", "install",
    ),
    "Chromium": (lambda m, _: m.setenv("CHROMIUM", "/nowhere/chromium"), "/nowhere/chromium is no program", "apt-get"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAILURES)
def test_each_check_can_fail_and_says_what_to_do(name: str, tmp_path: Path, monkeypatch: Patch) -> None:
    runs = tmp_path / "runs"
    runs.mkdir()
    port = served_elsewhere(runs) if name == "port" else 0
    break_it, found, advice = FAILURES[name]
    break_it(monkeypatch, runs)
    probe = next(each for each in doctor.probes(runs, port) if each[0] == name)
    check = doctor.look(*probe)
    assert not check.ok and check.state in ("note", "wrong")
    assert found in check.found and advice in check.advice


def test_every_check_is_made_to_fail(tmp_path: Path) -> None:
    assert {name for name, _, _ in doctor.probes(tmp_path, 0)} == set(FAILURES)


def test_more_that_may_be_wrong_with_the_folder(tmp_path: Path) -> None:
    token_in_lock(tmp_path)
    with pytest.raises(Missing, match="holds a token"):
        doctor_folders.permissions(tmp_path)
    old_index(tmp_path)
    with pytest.raises(Missing, match="another version"):
        doctor_folders.index(tmp_path)


def test_a_served_folder_is_no_port_in_the_way(tmp_path: Path) -> None:
    port = served_elsewhere(tmp_path)
    lock = take_lock(tmp_path / ".serve.lock")
    assert lock is not None
    (tmp_path / ".serve.lock").write_text(f"http://127.0.0.1:{port}/ (process 1)\n")
    assert "served at http" in doctor_folders.port_free(tmp_path, port)
    os.close(lock)
    with pytest.raises(Missing, match="in use"):
        doctor_folders.port_free(tmp_path, port)


def test_without_the_package_all_that_is_said_is_to_install_it(monkeypatch: Patch) -> None:
    monkeypatch.setattr(importlib.metadata, "requires", no_such)
    checks = [doctor.look(*each) for each in doctor_machine.dependencies()]
    assert [(check.name, check.ok, check.found) for check in checks] == [("submas-workbench", False, "not installed")]
