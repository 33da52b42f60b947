"""`reproduce table4 --seeds 2 --profile smoke` gives the same result set under both engines, and goes on under either.

Trainings and evaluations are those of `tests/workbench/reproduce`, which learn nothing, quickly: the reproduction is
what is compared. That a training is the same under both engines is the matter of `test_ray_runs`.
"""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

import pytest

from sim.scenario_file import load_scenario
from tests.cluster.conftest import OpenEngine
from workbench import launcher
from workbench.engine import Engine, LocalEngine
from workbench.reproduce import evaluations, session
from workbench.reproduce.plan import make_plan
from workbench.reproduce.result_set import ResultSet
from workbench.reproduce.seed_counts import SeedCounts
from workbench.reproduce.session import Report, Session
from workbench.reproduce.watch import Standing, Watch
from workbench.runs import RunStore

FAKES = Path(__file__).parents[1] / "workbench/reproduce"
OF_ITS_OWN = ("run", "wall_s", "cpu_s", "policy", "command")
"""What two reproductions differ in: which run it was, where its policy lies, and how long it took."""


@pytest.fixture(autouse=True)
def _nothing_is_learned(monkeypatch: pytest.MonkeyPatch, store: RunStore) -> None:
    monkeypatch.setattr(launcher, "ENTRY", (str(FAKES / "fake_training.py"),))
    monkeypatch.setattr(evaluations, "ENTRY", (str(FAKES / "fake_workbench.py"),))
    monkeypatch.setattr(session, "TICK_S", 0.05)


def folder(root: Path) -> RunStore:
    """A runs folder with what the fakes want to know."""
    root.mkdir()
    (root / "scenario.txt").write_text(load_scenario().digest)
    (root / "told.json").write_text("{}")
    return RunStore(root)


class Impatient(Watch):
    """Says nothing; presses Ctrl-C when so many trainings have ended."""

    def __init__(self, ctrl_c_at: int = 1000) -> None:
        super().__init__()
        self.lines: list[str] = []
        self._ctrl_c_at = ctrl_c_at

    def say(self, text: str) -> None:
        self.lines.append(text)

    def show(self, standing: Standing) -> None:
        if standing.trained >= self._ctrl_c_at:
            raise KeyboardInterrupt


def reproduce(store: RunStore, engine: Engine, watch: Watch | None = None) -> Report:
    plan = make_plan("table4", "smoke", SeedCounts.each(2), 100)
    return Session([plan], store, store.root / "results", engine=engine).run(watch or Impatient())


def essence(result: ResultSet) -> dict[str, Any]:
    """A result set but for what two reproductions differ in; trainings and numbers in the plan's order."""
    values = json.loads(json.dumps(dataclasses.asdict(result)))
    for name in ("trainings", "numbers"):
        values[name] = [{key: value for key, value in row.items() if key not in OF_ITS_OWN} for row in values[name]]
    return values


def test_table4_is_the_same_under_both_engines_also_when_it_was_interrupted(tmp_path: Path, engine: OpenEngine) -> None:
    here, there = folder(tmp_path / "here"), folder(tmp_path / "there")
    local = reproduce(here, LocalEngine(here))
    watch = Impatient(ctrl_c_at=3)
    with engine(store=there) as ray:
        assert reproduce(there, ray, watch).interrupted
    assert "the same command" in watch.lines[-1] and "in the background" not in watch.lines[-1]
    assert not any(run.is_alive() for run in there.list()), "nothing goes on without its command"
    with engine(store=there) as ray:
        report = reproduce(there, ray)
    assert len(report.failures) == len(local.failures) > 0, "the policies of PPO are broken in these tests"
    ours, theirs = report.results["table4"], local.results["table4"]
    assert len(ours.trainings) == 16 and {training.state for training in ours.trainings} == {"finished"}
    assert essence(ours) == essence(theirs)
    assert {run.state.engine for run in there.list()} == {"ray"}
    assert len(there.list()) == 16, "nothing was trained twice"
