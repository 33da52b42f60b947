"""The Paper page without a browser: what it says of result sets, where each number comes from, what it starts."""

from __future__ import annotations

import asyncio
import csv
import dataclasses
import io
import json
import re
from pathlib import Path
from typing import Any

import panel as pn
import pytest

from agents.config import PROFILES
from tests.workbench.reproduce.samples import made, run_id
from workbench.context import AppContext
from workbench.pages import paper, paper_results, paper_run
from workbench.pages.paper import PaperPage
from workbench.pages.paper_files import file_of
from workbench.pages.paper_results import Results, chosen_source, own_source, read_results, results_root, sources
from workbench.pages.paper_run import RunPanel, price_words
from workbench.pages.paper_scores import points_of, score_blocks
from workbench.pages.paper_sections import NAMES, SECTIONS, contents, overview_blocks
from workbench.pages.paper_settings import differing_settings, table1_blocks, table2_blocks, table3_blocks
from workbench.pages.paper_sources import records
from workbench.pages.paper_view import prepare
from workbench.reproduce.cost import Cost
from workbench.reproduce.job import BusyError, Job, working
from workbench.reproduce.paper_numbers import TABLE_1, TABLE_2, TABLE_3
from workbench.reproduce.result_file import save
from workbench.reproduce.setting_reasons import FAST_BECAUSE
from workbench.runs import RunStore

ROOT = Path(__file__).resolve().parents[3]


@pytest.fixture(autouse=True)
def _nothing_runs_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """There is no server whose loop would take what a page leaves to it."""
    monkeypatch.setattr(pn.state, "execute", lambda *_, **__: None)


@pytest.fixture
def store(tmp_path: Path) -> RunStore:
    return RunStore(tmp_path / "runs")


@pytest.fixture
def full(store: RunStore) -> Results:
    """Result sets of everything in the runs folder, two seeds each; PPO is missing."""
    source = own_source(store, "fast")
    for item in paper_results.ITEMS:
        save(made(item, seeds=2, without=("ppo",)), source.folder / f"{item}.json")
    return read_results(source)


def texts(blocks: Any) -> str:
    return json.dumps(blocks, ensure_ascii=False)


def refs(blocks: Any) -> set[str]:
    return {key for found in re.findall(r'"refs": (\[[^\]]*\])', texts(blocks)) for key in json.loads(found)}


# Tables 1 to 3


def test_tables_1_to_3_of_the_paper_are_those_of_the_code() -> None:
    for blocks, rows in ((table1_blocks(), 5), (table3_blocks(), 5)):
        assert texts(blocks).count("as in the paper") == rows
        assert "differs" not in texts(blocks)
    assert [len(TABLE_1[name]) for name in ("target", "source-1", "source-2", "source-3", "source-4")] == [
        15,
        13,
        11,
        9,
        7,
    ]
    assert len(TABLE_3) == 5
    (first, *_) = table1_blocks()
    struck = [sum(bool(part.get("strike")) for part in row[1]) for row in first["rows"]]
    assert struck == [0, 2, 4, 6, 8]


def test_table_2_marks_what_fast_changes_and_says_why() -> None:
    (first, *_) = table2_blocks()
    changed = {row[0][0]["t"] for row in first["rows"] if row[3][0].get("tone") == "differs"}
    assert changed == {"Number of epochs", "Steps per epoch", "Batch size"}
    assert differing_settings() == 3
    assert not any(row[2][0].get("tone") for row in first["rows"])  # the profile paper is the paper's
    assert all(row[4][0]["t"] for row in first["rows"] if row[0][0]["t"] in changed)


def test_the_reasons_are_those_of_paper_md() -> None:
    text = (ROOT / "PAPER.md").read_text(encoding="utf-8").partition("## What the `fast` profile does differently")[2]
    listed = dict(re.findall(r"^\| `(\w+)` \| [^|]+ \| [^|]+ \| (.+?) \|$", text, re.MULTILINE))
    assert dict(FAST_BECAUSE) == listed
    paper_values, fast = PROFILES["paper"], PROFILES["fast"]
    assert set(FAST_BECAUSE) == {name for name in vars(fast) if getattr(fast, name) != getattr(paper_values, name)}
    assert {name: getattr(paper_values, name) for name in TABLE_2} == {name: row[2] for name, row in TABLE_2.items()}


# Scores, and where they come from


def test_every_number_knows_its_records_and_every_record_its_command(full: Results) -> None:
    for item in ("table4", "fig8", "fig9", "fig13"):
        result = full.sets[item]
        assert result is not None
        behind, found = refs(score_blocks(item, result)), records(result, set())
        assert behind and behind <= set(found)
        for record in found.values():
            assert record["commands"] and all(line.startswith("workbench ") for _, line in record["commands"])
        reported = {f"{n.variant}.{n.task}.{'shipped' if n.seed is None else n.seed}.report" for n in result.numbers}
        assert reported - {key for key in reported if key.startswith("submas.source") and item == "table4"} <= behind


def test_the_best_seed_leads_to_the_seed_that_is_shown() -> None:
    success = {0: 0.9, 1: 0.95, 2: 0.92}
    result = made("table4", seeds=3, success=lambda v, t, s, p: success[s] if p == "report" else 1.0 - success[s])
    (block,) = [block for block in score_blocks("table4", result) if block["kind"] == "table"][:1]
    row = block["rows"][0]
    assert "(seed 1)" in row[2][0]["t"] and row[2][0]["refs"] == ["submas.target.1.report"]
    # Chosen by the other episodes, on which seed 0 did best.
    assert "(seed 0)" in row[3][0]["t"]
    assert row[3][0]["refs"] == ["submas.target.0.report", "submas.target.0.selection"]
    assert len(row[4][0]["refs"]) == len(row[5][0]["refs"]) == 3


def test_a_run_is_linked_only_if_it_is_in_this_folder() -> None:
    result, run = made("fig9", seeds=1), run_id("submas", 0)
    there, gone = records(result, {run}), records(result, set())
    key = "submas.target.0.report"
    assert [href for _, href in there[key]["links"]] == [f"/live?run={run}", f"/runs?run={run}", f"/fly?a={run}"]
    assert gone[key]["links"] == []
    assert "not in this runs folder" in texts(gone["run.submas.0"])


def test_a_shipped_policy_is_flown_on_the_task_of_its_number() -> None:
    result = made("fig13")
    numbers = tuple(dataclasses.replace(one, run="", policy="submas-target") for one in result.numbers)
    found = records(dataclasses.replace(result, numbers=numbers), set())
    assert found["submas-target.source-2.shipped.report"]["links"] == [
        ["Fly it", "/fly?a=submas-target&b=expert-dragging&mask=3%2C4"]
    ]


def test_unequal_seeds_have_a_chip_each_and_missing_ones_wait() -> None:
    result = dataclasses.replace(made("table4", seeds=2, without=("ppo",)), seed_counts={"submas": 3, "ppo": 1})
    (trainings,) = [b for b in score_blocks("table4", result) if b["kind"] == "table" and len(b["columns"]) == 2]
    chips = {row[0][0]["t"]: [bool(part.get("refs")) for part in row[1]] for row in trainings["rows"]}
    assert chips["SubMas-RL"] == [True, True, False]
    assert chips["PPO"] == [False] and chips["TD3"] == [True, True]


def test_points_without_results_are_not_run_and_counted_as_such(store: RunStore) -> None:
    assert {point["verdict"] for point in points_of("fig8", None)} == {""}
    tiles = overview_blocks(Results(own_source(store, "fast")))[0]["tiles"]
    assert {tile["sub"]: tile["t"] for tile in tiles} == {
        "points hold": "0", "do not hold": "0", "are not run yet": "13",
    }  # fmt: skip


def test_the_contents_say_how_each_section_stands(full: Results, store: RunStore) -> None:
    states = {entry["name"]: entry["state"] for entry in contents(full)}
    assert states == {
        "overview": "code", "table1": "code", "table2": "code", "table3": "code", "table4": "part", "fig8": "done",
        "fig9": "part", "fig10": "done", "fig11": "done", "fig12": "done", "fig13": "done",
    }  # fmt: skip
    assert {e["state"] for e in contents(Results(own_source(store, "fast")))} == {"code", "none"}


@pytest.mark.parametrize("name", [section.name for section in SECTIONS])
def test_every_section_is_prepared_with_results_and_without(name: str, full: Results, store: RunStore) -> None:
    shown, empty = prepare(name, full, set()), prepare(name, Results(own_source(store, "smoke")), set())
    if name in ("table4", "fig8", "fig9", "fig12", "fig13"):
        assert shown.drawn is not None and shown.points and shown.records
        assert (empty.drawn is not None) == (name == "table4")  # the paper's own numbers
        assert "not run yet" in texts(empty.points)
    if name in ("fig10", "fig11"):
        assert shown.maps.count("<svg") == 2 and "seed=4" in shown.maps and not empty.maps


def test_replays_lead_to_the_moment_that_is_drawn(full: Results) -> None:
    drawn = prepare("fig11", full, set()).maps
    assert "/fly?a=submas-target&amp;b=submas-target&amp;seed=4&amp;t=4" in drawn
    assert "2 missiles in flight" in drawn and "reaches the exit" in drawn


# Results, files


def test_results_of_this_folder_are_offered_beside_the_shipped_ones(full: Results, store: RunStore) -> None:
    assert [source.key for source in sources(store)] == ["fast", "fast-here"]
    assert chosen_source("fast-here", store)[0].folder == results_root(store) / "fast"
    source, problem = chosen_source("../../etc", store)
    assert source.key == "fast" and "not known" in problem
    assert chosen_source("", store) == (source, "")


def test_a_damaged_result_set_is_told_and_counts_as_not_run(full: Results, store: RunStore) -> None:
    (full.source.folder / "fig8.json").write_text("{")
    again = read_results(full.source)
    assert again.sets["fig8"] is None and again.sets["fig9"] is not None
    assert "fig8.json is damaged" in again.problems[0]


def test_files_to_download(full: Results) -> None:
    result = full.sets["fig9"]
    assert result is not None
    made_files = {kind: file_of(result, kind) for kind in ("png", "svg", "csv", "curves", "json")}
    assert made_files["png"] is not None and made_files["png"][2].startswith(b"\x89PNG")
    assert made_files["svg"] is not None and b"<svg" in made_files["svg"][2]
    assert made_files["csv"] is not None
    rows = list(csv.DictReader(io.StringIO(made_files["csv"][2].decode())))
    assert len(rows) == len(result.numbers)
    assert rows[0]["command"].startswith("workbench evaluate") and rows[0]["run"] == result.numbers[0].run
    assert made_files["curves"] is not None and made_files["curves"][2].count(b"\n") == 1 + 3 * len(result.curves)
    assert file_of(result, "exe") is None


# Run this


@pytest.fixture
def panel(store: RunStore, monkeypatch: pytest.MonkeyPatch) -> tuple[RunPanel, list[Any]]:
    """The panel, and the orders it gives; nothing is started."""
    pn.extension()
    orders: list[Any] = []
    monkeypatch.setattr(paper_run.background, "start", lambda root, results, order: orders.append((results, order)))
    return RunPanel(store, lambda profile: orders.append(profile)), orders


def test_run_this_orders_what_is_chosen(panel: tuple[RunPanel, list[Any]], store: RunStore) -> None:
    run, orders = panel
    run.show("table4", "fast")
    run._profile.value = "smoke"
    run._seeds["submas"].value, run._seeds["ablations"].value, run._seeds["baselines"].value = 3, 2, 1
    run._start(None)
    (results, order), profile = orders
    assert results == store.root / "results"  # never over what comes with the workbench
    assert (order.item, order.profile, order.seeds.options, order.episodes, profile) == (
        "table4", "smoke", "--seeds 2 --seeds-submas 3 --seeds-baselines 1", 50, "smoke",
    )  # fmt: skip


def test_only_seeds_that_matter_are_asked_for(panel: tuple[RunPanel, list[Any]]) -> None:
    run, _ = panel
    seen = {}
    for item in ("table4", "fig8", "fig9", "fig13"):
        run.show(item, "fast")  # type: ignore[arg-type]
        seen[item] = [name for name, widget in run._seeds.items() if widget.visible]
    assert seen == {
        "table4": ["submas", "ablations", "baselines"], "fig8": ["submas", "ablations"],
        "fig9": ["submas", "baselines"], "fig13": [],
    }  # fmt: skip
    assert not run._profile.visible


def test_while_one_works_no_other_can_be_started(panel: tuple[RunPanel, list[Any]], store: RunStore) -> None:
    run, _ = panel
    hostile = "<img src=x onerror=alert(1)>"
    job = Job(items=("fig9",), profile="smoke", command="c", results="r", pid=1, doing=f"1/2 {hostile}", share=0.5)
    with working(store.root, "trainings", job) as file:
        file.say(hostile)
        file.update(running=("20260101-120000-aaaaaa",))
        file._write()
        run.show("table4", "fast")
        assert run._run.disabled and run._stop.visible and run._bar.value == 50
        assert "Running" in run._words.object and "1/2" in run._words.object and "<img" not in run._words.object
        assert "/live?run=20260101-120000-aaaaaa" in run._words.object
        run.show("fig13", "fast")  # what only flies is another kind
        assert not run._run.disabled
        file.end("finished")
    run.show("table4", "fast")
    assert not run._run.disabled and not run._progress.visible


def test_a_busy_folder_is_said(panel: tuple[RunPanel, list[Any]], monkeypatch: pytest.MonkeyPatch) -> None:
    def busy(*_: Any) -> None:
        raise BusyError("another reproduction works in this runs folder; wait for it or stop it")

    run, orders = panel
    monkeypatch.setattr(paper_run.background, "start", busy)
    run.show("fig9", "fast")
    with pytest.raises(BusyError):
        run._start(None)
    assert not orders and not run._run.disabled


@pytest.mark.parametrize(
    ("price", "sentence"),
    [
        (Cost(0, 0, 0, 0, 0.0), "No training; two engagements"),
        (
            Cost(30, 3, 1, 60, 7200.0),
            "30 trainings, 3 of them are in this runs folder, 1 under way; 60 evaluations; about 2 h",
        ),
        (Cost(3, 3, 0, 6, 0.0), "nothing left to do"),
        (Cost(30, 0, 0, 6, 400_000.0), "4.6 days"),
    ],
)
def test_the_cost_in_words(price: Cost, sentence: str) -> None:
    assert sentence in price_words(price)


# The page


@pytest.fixture
def opened(full: Results, store: RunStore, monkeypatch: pytest.MonkeyPatch) -> tuple[PaperPage, dict[str, str]]:
    """The page at Table 4 of this runs folder, and its address."""
    pn.extension("tabulator", notifications=True)
    address = {"section": "table4", "results": "fast-here", "number": "submas.target.1.report,nonsense"}
    monkeypatch.setattr(paper, "read_query", lambda: dict(address))
    monkeypatch.setattr(paper, "write_query", lambda **values: address.update(values))
    page = PaperPage(AppContext(store))
    asyncio.run(page._load())
    return page, address


def test_the_address_opens_section_results_and_number(opened: tuple[PaperPage, dict[str, str]]) -> None:
    page, address = opened
    assert page._source.key == "fast-here" and page._contents.section == "table4"
    assert page._numbers.chosen == ["submas.target.1.report"]
    page._numbers.chosen = ["submas.target.0.report"]
    assert address["number"] == "submas.target.0.report"
    page._contents.section = "fig8"
    assert (address["section"], address["number"]) == ("fig8", "")
    asyncio.run(page._show())
    assert len(page._main) == 4


def test_back_and_forth_write_no_address(opened: tuple[PaperPage, dict[str, str]]) -> None:
    page, address = opened
    before = dict(address)
    page._contents.address = "?results=fast-here&section=fig8&hide=dec-pd"
    assert page._contents.section == "fig8" and page._wanted["hide"] == "dec-pd"
    page._contents.address = "?results=fast-here&section=nonsense"
    assert page._contents.section == "overview"
    assert address == before


def test_a_tapped_dot_tells_where_it_comes_from(opened: tuple[PaperPage, dict[str, str]]) -> None:
    page, address = opened
    prepared = prepare("table4", page._results, set())
    page._main.objects = page._panels(prepared)
    assert prepared.drawn is not None
    prepared.drawn.dots[0].selected.indices = [0]
    assert page._numbers.chosen == ["submas.target.0.report"] == [address["number"]]
    assert prepared.drawn.dots[0].selected.indices == []  # so that it can be tapped again


def test_an_unknown_section_is_said(store: RunStore, monkeypatch: pytest.MonkeyPatch) -> None:
    pn.extension("tabulator", notifications=True)
    monkeypatch.setattr(paper, "read_query", lambda: {"section": "<b>x</b>"})
    page = PaperPage(AppContext(store))
    assert page._contents.section == "overview"
    assert "no section" in page._alert.object and "<b>" not in page._alert.object
    assert set(NAMES) == {section.name for section in SECTIONS}
