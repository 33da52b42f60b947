"""A user's story with six missiles: train the chain, fly and evaluate its policy, see it all on the pages."""

from __future__ import annotations

import dataclasses
import json
from itertools import combinations
from pathlib import Path

import pytest
import tyro

from agents.card import command_of
from agents.checkpoint import save_policy
from agents.config import TrainingConfig
from agents.curriculum import build_curriculum, create_tasks
from agents.expert import NavigationExpert
from agents.hyperparameters import SMOKE, ConfigError
from agents.submas import train
from sim.scenario_file import load_scenario
from sim.task import Task
from sim.world import World
from tests.agents.recording import Recording
from workbench import cli
from workbench.policies import UnknownPolicyError, guide_for, natural_guide, shipped_success, title
from workbench.seeds import parse_seeds

SIX = "six-missiles"
TARGET = Task(load_scenario(SIX))
TINY = dataclasses.replace(
    SMOKE, epochs=1, steps_per_epoch=512, update_after=256, evaluate_every=1, evaluation_episodes=4
)


def test_six_missiles_are_nineteen_columns_sixty_four_tasks_and_a_chain_of_seven() -> None:
    assert TARGET.layout.size == 7 + 12
    assert World(TARGET, 2).observation.shape == (2, 19)
    masks = {frozenset(masked) for size in range(7) for masked in combinations(range(1, 7), size)}
    assert len({Task(TARGET.scenario, masked).name for masked in masks}) == len(masks) == 64
    assert len(create_tasks(TARGET, TARGET.missiles)) == 63
    chain = build_curriculum(TARGET, (6, 5, 4, 3, 2, 1)).tasks
    assert [task.name for task in chain] == ["target", *(f"source-{k}" for k in range(1, 7))]
    assert [len(task.missiles) for task in chain] == [6, 5, 4, 3, 2, 1, 0]


@pytest.fixture(scope="module")
def learned(tmp_path_factory: pytest.TempPathFactory) -> tuple[Recording, Path]:
    """The chain of six stages, from nothing, with tiny settings, and a file of its policy."""
    recording = Recording()
    config = TrainingConfig(scenario=SIX, curriculum=True, profile="smoke")
    policy = train(config, recording, NavigationExpert(), hyperparameters=TINY)
    path = tmp_path_factory.mktemp("six") / "six.safetensors"
    save_policy(path, policy, recording.policies[-1][1])  # type: ignore[arg-type]
    return recording, path


def test_the_chain_is_learned_stage_by_stage(learned: tuple[Recording, Path]) -> None:
    recording, _ = learned
    stages = [*(f"source-{k}" for k in range(5, 0, -1)), "target"]
    assert [row["task"] for row in recording.rows] == stages
    assert {row["stages"] for row in recording.rows} == {6}
    card = recording.policies[-1][1]
    assert (card.missiles, card.scenario, card.scenario_digest) == ((1, 2, 3, 4, 5, 6), SIX, TARGET.scenario.digest)


def test_its_policy_flies_and_is_evaluated_without_a_warning(
    learned: tuple[Recording, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    path = str(learned[1])
    assert cli.main(["fly", path, "--scenario", SIX, "--json"]) == 0
    flown = json.loads(capsys.readouterr().out)
    assert (flown["scenario"], flown["missiles"], flown["warning"]) == (SIX, [1, 2, 3, 4, 5, 6], None)
    assert cli.main(["evaluate", path, "--scenario", SIX, "--mask", "2,6", "--episodes", "4", "--json"]) == 0
    figures = json.loads(capsys.readouterr().out)
    assert (figures["missiles"], figures["warning"]) == ([1, 3, 4, 5], None)


def test_away_from_home_it_flies_and_says_so(
    learned: tuple[Recording, Path], capsys: pytest.CaptureFixture[str]
) -> None:
    path, digests = str(learned[1]), (TARGET.scenario.digest, load_scenario().digest)
    assert cli.main(["fly", path]) == 0
    err = capsys.readouterr().err
    assert err.startswith("workbench: warning: policy 'submas-target' was trained on scenario 'six-missiles'")
    assert all(digest in err for digest in digests)
    assert err.count("\n") == 1
    assert cli.main(["evaluate", path, "--episodes", "4", "--json"]) == 0
    figures = json.loads(capsys.readouterr().out)
    assert "not on 'default'" in figures["warning"]
    assert figures["scenario_digest"] == digests[1]


def test_a_copy_of_a_scenario_is_the_same_world(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    copy = tmp_path / "mine.toml"
    text = (Path(__file__).parents[2] / "assets/scenarios/default.toml").read_text(encoding="utf-8")
    copy.write_text(text.replace('name = "default"', 'name = "mine"'), encoding="utf-8")
    assert cli.main(["fly", "submas-target", "--scenario", str(copy), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["warning"] is None
    copy.write_text(text.replace("fuse_m = 18.0", "fuse_m = 19.0"), encoding="utf-8")
    assert cli.main(["fly", "submas-target", "--scenario", str(copy), "--json"]) == 0
    assert "not on 'default'" in json.loads(capsys.readouterr().out)["warning"]


def test_missiles_are_counted_when_nobody_says_how_many() -> None:
    assert TrainingConfig(scenario=SIX).missiles == 6
    assert TrainingConfig.from_json({"scenario": "short-range"}).missiles == 2
    assert TrainingConfig(scenario=SIX, missiles=2).missiles == 2
    with pytest.raises(ConfigError, match="missiles is 4; legal with scenario 'short-range' is 1 to 2"):
        train(TrainingConfig(scenario="short-range", missiles=4), Recording(), NavigationExpert())


def test_natural_guides_are_those_of_the_very_scenario() -> None:
    assert [natural_guide(TrainingConfig(missiles=n)) for n in (1, 2, 3, 4)] == [
        "expert-navigation", "submas-source-3", "submas-source-2", "submas-source-1",
    ]  # fmt: skip
    assert natural_guide(TrainingConfig(scenario=SIX, missiles=1)) == "expert-navigation"
    assert natural_guide(TrainingConfig(scenario=SIX, curriculum=True)) == "expert-navigation"
    # Five of six are guided by four of six, which is a source task 2 as well, but not the shipped one.
    assert natural_guide(TrainingConfig(scenario=SIX, missiles=5)) == ""
    with pytest.raises(UnknownPolicyError, match=r"2 missiles of scenario 'six-missiles' is shipped.*--guide"):
        guide_for(TrainingConfig(scenario=SIX, missiles=3))
    assert guide_for(TrainingConfig(scenario=SIX, missiles=3, guide="submas-source-2")).name == "submas-source-2"


def test_shipped_figures_belong_to_the_scenario_they_were_measured_on() -> None:
    assert sorted(shipped_success(load_scenario())) == [1, 2, 3, 4]
    assert shipped_success(load_scenario(SIX)) == {}


def test_a_training_is_told_with_its_scenario_only_where_it_is_another() -> None:
    assert title(TrainingConfig(curriculum=True)) == "Whole curriculum · submas · fast · seed 0"
    assert title(TrainingConfig(scenario=SIX, missiles=5)) == "5 missiles · six-missiles · submas · fast · seed 0"
    own = TrainingConfig(scenario="/home/me/hard.toml", missiles=1, name="mine")
    assert title(own) == "mine · hard.toml · submas · fast · seed 0"


@pytest.mark.parametrize(
    "config",
    [
        TrainingConfig(curriculum=True, seed=3),
        TrainingConfig(scenario=SIX, curriculum=True, profile="smoke"),
        TrainingConfig(scenario=SIX, missiles=5, guide="submas-source-1", variant="wo-pr"),
    ],
    ids=["chain", "chain of six", "stage"],
)
def test_the_command_on_a_card_asks_for_the_same_training(config: TrainingConfig) -> None:
    words = command_of(config).split()[2:]
    args = tyro.cli(cli.command("train").Args, args=words)
    (seed,) = parse_seeds(args.seeds)
    assert cli.command("train").configuration(args, seed) == config
