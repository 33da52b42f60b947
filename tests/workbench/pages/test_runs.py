"""The Runs page without a browser: what it lists, draws, compares and does, and that runs hold no markup."""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
import panel as pn
import pytest

from agents.config import TrainingConfig
from agents.statistics import bootstrap
from layouts.theme import SUCCESS
from tests.workbench.pages.page_sessions import do
from workbench.bench.runs import make_runs
from workbench.context import AppContext
from workbench.pages import runs as runs_page
from workbench.pages.runs import RunsPage
from workbench.pages.runs_baseline import expert_rate
from workbench.pages.runs_below import RunsBelow
from workbench.pages.runs_detail import facts, head
from workbench.pages.runs_groups import grouped
from workbench.pages.runs_settings import EXPERT, SLOTS, RunsSettings, read_settings
from workbench.pages.runs_view import gather_more, run_of
from workbench.run_files import append_line
from workbench.run_index.query import RunSearch
from workbench.run_notes import RunNotes, read_notes, write_notes
from workbench.run_state import RunState

HOSTILE = "<img src=x onerror=alert(1)>"
COUNT = 40
ENDS = {"source-3": "2 held-out evaluations at 99.0%: 99.5%, 100.0%", "source-2": "all 100 epochs done"}
"""How stages end: task and reason."""


@pytest.fixture
def app(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AppContext:
    """The page of an empty runs folder, outside any session."""
    pn.extension(notifications=True)
    monkeypatch.setattr(runs_page, "SETTLED_S", 0.0)
    return AppContext.of(tmp_path / "runs")


@pytest.fixture
def many(app: AppContext) -> AppContext:
    """Forty runs: four variants with ten seeds each."""
    make_runs(app.store.root, COUNT, epochs=8)
    return app


def opened(app: AppContext, **query: str) -> RunsPage:
    """The page of this address, brought up to date."""
    page = RunsPage(app)
    page.settings = read_settings(query)
    do(page.start())
    return page


def put(target: Any, **values: Any) -> None:
    """Set these as the browser would."""
    do(lambda: target.param.update(**values))


def click(button: Any) -> None:
    """Press it."""
    put(button, clicks=button.clicks + 1)


def below(page: RunsPage) -> RunsBelow:
    assert page.below is not None
    return page.below


def lines(page: RunsPage) -> list[dict[str, Any]]:
    return json.loads(page.table.lines)


def pinned(page: RunsPage) -> dict[str, Any]:
    return json.loads(page.table.pinned)


def test_the_address_holds_the_whole_view() -> None:
    ids = [f"20260101-00000{n}-aaaaaa" for n in range(3)]
    settings = RunsSettings(
        search=RunSearch("a -b", {"state": ("failed",), "tag": ("a, b", "ü")}, "-success", trashed=True),
        group="settings", opened=("submas · fast",), shown=(ids[0], "", "group:x, y"), run=ids[1], baseline=ids[2],
        metrics=("alpha", "beta"), x="time", stages="last", smooth=40, every_field=True,
    )  # fmt: skip
    assert read_settings(settings.to_query()) == settings
    assert not any(RunsSettings().to_query().values())


@pytest.mark.parametrize(
    "query",
    [{"sort": "id; DROP TABLE run"}, {"group": "__class__"}, {"show": "../../etc/passwd,<b>"}, {"x": "y"},
     {"smooth": "1e9"}, {"curves": "alpha"}, {"curves": "alpha,__init__"}, {"baseline": "<script>"},
     {"stages": "first"}, {"smooth": "٣"}],
)  # fmt: skip
def test_what_is_not_legal_in_an_address_is_left_as_it_is(query: dict[str, str]) -> None:
    assert read_settings(query) == RunsSettings()


def test_a_curve_keeps_its_place_when_another_goes() -> None:
    settings = RunsSettings()
    for key in ("a", "b", "c"):
        settings = settings.toggled(key)
    settings = settings.toggled("b")
    assert settings.shown == ("a", "", "c")
    assert settings.toggled("d").shown == ("a", "d", "c")
    assert settings.toggled("c").shown == ("a",)
    for number in range(2 * SLOTS):
        settings = settings.toggled(str(number))
    assert len(settings.shown) == SLOTS


# The list


def test_no_run_yet_says_what_to_do(app: AppContext) -> None:
    page = opened(app)
    assert page.table.total == 0
    assert "Curriculum page" in page.table.empty
    assert "trash is empty" in opened(app, view="trash").table.empty


def test_nothing_found_says_what_to_do(many: AppContext) -> None:
    page = opened(many, q="no such thing")
    assert page.bar.counted == f"0 of {COUNT} runs"
    assert "Clear filters" in page.table.empty


def test_runs_are_found_sorted_and_sent_in_windows(many: AppContext, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("workbench.pages.runs_lines.WINDOW", 12)
    monkeypatch.setattr("workbench.pages.runs_lines.MARGIN", 4)
    page = opened(many, sort="name")
    names = [f"bench-{number:04}" for number in range(COUNT)]
    assert (page.table.total, [line["name"] for line in lines(page)]) == (COUNT, names[:12])
    put(page.table, first=20)
    assert (page.table.offset, [line["name"] for line in lines(page)]) == (16, names[16:28])


def test_typing_and_ticking_values_narrows_the_list(many: AppContext) -> None:
    page = opened(many)
    put(page.bar, text="bench-001")
    assert page.bar.counted == f"10 of {COUNT} runs"
    put(page.bar, chosen={"variant": ["wo-pd"]})
    assert {line["variant"] for line in lines(page)} == {"wo-pd"}
    assert page.settings.to_query()["variant"] == "wo-pd"
    variants = next(facet for facet in json.loads(page.bar.facets) if facet["name"] == "variant")
    assert ["submas", 10] in variants["options"]


def test_a_damaged_run_is_listed_with_a_sentence_among_the_others(many: AppContext) -> None:
    bad = many.store.create(TrainingConfig(name=HOSTILE))
    (bad.path / "config.json").write_text("{")
    page = opened(many, run=bad.id)
    line = next(line for line in lines(page) if line["key"] == bad.id)
    assert "config.json is not JSON" in line["problem"]
    assert page.table.total == COUNT + 1
    assert "config.json is not JSON" in below(page).detail._panes["head"].object
    assert below(page).detail.delete.visible


def test_success_is_told_beside_the_experts_on_the_same_task(many: AppContext) -> None:
    task, rate = expert_rate("default", "1,2,3,4")
    assert (task, rate) == ("target", 0.617)
    page = opened(many)
    assert pinned(page)["success"] == "61.7 %"
    record = many.index.find()[0]
    line = next(line for line in lines(page) if line["key"] == record.id)
    assert float(line["gap"]) == pytest.approx(100 * ((record.success or 0.0) - 0.617), abs=0.05)


def test_a_run_can_be_pinned_instead_and_is_drawn_dashed(many: AppContext) -> None:
    many.index.look()
    record = many.index.find()[0]
    page = opened(many, run=record.id)
    click(below(page).detail.pin)
    assert page.settings.baseline == record.id
    assert pinned(page)["key"] == record.id
    assert list(below(page).curves._figures[0].lines.data["dash"]) == ["dashed"]
    click(below(page).detail.pin)
    assert page.settings.baseline == EXPERT


# Groups


def test_groups_tell_the_interval_over_seeds(many: AppContext) -> None:
    page = opened(many, group="variant", open="submas")
    groups = [line for line in lines(page) if line["kind"] == "group"]
    assert [group["label"] for group in groups] == ["dec-pd", "submas", "wo-pd", "wo-pr"]
    records = [record for record in many.index.find() if record.variant == "submas"]
    rates = [record.success for record in records if record.success is not None]
    expected = [float(each) for each in bootstrap([rates], replicates=1000)]
    assert groups[1]["count"] == len(records) == 10
    assert [groups[1][name] for name in ("value", "low", "high")] == pytest.approx(expected, abs=1e-5)
    assert sorted(groups[1]["dots"]) == pytest.approx(sorted(rates), abs=1e-4)
    assert page.table.total == 4 + 10


def test_groups_of_all_settings_part_only_seeds_from_each_other(many: AppContext) -> None:
    many.index.look()
    groups = grouped(many.index.find(), "settings")
    assert len(groups) == 4
    assert all(sorted(record.seed or 0 for record in group.records) == list(range(10)) for group in groups)


def test_groups_are_ordered_by_their_success_when_runs_are(many: AppContext) -> None:
    page = opened(many, group="variant", sort="-success")
    values = [line["value"] for line in lines(page)]
    assert values == sorted(values, reverse=True)


def test_a_ticked_group_is_drawn_with_its_band(many: AppContext) -> None:
    page = opened(many, group="variant", show="group:submas")
    figure = below(page).curves._figures[0]
    assert len(figure.lines.data["xs"]) == len(figure.bands.data["xs"]) == 1
    assert "10 runs" in figure.points.data["label"][0]


# Curves, difference, lineage


def test_ticked_runs_lie_over_each_other_with_the_experts_line(many: AppContext) -> None:
    many.index.look()
    ids = [record.id for record in many.index.find()[:2]]
    page = opened(many)
    for run_id in ids:
        put(page.table, asked=["tick", run_id, page.table.asked[2] + 1])
    assert page.settings.shown == tuple(ids)
    figure = below(page).curves._figures[0]
    run = many.store.get(ids[0])
    rows = run.metrics()
    assert list(figure.lines.data["ys"][0]) == [row["success_rate"] for row in rows]
    steps = np.array([row["env_steps"] for row in rows])
    assert np.asarray(figure.lines.data["xs"][0])[-1] == pytest.approx(1e-6 * sum(steps[[1, 3, 5, 7]]))
    assert list(figure.levels.data["y"]) == [0.617]
    assert "target" in figure.levels.data["label"][0]


def test_smoothing_stops_at_the_end_of_a_stage(many: AppContext) -> None:
    many.index.look()
    run = many.store.get(many.index.find(RunSearch("submas"))[0].id)
    figure = below(opened(many, show=run.id, smooth="80")).curves._figures[0]
    rates = [row["success_rate"] for row in run.metrics()]
    shown = np.asarray(figure.lines.data["ys"][0])
    # Every stage begins with what was measured, and two epochs later its first value weighs 0.8 to 1.
    assert shown[[0, 2, 4, 6]].tolist() == pytest.approx(rates[0::2])
    assert shown[1] == pytest.approx((0.8 * rates[0] + rates[1]) / 1.8)
    assert [len(xs) for xs in figure.faint.data["xs"]] == [8]


def test_the_difference_names_what_differs_and_nothing_else(many: AppContext) -> None:
    ids = [many.store.create(TrainingConfig(seed=seed, name=HOSTILE)).id for seed in (1, 2)]
    page = opened(many, show=",".join(ids))
    shown = below(page).difference.object
    assert shown.count('class="differs"') == 1
    assert 'scope="row">seed<' in shown
    assert "<img" not in shown
    assert 'scope="row">variant<' not in shown
    put(below(page).every, value=True)
    assert 'scope="row">variant<' in below(page).difference.object
    assert 'scope="row">gamma<' in below(page).difference.object


def test_lineage_leads_from_guide_to_guide(many: AppContext) -> None:
    first = many.store.create(TrainingConfig(curriculum=True, name=HOSTILE))
    append_line(first.path / "metrics.jsonl", {"stage": 0, "task": "source-3", "epoch": 2, "success_rate": 1.0})
    second = many.store.create(TrainingConfig(guide=first.id, missiles=2, name="second"))
    third = many.store.create(TrainingConfig(guide=str(second.path / "policy.safetensors"), missiles=3, name="third"))
    shown = {run.id: below(opened(many, run=run.id)).detail._panes["lineage"].object for run in (first, second, third)}
    assert "Navigation (expert)" in shown[first.id]
    assert "source-3" in shown[first.id]
    assert f"/runs?run={second.id}" in shown[first.id]
    assert [shown[third.id].find(f"/runs?run={run.id}") for run in (third, third)] == [-1, -1]
    assert -1 < shown[third.id].find(f"run={first.id}") < shown[third.id].find(f"run={second.id}")
    assert not any("<img" in each for each in shown.values())


def test_a_stage_that_ran_out_of_epochs_is_told_from_one_that_passed(app: AppContext) -> None:
    run = app.store.create(TrainingConfig(curriculum=True))
    for number, (task, reason) in enumerate(ENDS.items()):
        append_line(run.path / "metrics.jsonl", {"stage": number, "task": task, "epoch": 9, "success_rate": 0.5})
        append_line(run.path / "events.jsonl", {"kind": "stage_finished", "task": task, "reason": reason})
    stages = below(opened(app, run=run.id)).detail._panes["lineage"].object.split("<li")[2:]
    assert [("not passed" in stage, SUCCESS in stage) for stage in stages] == [(False, True), (True, False)]


def test_runs_that_guide_each_other_end_somewhere(app: AppContext) -> None:
    one = app.store.create(TrainingConfig(missiles=1))
    two = app.store.create(TrainingConfig(missiles=2, guide=one.id))
    (one.path / "config.json").write_text((two.path / "config.json").read_text().replace(one.id, two.id))
    assert "Lineage" in below(opened(app, run=one.id)).detail._panes["lineage"].object


# What is done with runs


def test_notes_and_tags_are_kept_in_the_folder(many: AppContext) -> None:
    many.index.look()
    record = many.index.find()[0]
    page = opened(many, run=record.id)
    put(below(page).detail._note, value=HOSTILE)
    put(below(page).detail._tags, value="keep, paper")
    assert read_notes(many.store.root / record.id) == RunNotes(HOSTILE, ("keep", "paper"))
    write_notes(many.store.root / record.id, RunNotes("written elsewhere"))
    do(page.tick())
    assert below(page).detail._note.value == "written elsewhere"


def test_deleting_asks_first_and_can_be_undone(many: AppContext) -> None:
    many.index.look()
    ids = [record.id for record in many.index.find()[:2]]
    page = opened(many, show=",".join(ids), run=ids[0])
    put(page.bar, asked=["delete", 1])
    assert below(page).actions._delete.open
    assert len(many.store.list()) == COUNT
    do(below(page).actions._confirm())
    assert len(many.store.list()) == COUNT - 2
    assert page.settings.shown == ()
    assert page.settings.run == ""
    assert "2 runs moved to the trash" in below(page).actions._words.object
    do(below(page).actions._bring_back(None))
    assert len(many.store.list()) == COUNT
    assert page.table.total == COUNT


def test_a_run_in_the_trash_is_restored_from_its_panel(many: AppContext) -> None:
    run = many.store.list()[0]
    many.store.delete(run.id)
    page = opened(many, view="trash", run=run.id)
    assert [line["key"] for line in lines(page)] == [run.id]
    assert below(page).detail.restore.visible
    assert not below(page).detail.delete.visible
    click(below(page).detail.restore)
    assert len(many.store.list()) == COUNT


def test_a_run_that_was_moved_away_a_moment_ago_breaks_nothing(many: AppContext) -> None:
    many.index.look()
    gone, other = (record.id for record in many.index.find()[:2])
    many.store.delete(gone)
    page = RunsPage(many)
    page.settings = read_settings({"run": gone, "show": f"{gone},{other}"})
    page.tick = page._relist  # the index does not look again: it takes the run to be where it was
    do(page.start())
    assert page.table.total == COUNT
    assert "config.json cannot be read" in below(page).difference.object
    do(RunsPage.tick(page))
    assert page.table.total == COUNT - 1
    assert below(page).detail.restore.visible


def test_a_running_run_is_not_deleted_and_says_so(app: AppContext) -> None:
    run = app.store.create(TrainingConfig())
    lock = run.claim()
    run.write_state(RunState("running"))
    page = opened(app, run=run.id)
    assert below(page).detail.delete.disabled
    record = app.index.get(run.id)
    assert record is not None
    below(page).actions.ask_delete([record])
    do(below(page).actions._confirm())
    os.close(lock or 0)
    assert "is running; stop it" in below(page).actions._words.object
    assert [each.id for each in app.store.list()] == [run.id]


def test_new_runs_appear_and_the_choice_stays(app: AppContext) -> None:
    first = app.store.create(TrainingConfig())
    page = opened(app, run=first.id)
    app.store.create(TrainingConfig())
    do(page.tick())
    assert page.table.total == 2
    assert page.table.focused == first.id


@pytest.mark.parametrize(("run", "sentence"), [("20200101-000000-aaaaaa", "is not in"), (HOSTILE, "is not a run id")])
def test_an_unknown_run_is_a_sentence(run: str, sentence: str, app: AppContext) -> None:
    shown = below(opened(app, run=run)).detail._panes["head"].object
    assert sentence in shown
    assert "<img" not in shown


def test_nothing_a_run_says_is_markup(app: AppContext) -> None:
    run = app.store.create(TrainingConfig(name=HOSTILE, guide=HOSTILE))
    run.write_state(RunState("failed", error=HOSTILE, created=HOSTILE))
    (run.path / "policies" / f"{HOSTILE.replace('/', '')}.safetensors").write_text("")
    app.index.look()
    record = app.index.get(run.id)
    assert record is not None
    settings = RunsSettings(run=run.id, shown=(run.id,))
    page = opened(app, run=run.id)
    more = gather_more(app.index, settings, page._listed.listing if page._listed else None)  # type: ignore[arg-type]
    below(page).curves.show(settings, more.drawing)
    shown = [head(record), facts(record, run_of(app.index, record)), more.lineage, below(page).curves._key.object]
    below(page).actions.ask_delete([record])
    shown.append(below(page).actions._question.object)
    assert not any("<img" in each for each in shown)
    assert sum("&lt;img" in each for each in shown) == len(shown)


def test_a_rebuilt_index_is_said(many: AppContext) -> None:
    opened(many)
    many.index.close()
    (many.store.root / ".index.sqlite").write_bytes(b"x" * 5000)
    page = opened(AppContext.of(many.store.root))
    do(page.tick())
    assert page.table.total == COUNT
    assert "rebuilt from the run folders" in page._alert.object


def test_metrics_that_cannot_be_read_are_said_beside_the_curve(many: AppContext) -> None:
    run = many.store.list()[0]
    with (run.path / "metrics.jsonl").open("a") as file:
        file.write("{torn\n{}\n")
    page = opened(many, show=run.id)
    assert "metrics.jsonl, line 9 is not JSON" in below(page).curves._key.object
