"""The Live page without a browser: what it shows, and that runs hold no markup."""

from __future__ import annotations

import os
from pathlib import Path

import panel as pn
import pytest

from agents.config import TrainingConfig
from workbench import launcher
from workbench.context import AppContext
from workbench.pages.address import search
from workbench.pages.live import LivePage, stage_tasks
from workbench.pages.live_cards import event_list, head, number_cards, stage_cards
from workbench.pages.live_watch import RunWatch
from workbench.run_files import append_line
from workbench.run_state import RunState
from workbench.runs import Run

pytestmark = pytest.mark.filterwarnings("ignore:The inplace keyword")  # Bokeh 3.9 under pandas 3.1

HOSTILE = "<img src=x onerror=alert(1)>"
ROW = {
    "stage": 1, "stages": 4, "task": "source-2", "missiles": [1, 2], "epoch": 3, "epochs": 100, "alpha": 0.91,
    "epsilon": 0.74, "beta": 0.1, "success_rate": 0.5, "return_mean": 12.0, "train_success_rate": 0.4,
    "train_return_mean": 9.0, "transfer_share": 0.66, "critic_loss": 0.01, "actor_loss": -0.2, "q_mean": -3.0,
    "updates_per_s": 321.0, "env_steps_per_s": 5000.0, "wall_s": 9.0, "eta_s": 60.0,
}  # fmt: skip


@pytest.fixture
def app(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AppContext:
    """Pages of an empty runs folder; nothing that is launched starts a process."""
    pn.extension("tabulator", notifications=True)
    monkeypatch.setattr(launcher, "cpu_count", lambda: 2)
    return AppContext.of(tmp_path / "runs")


def test_addresses_are_quoted() -> None:
    assert search({"run": "a&b=<c>", "theme": ""}) == "?run=a%26b%3D%3Cc%3E"
    assert search({}) == ""


# Live


def test_no_run_yet_is_said(app: AppContext) -> None:
    page = LivePage(app)
    assert "No run yet" in page._alert.object
    assert not page._run_views.visible


def _learning(app: AppContext, **config: object) -> Run:
    run = app.store.create(TrainingConfig.from_json({"curriculum": True, **config}))
    append_line(run.path / "metrics.jsonl", {**ROW, "stage": 0, "task": "source-3", "success_rate": 1.0})
    append_line(run.path / "metrics.jsonl", ROW)
    append_line(run.path / "events.jsonl", {"kind": "best", "wall_s": 75.0, "text": f"better {HOSTILE}"})
    run.write_state(RunState("running", stage=1, stages=4, progress=0.3, eta_s=60.0, wall_s=80.0))
    return run


def test_a_run_is_shown_as_it_learns(app: AppContext) -> None:
    run = _learning(app)
    lock = run.claim()
    page = LivePage(app)
    assert page._picker.value == run.id
    assert "stage 2 of 4 · source-2 · epoch 3 of at most 100" in page._html["head"].object
    assert "1:20 worked, at most 1:00 left" in page._html["head"].object
    assert page._html["stages"].object.count('class="stage ') == 4
    assert "100.0 %" in page._html["stages"].object
    assert "0.910" in page._html["numbers"].object
    assert page._progress.value == 30
    append_line(run.path / "metrics.jsonl", {**ROW, "epoch": 4})
    page._tick()
    assert "epoch 4 of" in page._html["head"].object
    os.close(lock or 0)
    page._tick()
    assert "interrupted" in page._html["head"].object


def test_nothing_is_drawn_again_while_nothing_changes(app: AppContext, monkeypatch: pytest.MonkeyPatch) -> None:
    _learning(app)
    page = LivePage(app)
    monkeypatch.setattr(page, "_show", _never)
    for _ in range(20):
        page._tick()


def _never(_: object) -> None:
    raise AssertionError("drawn again")


def test_stop_asks_first_and_then_stops(app: AppContext) -> None:
    run = _learning(app)
    lock = run.claim()
    page = LivePage(app)
    page._ask(None)
    assert page._dialog.open
    assert not run.stop_requested()
    page._confirmed(None)
    assert run.stop_requested()
    assert not page._dialog.open
    assert page._stop.disabled
    os.close(lock or 0)


def test_damaged_metrics_are_said_and_the_rest_is_shown(app: AppContext) -> None:
    run = _learning(app)
    with (run.path / "metrics.jsonl").open("a") as file:
        file.write("{}\n")
    page = LivePage(app)
    assert "Not all of this run can be shown: metrics.jsonl has a row without" in page._alert.object


def test_a_watch_reads_every_row_once(app: AppContext) -> None:
    run = _learning(app)
    watch = RunWatch(run)
    assert watch.look()
    assert not watch.look()
    append_line(run.path / "metrics.jsonl", {**ROW, "epoch": 4})
    assert watch.look()
    assert [row["epoch"] for row in watch.rows] == [3, 3, 4]


def test_tasks_of_a_training_in_order() -> None:
    assert stage_tasks(TrainingConfig(curriculum=True)) == ["source-3", "source-2", "source-1", "target"]
    assert stage_tasks(TrainingConfig(missiles=2)) == ["source-2"]


def test_nothing_a_run_says_is_markup() -> None:
    # S9: the texts of run folders are data.
    state = RunState("failed", error=HOSTILE, task=HOSTILE)
    row = {**ROW, "task": HOSTILE, "alpha": HOSTILE}
    learned = [{"task": HOSTILE, "success_rate": 1.0, "epochs": 1, "wall_s": 1.0}]
    events = [{"kind": HOSTILE, "text": HOSTILE, "wall_s": HOSTILE}]
    shown = (
        head(state, row) + stage_cards([HOSTILE, HOSTILE], learned, state, row) + number_cards(row) + event_list(events)
    )
    assert "<img" not in shown
    assert "&lt;img" in shown
