"""A training that goes on from a snapshot is the training that was never interrupted, bit for bit."""

from __future__ import annotations

import copy
import dataclasses
from functools import cache
from typing import Any

import numpy as np
import pytest

from agents.arrays import below
from agents.config import TrainingConfig
from agents.expert import NavigationExpert, RandomPolicy
from agents.policy import Policy
from agents.snapshot import Snapshot, SnapshotError
from agents.submas import train
from tests.agents.point_robot import POINT_ROBOT, PointRobot, RobotTask
from tests.agents.recording import Kept, Recording
from tests.agents.stages import HYPER

TIMES = ("wall_s", "cpu_s", "eta_s", "updates_per_s", "env_steps_per_s")
SMALL = dataclasses.replace(
    HYPER,
    epochs=3,
    steps_per_epoch=160,
    evaluate_every=2,
    evaluation_episodes=4,
    final_episodes=4,
    replay_size=1_000,
    return_steps=5,
    actor_average=0.99,
)
"""480 transitions in a ring of 1000; with three times the steps it comes round."""
CURRICULUM = TrainingConfig(curriculum=True, missiles=2, seed=4)
SINGLE = TrainingConfig(missiles=1, seed=1)


def recorded(
    config: TrainingConfig,
    snapshot: Snapshot | None = None,
    guide: Policy | None = None,
    domain: PointRobot = POINT_ROBOT,
    **changes: object,
) -> Recording:
    """A training of a second that keeps a snapshot of every epoch."""
    recording = Recording()
    recording.keep_snapshots = True
    hyper = dataclasses.replace(SMALL, **changes)
    train(config, recording, guide or NavigationExpert(), domain=domain, hyperparameters=hyper, snapshot=snapshot)
    return recording


@cache
def whole(config: TrainingConfig, **changes: object) -> Recording:
    """The training that nothing interrupts; nobody may change it."""
    return recorded(config, **changes)


def rows(recording: Recording) -> list[dict[str, Any]]:
    return [{name: value for name, value in row.items() if name not in TIMES} for row in recording.rows]


def weights(recording: Recording) -> list[np.ndarray]:
    return [part for layer in recording.policies[-1][0].layers for part in layer]


def assert_same_end(resumed: Recording, uninterrupted: Recording) -> None:
    """The rows of a resumed training are the last rows of the whole one, and its policy is the same."""
    count = len(resumed.rows)
    assert rows(resumed) == rows(uninterrupted)[len(uninterrupted.rows) - count :]
    for ours, theirs in zip(weights(resumed), weights(uninterrupted), strict=True):
        np.testing.assert_array_equal(ours, theirs)
    ours, theirs = resumed.snapshots[-1], uninterrupted.snapshots[-1]
    assert plain(ours.values) == plain(theirs.values)
    assert ours.arrays.keys() == theirs.arrays.keys()
    for name, array in ours.arrays.items():
        np.testing.assert_array_equal(array, theirs.arrays[name], err_msg=name)
    assert experience(ours) == experience(theirs)


def plain(values: Any) -> Any:
    """Without what a clock has measured."""
    if isinstance(values, dict):
        return {name: plain(value) for name, value in values.items() if name not in TIMES}
    return values


def experience(snapshot: Snapshot) -> bytes:
    """Every transition in the order in which it was made."""
    return b"".join(rows.tobytes() for _, rows in snapshot.slots.blocks(0)) if snapshot.slots else b""


def test_a_curriculum_goes_on_from_every_epoch_of_every_stage() -> None:
    uninterrupted = whole(CURRICULUM)
    assert [snapshot.stage for snapshot in uninterrupted.snapshots] == [0, 0, 0, 1, 1, 1]
    for number, snapshot in enumerate(uninterrupted.snapshots[:5], start=1):
        resumed = recorded(CURRICULUM, snapshot)
        assert len(resumed.rows) == 6 - number
        assert_same_end(resumed, uninterrupted)


def test_after_its_last_epoch_only_the_verdict_is_left() -> None:
    uninterrupted = whole(CURRICULUM)
    resumed = recorded(CURRICULUM, uninterrupted.snapshots[-1])
    assert resumed.rows == [] and resumed.kinds() == ["stage_finished"]
    for ours, theirs in zip(weights(resumed), weights(uninterrupted), strict=True):
        np.testing.assert_array_equal(ours, theirs)


@pytest.mark.parametrize("variant", ["wo-pd", "wo-pr", "dec-pd", "dec-pr", "td3", "sac", "ppo"])
def test_every_variant_and_baseline_goes_on(variant: str) -> None:
    config = TrainingConfig(missiles=1, variant=variant, seed=1)  # type: ignore[arg-type]
    assert_same_end(recorded(config, whole(config).snapshots[1]), whole(config))


@pytest.mark.parametrize("variant", ["sac", "td3"])
def test_so_does_one_whose_replay_came_round(variant: str) -> None:
    config = TrainingConfig(missiles=1, variant=variant, seed=1)  # type: ignore[arg-type]
    uninterrupted = whole(config, steps_per_epoch=480)
    assert_same_end(recorded(config, uninterrupted.snapshots[1]), uninterrupted)


def test_a_random_guide_goes_on_drawing_where_it_was() -> None:
    config = TrainingConfig(missiles=1, seed=2)
    uninterrupted = recorded(config, guide=RandomPolicy(7))
    assert_same_end(recorded(config, uninterrupted.snapshots[1], guide=RandomPolicy(7)), uninterrupted)


def test_the_numbers_of_the_snapshot_count_and_not_those_of_today() -> None:
    uninterrupted = whole(CURRICULUM)
    assert_same_end(recorded(CURRICULUM, uninterrupted.snapshots[3], learning_rate=0.01, lanes=4), uninterrupted)


def test_the_weights_of_transfer_go_on_where_they_were() -> None:
    # In the curriculum above nothing succeeds, so that α and ε stay where they began.
    uninterrupted = whole(SINGLE, epochs=5, evaluate_every=1)
    snapshot = uninterrupted.snapshots[1]
    assert snapshot.values["alpha"] < 1.0 and snapshot.values["epsilon"] < uninterrupted.snapshots[0].values["epsilon"]
    assert_same_end(recorded(SINGLE, snapshot), uninterrupted)


def test_times_go_on() -> None:
    first = whole(CURRICULUM).snapshots[4]
    older = dataclasses.replace(first, values={**first.values, "wall_s": 1000.0, "cpu_s": 900.0})
    row = recorded(CURRICULUM, older).rows[0]
    assert 1000.0 < row["wall_s"] < 1060.0 and 900.0 < row["cpu_s"] < 960.0


LEAVES = [
    "learner/actor", "learner/critics", "learner/target_actor", "learner/target_critics", "learner/average_actor",
    "learner/actor_optimizer", "learner/critic_optimizer", "learner/generator", "learner/updates", "world", "features",
    "observation", "lane_return",
]  # fmt: skip
VALUES = ["generator", "next_episode", "epsilon", "alpha", "beta", "evaluated_episodes", "finished"]


def spoilt(snapshot: Snapshot, other: Snapshot, name: str) -> Snapshot:
    """The snapshot with one part taken from another epoch."""
    arrays, values = dict(snapshot.arrays), dict(snapshot.values)
    part = below(name, other.arrays)
    arrays |= {f"{name}/{key}": array for key, array in part.items()} or {name: other.arrays[name]}
    return dataclasses.replace(snapshot, arrays=arrays, values=values)


@pytest.mark.parametrize("name", LEAVES)
def test_a_resume_that_forgets_an_array_is_found_out(name: str) -> None:
    # R3, the negative control: without it, equality above would prove nothing about this part.
    good, other = whole(SINGLE).snapshots[1], whole(SINGLE).snapshots[0]
    with pytest.raises(AssertionError):
        assert_same_end(recorded(SINGLE, spoilt(good, other, name)), whole(SINGLE))


@pytest.mark.parametrize("name", VALUES)
def test_a_resume_that_forgets_a_value_is_found_out(name: str) -> None:
    good, other = whole(SINGLE, epochs=4).snapshots[1], whole(SINGLE, epochs=4).snapshots[0]
    values = {**good.values, name: [] if name == "finished" else other.values[name]}
    if values[name] == good.values[name]:
        values[name] = 0.123
    with pytest.raises(AssertionError):
        assert_same_end(recorded(SINGLE, dataclasses.replace(good, values=values)), whole(SINGLE, epochs=4))


def test_a_resume_with_the_experience_of_another_epoch_is_found_out() -> None:
    good = copy.deepcopy(whole(SINGLE).snapshots[1])
    assert isinstance(good.slots, Kept)
    good.slots.kept[0][1][::2] = 0.0
    with pytest.raises(AssertionError):
        assert_same_end(recorded(SINGLE, good), whole(SINGLE))


class Renamed(PointRobot):
    """The same plane, said to be another."""

    def scenario(self, task: RobotTask) -> tuple[str, str]:
        return "plane", "1" * 12


def test_another_scenario_is_refused() -> None:
    snapshot = whole(CURRICULUM).snapshots[0]
    with pytest.raises(SnapshotError, match="scenario 'plane' has changed since the checkpoint; train anew"):
        recorded(CURRICULUM, snapshot, domain=Renamed())


def test_a_stage_that_the_training_does_not_have_is_refused() -> None:
    snapshot = dataclasses.replace(whole(CURRICULUM).snapshots[0], stage=2)
    with pytest.raises(SnapshotError, match="of stage 3, and the training has 2"):
        recorded(CURRICULUM, snapshot)


@pytest.mark.parametrize("missing", ["learner/generator", "world/position", "features"])
def test_a_snapshot_with_a_part_missing_is_a_sentence(missing: str) -> None:
    snapshot = whole(CURRICULUM).snapshots[0]
    arrays = {name: array for name, array in snapshot.arrays.items() if name != missing}
    with pytest.raises(SnapshotError, match="the checkpoint of source-1 does not fit this version"):
        recorded(CURRICULUM, dataclasses.replace(snapshot, arrays=arrays))


@pytest.mark.parametrize("name", ["learner/actor/layers.0.weight", "lane_return", "learner/critic_optimizer/0/exp_avg"])
def test_an_array_of_another_size_is_a_sentence(name: str) -> None:
    snapshot = whole(CURRICULUM).snapshots[0]
    arrays = {**snapshot.arrays, name: snapshot.arrays[name][:-1]}
    with pytest.raises(SnapshotError, match="does not fit this version"):
        recorded(CURRICULUM, dataclasses.replace(snapshot, arrays=arrays))


def test_experience_with_a_gap_is_a_sentence() -> None:
    snapshot = copy.deepcopy(whole(CURRICULUM).snapshots[1])
    assert isinstance(snapshot.slots, Kept)
    first, stored = snapshot.slots.kept[0]
    snapshot.slots.kept[0] = (first + 1, stored)
    with pytest.raises(SnapshotError, match="leave a gap"):
        recorded(CURRICULUM, snapshot)
