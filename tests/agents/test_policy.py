"""Binding policies to tasks, and the network policy against torch."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from agents.evasion import EVASION
from agents.expert import DraggingExpert
from agents.networks import Actor
from agents.policy import NetworkPolicy, PolicyError, bind
from sim.errors import UsageError
from sim.observation import UNLAUNCHED, ObservationLayout
from sim.task import task_for


def network_policy(missiles: tuple[int, ...], name: str = "submas-test", seed: int = 0) -> NetworkPolicy:
    features = EVASION.features(ObservationLayout(missiles))
    torch.manual_seed(seed)
    actor = Actor(features.size, (32, 16))
    layers = [(layer.weight.detach().numpy(), layer.bias.detach().numpy()) for layer in actor.layers]
    return NetworkPolicy(name, features, layers, EVASION.action_limit)


def observations(layout: ObservationLayout, rows: int = 50) -> np.ndarray:
    generator = np.random.default_rng(0)
    drawn = generator.uniform(-3.0, 3.0, (rows, layout.size)).astype(np.float32)
    drawn[:, [0, 1, 3]] *= 30_000.0
    return drawn


def test_the_network_policy_computes_what_torch_computes() -> None:
    policy = network_policy((1, 2))
    torch.manual_seed(0)
    actor = Actor(policy.features.size, (32, 16))
    seen = observations(policy.layout)
    with torch.no_grad():
        expected = actor(torch.from_numpy(policy.features.encode(seen))).numpy() * EVASION.action_limit
    np.testing.assert_allclose(policy.act(seen, policy.layout), expected, atol=1e-5)


def test_actions_are_float32_columns_within_the_limit() -> None:
    action = network_policy((1,)).act(observations(ObservationLayout((1,))) * 1e6, ObservationLayout((1,)))
    assert action.shape == (50, 1) and action.dtype == np.float32
    assert np.abs(action).max() <= EVASION.action_limit


@pytest.mark.parametrize("rows", [1, 2, 3, 7, 15, 16, 17, 100, 999])
def test_an_action_does_not_depend_on_how_many_are_asked_for_at_once(rows: int) -> None:
    features = EVASION.features(ObservationLayout((1, 2, 3, 4)))
    actor = Actor(features.size, (256, 256))
    layers = [(layer.weight.detach().numpy(), layer.bias.detach().numpy()) for layer in actor.layers]
    policy = NetworkPolicy("wide", features, layers, EVASION.action_limit)
    seen = observations(policy.layout, 1024)
    np.testing.assert_array_equal(policy.act(seen[:rows], policy.layout), policy.act(seen, policy.layout)[:rows])


def test_a_policy_flies_tasks_with_fewer_missiles_as_if_they_never_came() -> None:
    policy, task = network_policy((1, 2, 3, 4)), task_for("default", "1,4")
    seen = observations(task.layout)
    filled = np.empty((50, 15), np.float32)
    filled[:, :7] = seen[:, :7]
    filled[:, 7:] = np.tile(UNLAUNCHED, 4)
    filled[:, 9:13] = seen[:, 7:]
    np.testing.assert_array_equal(bind(policy, task)(seen), policy.act(filled, policy.layout))


def test_a_blind_policy_says_what_to_mask() -> None:
    policy = network_policy((1,), "submas-source-3")
    with pytest.raises(PolicyError) as caught:
        bind(policy, task_for())
    assert str(caught.value) == (
        "policy 'submas-source-3' was trained with missile 1 and cannot see missiles 2, 3, 4 of this task; "
        "mask them (--mask 2,3,4)"
    )
    assert isinstance(caught.value, UsageError)


def test_one_unseen_missile_is_named_in_the_singular() -> None:
    with pytest.raises(PolicyError, match=r"missiles 1, 2, 3 and cannot see missile 4 of this task; mask it"):
        bind(network_policy((1, 2, 3)), task_for())


def test_experts_read_any_layout() -> None:
    for mask in ("", "1,2,3,4", "2"):
        task = task_for("default", mask)
        assert bind(DraggingExpert(), task)(observations(task.layout)).shape == (50, 1)
