"""The Live page without a browser: what it shows and does, how it follows a run, and that runs hold no markup."""

from __future__ import annotations

import json
import math
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import panel as pn
import pytest

from agents.config import TrainingConfig
from agents.hyperparameters import FAST, PAPER
from sim.errors import ScenarioError
from tests.workbench.pages.page_sessions import do, opened_live
from workbench import launcher
from workbench.context import AppContext
from workbench.pages import live as live_page
from workbench.pages import live_desk
from workbench.pages.address import search
from workbench.pages.live import LivePage
from workbench.pages.live_cards import event_list
from workbench.pages.live_chain import stage_tasks
from workbench.pages.live_columns import axis, learning_of
from workbench.pages.live_promotion import Passed, passed, rule_words
from workbench.pages.live_settings import MOST_BESIDE, LiveSettings, read_settings
from workbench.pages.live_watch import RunWatch, guide_share
from workbench.pages.live_words import Wish, advice, command, spoken, tab_title
from workbench.run_files import append_line, cut_back
from workbench.run_state import STATES, RunState
from workbench.runs import Run

HOSTILE = "<img src=x onerror=alert(1)>"
ROW = {
    "stage": 1, "stages": 4, "task": "source-2", "missiles": [1, 2], "epoch": 3, "epochs": 100, "env_steps": 120_000,
    "alpha": 0.91, "epsilon": 0.74, "beta": 0.1, "success_rate": 0.5, "return_mean": 12.0, "length_mean_s": 500.0,
    "train_success_rate": 0.4, "train_return_mean": 9.0, "transfer_share": 0.5, "critic_loss": 0.01, "actor_loss": -0.2,
    "q_mean": -3.0, "updates_per_s": 321.0, "env_steps_per_s": 5000.0, "wall_s": 9.0, "eta_s": 60.0,
}  # fmt: skip


@pytest.fixture
def app(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[AppContext]:
    """The page of an empty runs folder, outside any session; nothing that is launched starts a process."""
    pn.extension(notifications=True)
    monkeypatch.setattr(launcher, "cpu_count", lambda: 0)
    monkeypatch.setattr(live_page, "SETTLED_S", 0.0)
    context = AppContext.of(tmp_path / "runs")
    yield context
    context.index.close()


def facts(page: LivePage) -> dict[str, Any]:
    return json.loads(page.head.facts)


def cards(page: LivePage) -> list[dict[str, Any]]:
    return json.loads(page.chain.cards)


def lines(page: LivePage) -> list[dict[str, Any]]:
    return json.loads(page.list.lines)


def learning(app: AppContext, state: str = "running", **config: object) -> Run:
    """A run in its second stage; nobody holds its lock."""
    run = app.store.create(TrainingConfig.from_json({"curriculum": True, **config}))
    append_line(run.path / "metrics.jsonl", {**ROW, "stage": 0, "task": "source-3", "success_rate": 1.0})
    append_line(run.path / "metrics.jsonl", ROW)
    append_line(run.path / "events.jsonl", {"kind": "best", "wall_s": 75.0, "text": f"better {HOSTILE}"})
    run.write_state(RunState(state, stage=1, stages=4, task="source-2", progress=0.3, eta_s=60.0, wall_s=80.0))
    return run


# What the page shows


def test_nothing_under_way_says_what_to_do(app: AppContext) -> None:
    page = opened_live(app)
    assert 'href="/curriculum"' in page.empty.object
    assert "Look back" not in page.empty.object
    ended = learning(app, "finished")
    do(page.refresh())
    assert f'href="/live?run={ended.id}"' in page.empty.object
    assert facts(page) == {}


def test_the_newest_run_under_way_is_opened_and_followed(app: AppContext) -> None:
    learning(app, "finished")
    run = learning(app)
    lock = run.claim()
    page = opened_live(app)
    assert page.settings.run == run.id
    assert facts(page)["now"] == "stage 2 of 4 · source-2 · epoch 3 of at most 100"
    assert facts(page)["tab"] == "30 % · source-2 · SubMas"
    assert (facts(page)["worked_s"], facts(page)["most_s"]) == (80.0, 60.0)
    assert [line["id"] for line in lines(page) if line["alive"]] == [run.id]
    append_line(run.path / "metrics.jsonl", {**ROW, "epoch": 4})
    do(page.refresh())
    assert "epoch 4 of" in facts(page)["now"]
    os.close(lock or 0)
    do(page.refresh())
    assert facts(page)["state"] == "interrupted"
    assert set(facts(page)["buttons"]) == {"resume"}


def test_every_stage_has_a_card_with_its_mask_guide_rule_and_present_value(app: AppContext) -> None:
    run = learning(app)
    lock = run.claim()
    fields = {"task": "source-3", "reason": "3 held-out evaluations of 200 episodes", "success_rate": 0.996}
    append_line(run.path / "events.jsonl", {"kind": "stage_finished", "text": "source-3 …", **fields})
    first, second, third, last = cards(opened_live(app, run=run.id))
    assert [card["kind"] for card in (first, second, third, last)] == ["done", "now", "waiting", "waiting"]
    assert (first["word"], first["rule"]) == ("passed", "promoted; 99.6 % of fresh episodes")
    assert [chip["number"] for chip in second["missiles"] if not chip["masked"]] == [1, 2]
    assert [chip["number"] for chip in second["missiles"] if chip["new"]] == [2]
    assert second["guide"] == "guide: the policy of stage 1"
    assert second["rule"] == "3 windows of 200 episodes ≥ 99 %"
    assert (second["now"], second["value"], second["of"]) == ("now 50 %, 0 of 3 passed", 0.5, 3)
    assert (second["epochs"], second["share"]) == ("epoch 3 of 100", 0.03)
    assert second["time"] == "at most 4:51 left"  # 97 epochs of 3 s
    assert last["title"] == "Target task" and not any(chip["masked"] for chip in last["missiles"])
    os.close(lock or 0)


@pytest.mark.parametrize(
    ("profile", "reason", "shown"),
    [
        ("fast", "all 100 epochs done", ("spent", "not passed", "ended: all 100 epochs done; 0.0 % of fresh episodes")),
        ("paper", "all 400 epochs done", ("done", "done", "ended: all 400 epochs done; 0.0 % of fresh episodes")),
    ],
)
def test_a_stage_whose_epochs_ran_out_is_not_called_passed(
    app: AppContext, profile: str, reason: str, shown: tuple[str, str, str]
) -> None:
    run = learning(app, profile=profile)
    fields = {"task": "source-3", "reason": reason, "success_rate": 0.0}
    append_line(run.path / "events.jsonl", {"kind": "stage_finished", "text": "source-3 …", **fields})
    first = cards(opened_live(app, run=run.id))[0]
    assert (first["kind"], first["word"], first["rule"]) == shown and first["share"] == 1.0


def test_nothing_is_sent_while_nothing_changes(app: AppContext, monkeypatch: pytest.MonkeyPatch) -> None:
    page = opened_live(app, run=learning(app).id)
    monkeypatch.setattr(page, "_show_run", _never)
    do(*(page.refresh() for _ in range(5)))


def _never(*_: object) -> None:
    raise AssertionError("drawn again")


def test_new_epochs_are_streamed_not_drawn_again(app: AppContext, monkeypatch: pytest.MonkeyPatch) -> None:
    run = learning(app)
    page = opened_live(app, run=run.id)
    source = page.curves._curves._slots[0].epochs.source
    sent: list[int] = []
    monkeypatch.setattr(type(source), "stream", lambda _self, new, **_: sent.append(len(new["x"])))
    before = source.data
    append_line(run.path / "metrics.jsonl", {**ROW, "epoch": 4})
    do(page.refresh())
    assert set(sent) == {1}
    assert source.data is before


def test_several_runs_share_the_page(app: AppContext) -> None:
    runs = [learning(app, "finished", seed=seed) for seed in range(3)]
    learning(app, "finished", seed=7, variant="wo-pd")
    page = opened_live(app, run=runs[0].id)
    do(lambda: page.list.param.update(asked=["seeds", "", 1]))
    assert set(page.settings.beside) == {run.id for run in runs[1:]}
    do(page.refresh())
    drawn = [slot for slot in page.curves._curves._slots if len(slot.epochs.source.data["x"])]
    assert len(drawn) == 3
    assert len({line["curve"] for line in lines(page)} - {""}) == 3
    do(lambda: page.list.param.update(asked=["alone", "", 2]), page.refresh())
    assert not page.settings.beside
    assert [len(slot.epochs.source.data["x"]) for slot in page.curves._curves._slots] == [2, 0, 0]


def test_a_damaged_or_unknown_run_is_a_sentence(app: AppContext) -> None:
    run = learning(app)
    with (run.path / "metrics.jsonl").open("a") as file:
        file.write("{}\n")
    page = opened_live(app, run=run.id)
    assert "Not all of this run can be shown: metrics.jsonl has a row without" in page.alert.object
    assert len(cards(page)) == 4
    assert "is not a run id" in opened_live(app, run="<b>x</b>").alert.object
    (run.path / "config.json").write_text("{")
    assert "config.json is not JSON" in opened_live(app, run=run.id).alert.object


def test_nothing_a_run_says_is_markup(app: AppContext) -> None:
    # S9: the texts of run folders are data. What is JSON is set as text by the browser.
    assert "<img" not in event_list([{"kind": HOSTILE, "text": HOSTILE, "wall_s": HOSTILE}])
    assert "&lt;img" in opened_live(app, run=learning(app).id).events.object


# What a person does


def test_pause_stop_and_resume_reach_the_run_and_are_seen_in_every_tab(app: AppContext) -> None:
    run = learning(app)
    lock = run.claim()
    page, other = opened_live(app, run=run.id), opened_live(app, run=run.id)
    do(page.act("pause"))
    assert run.pause_requested()
    assert facts(page)["buttons"]["pause"] == {"label": "Pausing …", "off": True}
    do(other.refresh())
    assert facts(other)["buttons"]["pause"]["label"] == "Pausing …"
    assert "It pauses at the end of this epoch" in facts(other)["said"]
    do(page.act("stop"))
    assert run.stop_requested()
    assert facts(page)["buttons"]["stop"] == {"label": "Stopping …", "off": True}
    os.close(lock or 0)
    run.write_state(RunState("paused", stages=4, progress=0.3))
    do(other.act("resume"))
    assert run.state.state == "queued"
    assert run.state.resumes == 1


def test_a_waiting_run_says_its_place_and_when_it_starts(app: AppContext, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(live_desk, "cpu_count", lambda: 1)
    worker, first, second = learning(app), learning(app), learning(app)
    lock = worker.claim()
    for number, run in enumerate((first, second)):
        run.write_state(RunState("queued", created=f"2026-01-01T00:00:0{number}"))
    page = opened_live(app, run=first.id)
    assert facts(page)["now"] == "waits for a free core, the next of 2 in the queue; starts in about 1:00"
    worker.write_state(RunState("running", eta_s=25.0, wall_s=115.0))
    do(page.refresh())
    assert facts(page)["now"].endswith("starts in about 0:25")
    do(opened_live(app, run=second.id).refresh())
    os.close(lock or 0)


def test_a_run_of_a_cluster_says_where_it_works(app: AppContext) -> None:
    run = learning(app)
    run.write_state(RunState("queued", engine="ray"))
    lock = run.claim()
    page = opened_live(app, run=run.id)
    assert facts(page)["now"] == "waits for a node of its cluster"
    assert "as soon as a node is free" in facts(page)["advice"]
    run.write_state(RunState("running", engine="ray", node="node-3, 16 cores", retries=1))
    do(page.refresh())
    assert facts(page)["where"] == "on node-3, 16 cores, begun again 1 time"
    os.close(lock or 0)


def test_what_is_not_possible_any_more_is_no_crash(app: AppContext) -> None:
    page = opened_live(app, run=learning(app, "finished").id)
    do(page.act("pause"), page.act("nonsense"))
    assert facts(page)["state"] == "finished"


@pytest.mark.parametrize("state", [state for state in STATES if state != "running"])
def test_every_state_says_what_happened_and_what_to_do(state: str) -> None:
    stands = RunState(state, stages=4, task="source-1", progress=0.5, error="no space left")
    assert advice(stands, Wish()).endswith(".")
    assert ("no space left" in advice(stands, Wish())) == (state == "failed")
    typed = command(stands, "20260101-000000-aaaaaa", Path("/tmp/my runs"))
    assert ("workbench resume" in typed) == stands.resumable
    assert not typed or "--runs '/tmp/my runs'" in typed
    assert tab_title(stands) == f"{state} · source-1 · SubMas"


def test_a_screen_reader_hears_only_news() -> None:
    said = {
        spoken(RunState("running", stages=4, task="target", progress=share / 100), Wish(), "run")
        for share in range(100)
    }
    assert len(said) == 10


# The view


def test_the_address_holds_the_whole_view() -> None:
    ids = [f"20260101-00000{n}-aaaaaa" for n in range(3)]
    settings = LiveSettings(ids[0], (ids[1], ids[2]), "time", 60, ("actor", "speed"), ("beta",))
    assert read_settings(settings.to_query()) == settings
    assert not any(LiveSettings().to_query().values())
    assert search({"run": "a&b=<c>", "theme": ""}) == "?run=a%26b%3D%3Cc%3E"


@pytest.mark.parametrize(
    "query",
    [{"x": "moon"}, {"smooth": "-1"}, {"smooth": "1e9"}, {"with": "../../x,<b>"}, {"without": "all"}, {"hidden": "'"}],
)
def test_an_illegal_address_is_the_usual_view(query: dict[str, str]) -> None:
    assert read_settings(query) == LiveSettings()


def test_no_more_curves_than_inks() -> None:
    settings = LiveSettings(run="a")
    for number in range(30):
        settings = settings.toggled(f"20260101-0000{number:02}-aaaaaa")
    assert len(settings.beside) == MOST_BESIDE


# Figures


def test_a_watch_reads_every_row_once_and_forgets_what_is_cut_back(app: AppContext) -> None:
    run = learning(app)
    watch = RunWatch(run)
    assert watch.look()
    assert not watch.look()
    size = (run.path / "metrics.jsonl").stat().st_size
    append_line(run.path / "metrics.jsonl", {**ROW, "epoch": 4})
    assert watch.look()
    assert list(watch.columns["epoch"]) == [3, 3, 4]
    before = learning_of(watch, LiveSettings()).key
    cut_back(run.path / "metrics.jsonl", size)
    assert watch.look()
    assert list(watch.columns["epoch"]) == [3, 3]
    assert learning_of(watch, LiveSettings()).key != before


def test_the_axis_counts_through_the_stages(app: AppContext) -> None:
    watch = RunWatch(learning(app))
    watch.look()
    assert axis(watch, "steps") == pytest.approx([0.12, 0.24])
    assert axis(watch, "time") == pytest.approx([9 / 60, 18 / 60])
    assert list(axis(watch, "epoch")) == [1.0, 2.0]


def test_smoothing_does_not_reach_over_stages_and_keeps_gaps(app: AppContext) -> None:
    run = learning(app)
    for alpha in (1.0, None, 0.0):
        append_line(run.path / "metrics.jsonl", {**ROW, "alpha": alpha})
    watch = RunWatch(run)
    watch.look()
    alpha = learning_of(watch, LiveSettings(smooth=50)).epochs["alpha"]
    # Unbiased mean of weight ½: (½·0.91 + 1) / 1.5 and, after the gap, (¼·0.91 + ½·1 + 0) / 1.75.
    assert alpha[[0, 1, 2, 4]] == pytest.approx([0.91, 0.91, 1.455 / 1.5, 0.7275 / 1.75])
    assert np.isnan(alpha[3])


def test_the_guide_flies_where_it_is_drawn_and_allowed() -> None:
    assert guide_share(ROW) == pytest.approx(0.37)
    assert math.isnan(guide_share({"epsilon": None, "transfer_share": 0.5}))
    assert guide_share({**ROW, "guide_share": 0.25}) == 0.25  # counted
    assert math.isnan(guide_share({**ROW, "guide_share": None}))  # of a learner without a guide


@pytest.mark.parametrize(
    ("rates", "count"), [((0.5,), 0), ((0.98,), 0), ((0.99, 0.95), 1), ((1.0, 0.99, 0.985), 2), ((0.99, 1.0, 1.0), 3)]
)
def test_passed_evaluations_follow_from_the_pooled_success(rates: tuple[float, ...], count: int) -> None:
    # Pooled as agents.promotion.examine pools: evaluations of 200 episodes each.
    found = passed(sum(rates) / len(rates), 900.0, FAST)
    assert found.least <= count <= found.most


def test_passed_evaluations_are_exact_where_they_can_be() -> None:
    assert passed(0.5, 900.0, FAST) == Passed(0, 0)
    assert passed(1.0, 900.0, FAST) == Passed(3, 3)
    # 393 of 400, and a mean length that 200 episodes cannot have: two evaluations, of which the first was passed.
    assert passed(393 / 400, 900 + 1 / 400, FAST) == Passed(1, 1)


def test_the_rule_of_a_profile_that_never_promotes() -> None:
    assert rule_words(PAPER) == "all 300 epochs; the best policy is kept"


def test_tasks_of_a_training_in_order() -> None:
    names = [task.name for task in stage_tasks(TrainingConfig(curriculum=True))]
    assert names == ["source-3", "source-2", "source-1", "target"]
    with pytest.raises(ScenarioError):
        stage_tasks(TrainingConfig(missiles=2, scenario="gone"))
