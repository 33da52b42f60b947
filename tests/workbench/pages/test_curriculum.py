"""The Curriculum page without a browser: cards, lattice, order, what a launch trains and what it costs."""

from __future__ import annotations

import asyncio
from pathlib import Path

import panel as pn
import pytest

from agents.config import PROFILES, VARIANTS, TrainingConfig
from sim.errors import UsageError
from sim.scenario_file import load_scenario
from sim.task import Task, task_for
from workbench import launcher
from workbench.context import AppContext
from workbench.estimate import TYPICAL_EPOCH_S
from workbench.pages import curriculum, curriculum_launch
from workbench.pages.curriculum import CurriculumPage
from workbench.pages.curriculum_cards import observation_card, reward_card, task_card
from workbench.pages.curriculum_chain import merged, read_order, stage_cards
from workbench.pages.curriculum_launch import CHAIN, STAGE, LaunchForm
from workbench.pages.curriculum_runs import LaunchedRuns, runs_list
from workbench.policies import shipped_cards
from workbench.run_state import RunState
from workbench.runs import Run

pytestmark = pytest.mark.filterwarnings("ignore:The inplace keyword")  # Bokeh 3.9 under pandas 3.1

HOSTILE = "<img src=x onerror=alert(1)>"


@pytest.fixture
def app(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AppContext:
    """Pages of an empty runs folder; nothing that is launched starts a process, nothing has been measured."""
    pn.extension("tabulator", notifications=True)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    monkeypatch.setattr(launcher, "cpu_count", lambda: 2)
    monkeypatch.setattr(curriculum_launch, "drain", lambda store: [])
    return AppContext.of(tmp_path / "runs")


@pytest.fixture
def form(app: AppContext) -> tuple[LaunchForm, list[Run]]:
    launched: list[Run] = []
    return LaunchForm(app.store, {}, launched.extend), launched


def _open(app: AppContext, monkeypatch: pytest.MonkeyPatch, **query: str) -> CurriculumPage:
    monkeypatch.setattr(curriculum, "read_query", lambda: query)
    return CurriculumPage(app)


def _launch(form: LaunchForm) -> None:
    asyncio.run(form._launch(None))


# What masking does


@pytest.mark.parametrize(
    ("mask", "title", "sizes"),
    [("", "Target task", "15 of 15"), ("4", "Source task 1", "13 of 15"), ("2,3,4", "Source task 3", "9 of 15"),
     ("1,2,3,4", "Source task 4", "7 of 15"), ("1", "Missiles 2, 3, 4", "13 of 15"), ("1,2,3", "Missile 4", "9 of 15")],
)  # fmt: skip
def test_the_cards_follow_the_mask(mask: str, title: str, sizes: str) -> None:
    task = task_for(mask=mask)
    assert title in task_card(task)
    assert sizes in observation_card(task)
    masked = len(task.masked)
    assert observation_card(task).count("chip gone") == 2 * masked
    assert reward_card(task).count("chip gone") == masked
    # The default vector stands where the masked missile's numbers were (Eq. 13).
    assert observation_card(task).count("= −1<") == observation_card(task).count("= −π<") == masked


def test_the_reward_card_shows_the_scenarios_numbers() -> None:
    shown = reward_card(Task(load_scenario()))
    for number in ("+400 exit", "−400 outside", "+50 or −400", "−0.1 a step"):
        assert number in shown


def test_clicking_a_missile_changes_everything_at_once(app: AppContext) -> None:
    page = CurriculumPage(app)
    page._pictures.masked = [4]
    assert "Source task 1" in page._cards["task"].object
    assert "13 of 15" in page._cards["observation"].object
    nodes = page._lattice.nodes.data
    assert [mask for mask, width in zip(nodes["mask"], nodes["ring_width"], strict=True) if width > 2] == ["4"]
    assert [stage["title"] for stage in page._chain.stages] == ["Source task 3", "Source task 2", "Source task 1"]


def test_tapping_a_task_of_the_lattice_masks_the_missiles(app: AppContext) -> None:
    page = CurriculumPage(app)
    nodes = page._lattice.nodes
    nodes.selected.indices = [list(nodes.data["mask"]).index("1,3")]
    assert page._pictures.masked == [1, 3]
    assert nodes.selected.indices == []


# The order of the chain


def test_each_stage_is_guided_by_the_one_before() -> None:
    cards = stage_cards(task_for(mask="2"), [4, 1, 3], "the expert")
    assert [card["title"] for card in cards] == ["Missile 4", "Missiles 1, 4", "Missiles 1, 3, 4"]
    assert [card["guide"] for card in cards] == ["the expert", "policy of stage 1", "policy of stage 2"]
    assert [card["known"] for card in cards] == [[4], [1, 4], [1, 3, 4]]


def test_a_moved_stage_changes_what_is_trained_and_the_lattice(app: AppContext) -> None:
    page = CurriculumPage(app)
    page._chain.met = [2, 1, 4, 3]
    (config,) = page._form.configurations()
    assert config == TrainingConfig(curriculum=True, order="3,4,1,2")
    assert config.stages == ((2,), (1, 2), (1, 2, 4), (1, 2, 3, 4))
    assert [stage["missile"] for stage in page._chain.stages] == [2, 1, 4, 3]
    assert [sorted(frozenset(range(1, 5)) - mask) for mask in page._lattice.chain] == [[], *map(list, config.stages)]
    assert "τ = 3, 4, 1, 2" in page._chain.note and not page._chain.usual


def test_the_order_outlives_a_mask(app: AppContext) -> None:
    page = CurriculumPage(app)
    page._chain.met = [4, 3, 2, 1]
    page._pictures.masked = [3]
    assert page._chain.met == [4, 2, 1]
    page._chain.met = [2, 4, 1]
    page._pictures.masked = []
    assert page._chain.met == [2, 3, 4, 1]


def test_an_order_that_is_none_is_not_taken(app: AppContext) -> None:
    page = CurriculumPage(app)
    page._chain.met = [1, 1, 2, 3]
    assert page._form.configurations() == [TrainingConfig(curriculum=True)]


def test_missiles_keep_their_places_around_those_that_move() -> None:
    assert merged([4, 3, 2, 1], [1, 4]) == [1, 3, 2, 4]


@pytest.mark.parametrize("wrong", ["1,2,3", "4,3,2,2", "a,b", HOSTILE, "1,2,3,99999999999"])
def test_an_order_in_the_address_is_checked(wrong: str, app: AppContext, monkeypatch: pytest.MonkeyPatch) -> None:
    page = _open(app, monkeypatch, order=wrong)
    assert page._chain.met == [1, 2, 3, 4]
    assert "names each of the missiles 1 to 4 once" in page._alert.object
    assert "<img" not in page._alert.object


def test_the_address_names_the_order_as_algorithm_3_does() -> None:
    assert read_order("4,1,2,3", 4) == ([3, 2, 1, 4], "")
    assert read_order("", 2) == ([1, 2], "")


# What a launch trains


def test_the_whole_chain_is_one_run_per_seed(form: tuple[LaunchForm, list[Run]], app: AppContext) -> None:
    launch, launched = form
    launch.show(task_for())
    launch.widgets["seeds"].value = "0-2"
    assert launch.widgets["what"].value == CHAIN
    assert launch._button.label == "Launch 3 runs"
    _launch(launch)
    assert [run.config.seed for run in launched] == [0, 1, 2]
    assert {(run.config.curriculum, run.config.missiles) for run in launched} == {(True, 4)}
    assert len(app.store.list()) == 3


def test_variants_times_seeds_are_launched_in_one_go(form: tuple[LaunchForm, list[Run]]) -> None:
    launch, launched = form
    launch.show(task_for(mask="4"))
    launch.widgets["seeds"].value = "3,4"
    launch.widgets["variant"].value = ["submas", "wo-pd", "td3", "sac"]
    launch.widgets["guide"].value = "expert-dragging"
    _launch(launch)
    assert [(run.config.variant, run.config.seed) for run in launched] == [
        (variant, seed) for seed in (3, 4) for variant in ("submas", "wo-pd", "td3", "sac")
    ]
    submas, _, td3, sac = (run.config for run in launched[:4])
    assert submas == TrainingConfig(curriculum=True, mask="4", guide="expert-dragging", seed=3)
    # Who learns from scratch learns the task itself, and nobody guides it.
    assert td3 == TrainingConfig(missiles=3, variant="td3", seed=3)
    assert sac == TrainingConfig(missiles=3, variant="sac", seed=3)


@pytest.mark.parametrize("variants", [["submas", "td3"], ["sac", "td3", "wo-pd"]])
def test_the_guide_is_named_also_beside_those_who_learn_from_scratch(
    form: tuple[LaunchForm, list[Run]], variants: list[str]
) -> None:
    launch, _ = form
    launch.show(task_for(mask="2"))
    launch.widgets["variant"].value = variants
    assert launch.first_guide == "expert-navigation"
    assert "guided by <b>expert-navigation</b>; from scratch: 1 stage" in launch._summary.object
    assert launch.chain
    launch.widgets["variant"].value = ["td3"]
    assert (launch.first_guide, "without a guide" in launch._summary.object) == ("", True)
    assert not launch.chain  # nobody hands anything on


def test_too_many_runs_and_no_variant_are_sentences(form: tuple[LaunchForm, list[Run]]) -> None:
    launch, _ = form
    launch.show(task_for())
    launch.widgets["variant"].value = ["submas", "wo-pd"]
    launch.widgets["seeds"].value = "0-50"
    assert "2 variants × 51 seeds are 102 runs; at most 100" in launch._summary.object
    launch.widgets["variant"].value = []
    assert "no variant is chosen" in launch._summary.object
    assert launch._button.disabled


def test_a_second_click_launches_nothing(form: tuple[LaunchForm, list[Run]]) -> None:
    launch, launched = form
    launch.show(task_for())
    _launch(launch)
    _launch(launch)
    assert len(launched) == 1


@pytest.mark.parametrize(
    ("mask", "config"),
    [("2,3,4", TrainingConfig(missiles=1)), ("", TrainingConfig()), ("2", TrainingConfig(mask="2"))],
)
def test_a_stage_is_the_task_that_is_shown(
    mask: str, config: TrainingConfig, form: tuple[LaunchForm, list[Run]]
) -> None:
    launch, _ = form
    launch.widgets["what"].value = STAGE
    launch.show(task_for(mask=mask))
    assert launch.configurations() == [config]


def test_the_guide_of_a_single_stage_is_shown_and_chosen(app: AppContext, monkeypatch: pytest.MonkeyPatch) -> None:
    page = _open(app, monkeypatch, what="stage", mask="4")
    assert [stage["guide"] for stage in page._chain.stages] == ["SubMas-RL, source task 2 (shipped)"]
    assert not page._chain.movable
    page._form.widgets["guide"].value = "expert-dragging"
    assert page._chain.stages[0]["guide"] == "Defensive dragging (expert)"
    assert page._form.configurations()[0].guide == "expert-dragging"


def test_a_stage_nobody_can_guide_says_what_to_do(form: tuple[LaunchForm, list[Run]]) -> None:
    launch, launched = form
    launch.widgets["what"].value = STAGE
    launch.show(task_for(mask="1"))
    assert "choose one with --guide, or train the whole chain" in launch._summary.object
    _launch(launch)
    assert launched == []
    launch.widgets["guide"].value = "expert-navigation"
    assert not launch._button.disabled


def test_with_every_missile_masked_there_is_nothing_to_learn(form: tuple[LaunchForm, list[Run]]) -> None:
    launch, _ = form
    launch.show(task_for(mask="1,2,3,4"))
    with pytest.raises(UsageError, match="unmask a missile"):
        launch.configurations()
    assert launch._button.disabled


@pytest.mark.parametrize(("name", "value"), [("seeds", "x"), ("seeds", HOSTILE), ("name", "a\nb")])
def test_a_wrong_value_is_a_sentence_and_no_launch(name: str, value: str, form: tuple[LaunchForm, list[Run]]) -> None:
    launch, _ = form
    launch.show(task_for())
    launch.widgets[name].value = value
    assert launch._button.disabled
    assert "Not yet" in launch._summary.object
    assert "<img" not in launch._summary.object


def test_values_of_the_address_are_taken_only_when_they_are_legal(app: AppContext) -> None:
    query = {"variant": "wo-pd,rm,ppo", "profile": "rm -rf /", "guide": "../../etc/passwd", "what": "stage"}
    form = LaunchForm(app.store, query, lambda runs: None)
    chosen = {name: form.widgets[name].value for name in ("variant", "profile", "guide", "what")}
    assert chosen == {"variant": ["wo-pd", "ppo"], "profile": "fast", "guide": "", "what": STAGE}
    assert form.to_query()["variant"] == "wo-pd,ppo"


def test_the_form_offers_what_the_configuration_takes() -> None:
    assert set(curriculum_launch.VARIANTS.values()) == set(VARIANTS)
    assert set(curriculum_launch.PROFILES.values()) == set(PROFILES) == set(TYPICAL_EPOCH_S)


# What it costs, and how it goes on


def test_the_cost_says_how_it_is_known(app: AppContext, monkeypatch: pytest.MonkeyPatch) -> None:
    form = LaunchForm(app.store, {}, lambda runs: None)
    form.show(task_for())
    assert "not measured on this one yet" in form._summary.object
    assert form._measure.visible
    measured = curriculum_launch.speed_probe.Speed(6.0, "probe", when="1 Jan 2026, 12:00")
    curriculum_launch.speed_probe.remember("fast", measured)
    form._change()
    # At most 400 epochs are done; the shipped chain took fewer.
    epochs = sum(card.epoch for card in shipped_cards().values())
    assert f"About <b>{epochs / 10:.0f} min</b>, at most 40 min." in form._summary.object
    assert "6.0 s an epoch (fast), measured on this machine on 1 Jan 2026, 12:00" in form._summary.object


def test_measuring_describes_the_cost_anew(app: AppContext, monkeypatch: pytest.MonkeyPatch) -> None:
    asked: list[str] = []

    async def probe(profile: str) -> None:
        asked.append(profile)
        curriculum_launch.speed_probe.remember(profile, curriculum_launch.speed_probe.Speed(2.0, "probe", when="now"))

    monkeypatch.setattr(curriculum_launch.speed_probe, "probe", probe)
    form = LaunchForm(app.store, {}, lambda runs: None)
    form.show(task_for())
    asyncio.run(form._probe(None))
    assert asked == ["fast"]
    assert "2.0 s an epoch" in form._summary.object
    assert not form._measure.disabled


def test_runs_under_way_are_listed_with_a_way_to_live(app: AppContext) -> None:
    old = app.store.create(TrainingConfig(name="over"))
    old.write_state(RunState("finished"))
    waiting = app.store.create(TrainingConfig(name=HOSTILE))
    runs = LaunchedRuns(app.store)
    assert waiting.id in runs.pane.object and old.id not in runs.pane.object
    assert f'href="/live?run={waiting.id}"' in runs.pane.object
    assert "<img" not in runs.pane.object
    waiting.write_state(RunState("failed"))
    asyncio.run(runs._tick())
    assert "✗ failed" in runs.pane.object


def test_a_run_that_goes_away_takes_only_its_line_with_it(app: AppContext) -> None:
    first, second = (app.store.create(TrainingConfig(seed=seed)) for seed in (1, 2))
    runs = LaunchedRuns(app.store)
    app.store.delete(first.id)
    asyncio.run(runs._tick())
    assert first.id not in runs.pane.object and second.id in runs.pane.object


def test_no_run_is_no_list(app: AppContext) -> None:
    assert not LaunchedRuns(app.store).pane.visible
    assert "0 of 0" not in runs_list([])


def test_several_runs_are_watched_from_here_and_one_on_its_own_page(
    app: AppContext, monkeypatch: pytest.MonkeyPatch
) -> None:
    gone: list[str] = []
    monkeypatch.setattr(curriculum, "go_to", lambda address, **values: gone.append(values["run"]))
    page = CurriculumPage(app)
    page._form.widgets["seeds"].value = "0,1"
    _launch(page._form)
    assert gone == [] and "Runs under way (2 of 2)" in page._under_way.pane.object
    page._form.widgets["seeds"].value = "7"
    _launch(page._form)
    assert len(gone) == 1
