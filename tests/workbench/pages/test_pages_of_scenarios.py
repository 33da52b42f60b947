"""Curriculum, Live and Runs with six missiles and with two: everything follows the scenario."""

from __future__ import annotations

import json
from pathlib import Path

import panel as pn
import pytest

from agents.config import TrainingConfig
from sim.task import task_for
from tests.workbench.pages.page_sessions import opened_live
from workbench import launcher
from workbench.context import AppContext
from workbench.estimate import estimate
from workbench.pages import curriculum, curriculum_launch
from workbench.pages.address import fly_address
from workbench.pages.curriculum import CurriculumPage
from workbench.pages.curriculum_cards import observation_card, reward_card, task_card
from workbench.pages.curriculum_launch import STAGE, LaunchForm
from workbench.pages.live_chain import stage_tasks
from workbench.pages.runs_lines import run_line
from workbench.pages.runs_settings import RunsSettings
from workbench.run_state import RunState
from workbench.scenarios import scenario_choices

pytestmark = pytest.mark.filterwarnings("ignore:The inplace keyword")  # Bokeh 3.9 under pandas 3.1

SIX = "six-missiles"


@pytest.fixture
def app(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> AppContext:
    pn.extension("tabulator", notifications=True)
    monkeypatch.setattr(launcher, "cpu_count", lambda: 2)
    monkeypatch.setattr(curriculum_launch, "drain", lambda store: [])
    return AppContext.of(tmp_path / "runs")


def _open(app: AppContext, monkeypatch: pytest.MonkeyPatch, **query: str) -> CurriculumPage:
    monkeypatch.setattr(curriculum, "read_query", lambda: query)
    return CurriculumPage(app)


def test_the_address_chooses_the_scenario(app: AppContext, monkeypatch: pytest.MonkeyPatch) -> None:
    page = _open(app, monkeypatch, scenario=SIX, mask="5,6")
    assert page._pictures.masked == [5, 6]
    assert len(page._pictures.colours) == 6
    assert len(page._lattice.nodes.data["mask"]) == 64
    assert "15 of 19" in page._cards["observation"].object
    assert "Source task 2" in page._cards["task"].object
    assert set(page._lattice.nodes.data["caption"]) == {""}  # the shipped policies learned another world


@pytest.mark.parametrize("wrong", ["nowhere", "../../etc/passwd", "/etc/passwd", "<img src=x>"])
def test_an_address_opens_no_other_file(app: AppContext, monkeypatch: pytest.MonkeyPatch, wrong: str) -> None:
    page = _open(app, monkeypatch, scenario=wrong)
    assert page._picker.value == "default"
    assert "is not known here, so default is taken" in page._alert.object
    assert "<img" not in page._alert.object


def test_another_scenario_changes_everything_at_once(app: AppContext, monkeypatch: pytest.MonkeyPatch) -> None:
    page = _open(app, monkeypatch, mask="2,4")
    page._picker.value = SIX
    assert len(page._lattice.nodes.data["mask"]) == 64
    assert "15 of 19" in page._cards["observation"].object
    nodes = page._lattice.nodes
    nodes.selected.indices = [list(nodes.data["mask"]).index("1,6")]
    assert page._pictures.masked == [1, 6]
    page._picker.value = "short-range"
    assert page._pictures.masked == [1]
    assert len(page._lattice.nodes.data["mask"]) == 4
    assert "9 of 11" in page._cards["observation"].object
    page._picker.value = "default"
    assert "99" in "".join(page._lattice.nodes.data["caption"])


def test_the_cards_of_six_missiles() -> None:
    task = task_for(SIX, "4,5,6")
    assert "Source task 3" in task_card(task)
    assert observation_card(task).count("chip gone") == 6
    assert reward_card(task).count("chip") == 9  # the box, goal, six missiles, time


def test_a_launch_names_the_scenario(app: AppContext) -> None:
    form = LaunchForm(app.store, {}, lambda runs: None)
    form.show(task_for(SIX), SIX)
    assert form.configurations() == [TrainingConfig(scenario=SIX, curriculum=True)]
    assert "on <b>six-missiles</b>; 6 stages" in form._summary.object
    form.widgets["what"].value = STAGE
    form.show(task_for(SIX, "3,4,5,6"), SIX)
    assert form._button.disabled
    assert "choose one with --guide" in form._summary.object
    form.widgets["guide"].value = "submas-source-3"
    assert not form._button.disabled


def test_the_cost_of_six_stages_is_that_of_six() -> None:
    chains = [TrainingConfig(curriculum=True, scenario=name) for name in ("default", SIX)]
    four, six = (estimate(config, 1, []) for config in chains)
    assert (four.stages, six.stages) == (4, 6)
    assert six.at_most_s == pytest.approx(1.5 * four.at_most_s)


def test_live_and_runs_say_where_it_learns(app: AppContext) -> None:
    run = app.store.create(TrainingConfig(scenario=SIX, curriculum=True))
    run.write_state(RunState("stopped"))
    assert json.loads(opened_live(app, run=run.id).head.facts)["scenario"] == SIX
    app.index.look()
    assert run_line(app.index.find()[0], RunsSettings())["task"] == "Curriculum 1–6 · six-missiles"
    names = [task.name for task in stage_tasks(run.config)]
    assert names == ["source-5", "source-4", "source-3", "source-2", "source-1", "target"]


def test_flying_a_run_leads_to_its_scenario_and_masks_what_it_cannot_see(app: AppContext) -> None:
    run = app.store.create(TrainingConfig(scenario=SIX, missiles=4, guide="submas-source-1"))
    assert fly_address(run) == f"/fly?a={run.id}&scenario=six-missiles&mask=5%2C6"
    assert fly_address(app.store.create(TrainingConfig(missiles=3))).endswith("&mask=4")


def test_scenario_files_of_runs_are_on_offer_while_they_can_be_read(app: AppContext, tmp_path: Path) -> None:
    own = tmp_path / "own.toml"
    own.write_text((Path(__file__).parents[3] / "assets/scenarios/short-range.toml").read_text(encoding="utf-8"))
    run = app.store.create(TrainingConfig(scenario=str(own)))
    assert scenario_choices(app.store)[f"own.toml ({tmp_path})"] == str(own)
    own.unlink()
    assert str(own) not in scenario_choices(app.store).values()
    assert fly_address(run) == f"/fly?a={run.id}"
    assert "own.toml" in opened_live(app, run=run.id).alert.object
