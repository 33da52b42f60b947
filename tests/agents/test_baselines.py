"""SAC and PPO as trainings: they learn, report, stop, keep the best, and leave a run like any other."""

from __future__ import annotations

import dataclasses
import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from agents.baselines import learn_baseline
from agents.config import PROFILES, VARIANTS, ConfigError, TrainingConfig
from agents.evaluation import evaluate
from agents.expert import NavigationExpert
from agents.stage import Stage
from agents.submas import train
from tests.agents.point_robot import POINT_ROBOT, PointRobot, RobotTask, RobotWorld
from tests.agents.recording import Recording
from tests.agents.stages import HYPER
from workbench import cli, training
from workbench.estimate import TYPICAL_EPOCH_S, estimate
from workbench.policies import guide_for, resolve_policy
from workbench.run_files import append_line
from workbench.runs import RunStore

BASELINES = ("sac", "ppo")
PROBE = dataclasses.replace(
    PROFILES["fast"],
    hidden=(32, 32),
    replay_size=20_000,
    epochs=3,
    steps_per_epoch=2_048,
    batch_size=64,
    learning_rate=1e-3,
    gamma=0.95,
    lanes=32,
    updates_per_lane_step=4,
    return_steps=1,
    reward_scale=1.0,
    evaluate_every=1,
    evaluation_episodes=100,
    promotion_success=2.0,
)
"""Enough for the point robot where nothing is in its way."""


class ContraryWorld(RobotWorld):
    """Pays for what it should fine, and the other way round."""

    def _reward_terms(self, alive: np.ndarray) -> np.ndarray:
        return -super()._reward_terms(alive)


class Contrary(PointRobot):
    """The domain of that world."""

    def world(self, task: RobotTask, lanes: int, seed: int) -> RobotWorld:
        return ContraryWorld(task, lanes, seed)


def learned_success(variant: str, domain: PointRobot) -> float:
    """Success rate after the last epoch on the open plane."""
    task, recording = RobotTask(frozenset({1, 2})), Recording()
    config = TrainingConfig(missiles=1, variant=variant)  # type: ignore[arg-type]
    stage = Stage(
        task=task, source=task, guide=NavigationExpert(), domain=domain, hyper=PROBE,
        variant=VARIANTS[variant], config=config,
    )  # fmt: skip
    learn_baseline(stage, recording)
    return recording.rows[-1]["success_rate"]


@pytest.mark.slow
@pytest.mark.parametrize("variant", BASELINES)
def test_it_learns_where_there_is_a_little_to_learn(variant: str) -> None:
    assert learned_success(variant, POINT_ROBOT) >= 0.9


@pytest.mark.slow
@pytest.mark.parametrize("variant", BASELINES)
def test_with_the_reward_turned_round_the_same_training_fails(variant: str) -> None:
    assert learned_success(variant, Contrary()) <= 0.3


def small(variant: str, stop_after: int | None = None, **changes: object) -> Recording:
    """A training of a second."""
    recording = Recording(stop_after)
    config = TrainingConfig(missiles=1, variant=variant, seed=2)  # type: ignore[arg-type]
    hyper = dataclasses.replace(HYPER, **changes)
    train(config, recording, NavigationExpert(), domain=POINT_ROBOT, hyperparameters=hyper)
    return recording


@pytest.mark.parametrize("variant", BASELINES)
def test_rows_have_the_columns_of_our_own_learner(variant: str) -> None:
    recording, ours = small(variant), small("td3", epochs=1).rows[0]
    assert [set(row) for row in recording.rows] == [set(ours)] * 2
    first, last = recording.rows
    absent = ("alpha", "epsilon", "beta", "transfer_share", "guide_share", "q_mean")
    assert all(row[name] is None for row in recording.rows for name in absent)
    assert all(type(value) in (int, float, str, list, type(None)) for value in last.values())
    assert (first["env_steps"], last["env_steps"], last["epoch"], last["epochs"]) == (200, 400, 2, 2)
    assert last["critic_loss"] > 0.0 and last["actor_loss"] is not None and last["updates"] > first["updates"]
    assert first["eta_s"] == pytest.approx(first["wall_s"]) and last["eta_s"] == 0.0


@pytest.mark.parametrize(
    ("variant", "words"), [("td3", "learned from scratch"), ("wo-pr", "guided by expert-navigation")]
)
def test_only_a_stage_with_a_guide_says_that_it_has_one(variant: str, words: str) -> None:
    begun = [text for kind, text, _ in small(variant, epochs=1).events if kind == "stage_started"]
    assert begun == [f"source-1 {words}"]


@pytest.mark.parametrize("variant", BASELINES)
def test_the_kept_policy_is_the_best_of_all_evaluations(variant: str) -> None:
    recording = small(variant, epochs=4)
    policy, card = recording.policies[-1]
    best = max((row["success_rate"], row["return_mean"]) for row in recording.rows)
    kept = recording.policies[-2][1].evaluation
    assert kept is not None and (kept["success_rate"], kept["mean_return"]) == best
    assert (card.name, card.variant, card.final) == (f"{variant}-source-1", variant, True)
    assert (card.activation, card.squash) == (policy.activation, policy.squash)
    assert recording.kinds()[1] == "stage_started" and recording.kinds()[-1] == "stage_finished"
    again = evaluate(policy, RobotTask(frozenset({2})), 10, kept["seed"], domain=POINT_ROBOT)
    assert again.policy == policy.name


@pytest.mark.parametrize("variant", BASELINES)
def test_a_stop_ends_it_after_the_epoch_with_a_policy(variant: str) -> None:
    recording = small(variant, stop_after=1, epochs=9, evaluate_every=5)
    assert len(recording.rows) == 1 and "stopped" in recording.kinds()
    assert recording.rows[0]["success_rate"] is None and recording.policies[-1][1].final


@pytest.mark.parametrize("variant", BASELINES)
def test_what_passes_three_times_ends_early_as_our_own_stages_do(variant: str) -> None:
    recording = small(variant, epochs=9, promotion_success=0.0)
    assert len(recording.rows) == 1 and "promoted" in recording.kinds()


@pytest.mark.parametrize("variant", BASELINES)
def test_a_seed_trains_the_same_policy_again(variant: str) -> None:
    first, again = small(variant).rows[-1], small(variant).rows[-1]
    assert [first[name] for name in ("critic_loss", "return_mean")] == [
        again[name] for name in ("critic_loss", "return_mean")
    ]


def test_from_scratch_the_budget_is_that_of_the_whole_curriculum_but_in_the_papers_profile() -> None:
    for variant in (*BASELINES, "td3"):
        budget = {name: TrainingConfig(variant=variant, profile=name).hyperparameters.epochs for name in PROFILES}  # type: ignore[arg-type]
        assert budget == {"paper": 300, "fast": 4 * PROFILES["fast"].epochs, "smoke": 4 * PROFILES["smoke"].epochs}
    assert TrainingConfig(variant="sac", missiles=2).hyperparameters.epochs == 2 * PROFILES["fast"].epochs
    for config in (TrainingConfig(), TrainingConfig(variant="wo-pr"), TrainingConfig(variant="td3", curriculum=True)):
        assert config.hyperparameters is PROFILES["fast"]


REFUSED = [
    ({"curriculum": True}, "variant '{}' learns its task from scratch and has no curriculum; train a single stage"),
    ({"guide": "submas-source-1"}, "variant '{}' learns without a guide, and guide is 'submas-source-1'"),
]


@pytest.mark.parametrize("variant", BASELINES)
@pytest.mark.parametrize(("values", "sentence"), REFUSED, ids=["curriculum", "guide"])
def test_neither_a_curriculum_nor_a_guide_is_taken(variant: str, values: dict[str, object], sentence: str) -> None:
    with pytest.raises(ConfigError) as caught:
        TrainingConfig.from_json({"variant": variant, **values})
    assert str(caught.value).startswith(sentence.format(variant)) and "\n" not in str(caught.value)
    assert TrainingConfig(variant="td3", **values).variant == "td3"  # type: ignore[arg-type]


def test_the_command_refuses_a_curriculum_in_a_sentence(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["train", "--curriculum", "--variant", "sac"]) == 2
    out, err = capsys.readouterr()
    assert (
        out == "" and err.startswith("workbench: variant 'sac' learns its task from scratch") and err.count("\n") == 1
    )


def test_a_scenario_without_shipped_policies_needs_none() -> None:
    assert guide_for(TrainingConfig(variant="ppo", scenario="six-missiles")).name == "expert-navigation"


def test_the_estimate_looks_at_runs_of_the_same_algorithm(tmp_path: Path) -> None:
    store, config = RunStore(tmp_path), TrainingConfig(variant="sac", profile="smoke")
    append_line(store.create(TrainingConfig(profile="smoke")).path / "metrics.jsonl", {"epoch": 1, "wall_s": 99.0})
    assert estimate(config, 1, store.list()).at_most_s == 4 * PROFILES["smoke"].epochs * TYPICAL_EPOCH_S["smoke"]
    append_line(store.create(config).path / "metrics.jsonl", {"epoch": 2, "wall_s": 10.0})
    assert estimate(config, 1, store.list()).at_most_s == 4 * PROFILES["smoke"].epochs * 5.0


@pytest.fixture
def _signals() -> Iterator[None]:
    before = [(number, signal.getsignal(number)) for number in (signal.SIGINT, signal.SIGTERM)]
    yield
    for number, handler in before:
        signal.signal(number, handler)


@pytest.mark.usefixtures("_signals")
@pytest.mark.parametrize("variant", BASELINES)
def test_a_run_folder_is_that_of_any_training(variant: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    store = RunStore(tmp_path / "runs")
    config = TrainingConfig(missiles=1, variant=variant, profile="smoke")  # type: ignore[arg-type]
    run = store.create(config)
    assert training.main([str(run.path)]) == 0
    run = RunStore(store.root).get(run.id)
    assert (run.state.state, run.state.progress, run.state.error) == ("finished", 1.0, "")
    assert [row["epoch"] for row in run.metrics()] == [1, 2]
    # Nothing but text and safetensors: the library's own files hold pickles.
    suffixes = {path.suffix for path in run.path.rglob("*") if path.is_file()}
    assert suffixes <= {".json", ".jsonl", ".safetensors", ".lock"}
    assert resolve_policy(run.id, store).name == f"{variant}-source-3"
    capsys.readouterr()
    line = f"evaluate {run.id} --mask 2,3,4 --episodes 20 --runs {store.root} --json"
    assert cli.main(line.split()) == 0
    assert json.loads(capsys.readouterr().out)["policy"] == f"{variant}-source-3"


@pytest.mark.usefixtures("_signals")
def test_the_stop_file_stops_a_run(tmp_path: Path) -> None:
    run = RunStore(tmp_path / "runs").create(TrainingConfig(variant="ppo", profile="smoke"))
    (run.path / "stop").touch()
    assert training.main([str(run.path)]) == 0
    assert run.state.state == "stopped" and run.metrics() == []


def test_the_library_is_imported_by_who_trains_with_it_alone() -> None:
    code = (
        "import sys, workbench.cli, workbench.training, agents.submas, agents.config, agents.checkpoint\n"
        "workbench.cli.main(['train', '--help'])\n"
        "sys.exit('stable_baselines3' in sys.modules)"
    )
    root = Path(__file__).parents[2]
    assert subprocess.run([sys.executable, "-c", code], cwd=root, capture_output=True).returncode == 0
