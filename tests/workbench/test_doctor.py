"""The doctor names what is missing and the way out."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from packaging.requirements import Requirement

from workbench.commands import doctor


def test_what_it_says_is_one_json_object(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code = doctor.run(doctor.Args(runs=tmp_path, json=True))
    said = json.loads(capsys.readouterr().out)
    assert code == (0 if said["ok"] else 1)
    found = {check["name"]: check for check in said["checks"]}
    assert {"Python", "torch", "simulator kernel", "shipped policies", "Rerun viewer", "Chromium"} <= set(found)
    assert found["torch"]["found"].startswith("2.13.0")
    assert all(check["ok"] or check["advice"] for check in said["checks"])


def test_something_needed_that_is_missing_fails_with_the_way_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "runs").write_text("")
    monkeypatch.setattr(doctor, "_dependencies", lambda: iter(()))
    monkeypatch.setattr(doctor, "_probes", lambda runs: [("runs folder", lambda: doctor._writable(runs), True)])
    assert doctor.run(doctor.Args(runs=tmp_path / "runs")) == 1
    line = capsys.readouterr().out.splitlines()[1]
    assert line.startswith("MISSING")
    assert "choose another with --runs" in line


@pytest.mark.parametrize(("wanted", "ok"), [("numpy>=1", True), ("numpy>=99", False), ("no-such-thing>=1", False)])
def test_a_dependency_is_compared_with_what_is_wanted(wanted: str, ok: bool) -> None:
    check = doctor._dependency(Requirement(wanted))
    assert check.ok is ok
    assert ok or check.advice == doctor.REINSTALL
