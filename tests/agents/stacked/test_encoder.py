"""Features on the device are the features of NumPy; smaller layouts and the transfer mask are found by name."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pytest
import torch

from agents.evasion import EVASION
from agents.expert import DraggingExpert
from agents.features import ObservationFeatures, adapt
from agents.policy import NetworkPolicy
from agents.stacked.encoder import Encoder, feature_names
from agents.transfer_mask import TransferMask
from sim.observation import UNLAUNCHED
from sim.task import Task, task_for
from sim.world import World
from tests.agents.point_robot import POINT_ROBOT

TARGET = task_for()


def _observations(task: Task) -> np.ndarray:
    """Of flights in which every missile is and is not in the air."""
    world, expert = World(task, 32, seed=3), DraggingExpert()
    seen = [world.observation]
    for _ in range(800):
        seen.append(world.step(expert.act(seen[-1], task.layout)).observation)
    return np.concatenate(seen[::20])


@pytest.mark.parametrize(
    "features", [EVASION.features(TARGET.layout), POINT_ROBOT.features(POINT_ROBOT.layout((1, 2)))]
)
def test_features_are_those_of_numpy(features: ObservationFeatures) -> None:
    draws = np.random.default_rng(0)
    observation = draws.normal(0.0, 2.0, (50, features.layout.size)).astype(np.float32)
    for subtask in features.subtasks:
        observation[draws.random(50) < 0.4, features.layout.block(subtask)] = features.default_block
    found = Encoder(features, "cpu").encode(torch.from_numpy(observation))
    np.testing.assert_allclose(found.numpy(), features.encode(observation), rtol=1e-6, atol=1e-6)
    assert found.dtype == torch.float32 and len(feature_names(features)) == features.size


@pytest.mark.parametrize("masked", [(4,), (2, 4), (1, 2, 3)])
def test_a_smaller_task_is_some_columns_of_the_widest_and_zeros_elsewhere(masked: tuple[int, ...]) -> None:
    task = TARGET.mask(masked)
    observation = _observations(task)
    encoder, own = Encoder(EVASION.features(TARGET.layout), "cpu"), EVASION.features(task.layout)
    wide = encoder.encode(torch.from_numpy(adapt(observation, task.layout, TARGET.layout, UNLAUNCHED))).numpy()
    columns = encoder.columns(own)
    np.testing.assert_allclose(wide[:, columns], own.encode(observation), rtol=1e-6, atol=1e-6)
    assert not np.delete(wide, columns, axis=1).any()


@pytest.mark.parametrize(("masked", "source"), [((4,), (3, 4)), ((), (1, 4)), ((), (4,))])
def test_the_flags_tell_the_transfer_condition(masked: tuple[int, ...], source: tuple[int, ...]) -> None:
    task, easier = TARGET.mask(masked), TARGET.mask(source)
    observation = _observations(task)
    encoder = Encoder(EVASION.features(TARGET.layout), "cpu")
    wide = encoder.encode(torch.from_numpy(adapt(observation, task.layout, TARGET.layout, UNLAUNCHED)))
    allowed = (wide * encoder.fresh_flags(task.layout, easier.layout)).sum(dim=1) == 0.0
    expected = TransferMask(task.layout, easier.layout, UNLAUNCHED).allowed(observation)
    assert np.array_equal(allowed.numpy(), expected)
    assert 0 < expected.sum() < len(expected)


def test_a_guide_network_reads_its_columns_among_the_widest() -> None:
    from agents.config import VARIANTS, TrainingConfig
    from agents.hyperparameters import SMOKE
    from agents.layers import Shape
    from agents.stacked.guides import Kind, StackedGuides
    from agents.stage import Stage

    draws = np.random.default_rng(1)
    known, source = TARGET.mask([2, 4]), TARGET.mask([2, 3, 4])  # the guide knows a missile that the source lacks
    features = EVASION.features(known.layout)
    widths = [features.size, 8, 8, 1]
    layers = [
        (draws.normal(0, 0.5, (out, into)).astype(np.float32), draws.normal(0, 0.5, out).astype(np.float32))
        for into, out in pairwise(widths)
    ]
    guide = NetworkPolicy("guide", features, layers, EVASION.action_limit)
    stage = Stage(
        task=TARGET, source=source, guide=guide, domain=EVASION, hyper=SMOKE, variant=VARIANTS["submas"],
        config=TrainingConfig(),
    )  # fmt: skip
    encoder = Encoder(EVASION.features(TARGET.layout), "cpu")
    guides = StackedGuides(
        2, Shape((encoder.features.size, 8, 8, 1)), encoder, EVASION.action_limit, torch.device("cpu")
    )
    guides.place(1, stage)
    assert guides.kinds == [Kind.NONE, Kind.NETWORK]
    observation = torch.from_numpy(_observations(TARGET)).expand(2, -1, -1)
    own = torch.zeros(2, observation.shape[1], 1)
    found = guides.actions(encoder.encode(observation), observation, own)
    shared = stage.transfer_mask.shared(observation[1].numpy())
    np.testing.assert_allclose(found[1].numpy(), guide.act(shared, source.layout), rtol=1e-4, atol=1e-5)
    assert not found[0].any()
    assert guides.take([1]).kinds == [Kind.NETWORK]
    alone = guides.take([1]).actions(encoder.encode(observation[1:]), observation[1:], own[1:])
    torch.testing.assert_close(alone, found[1:], rtol=1e-5, atol=1e-6)
