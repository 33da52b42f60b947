"""S agents stacked are S agents alone: gradients, parameters, moments; and nobody touches anybody else."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from agents.stacked.learner import StackedTd3
from agents.stacked.parameters import Group
from agents.stacked.residence import move_in
from agents.td3 import Td3
from tests.agents.stacked.stacks import (
    FEATURES,
    LIMIT,
    Alone,
    batches,
    flat,
    flat_networks,
    hyper_for,
    networks,
    stack_of,
    together,
)

CASES = [(layer_norm, two_returns) for layer_norm in (False, True) for two_returns in (False, True)]
SEEDS = (4, 5, 6)
TOLERANCES = [(torch.float32, 1e-5, 2e-5), (torch.float64, 1e-11, 1e-12)]


def _alphas(index: int, dtype: torch.dtype = torch.float32) -> torch.Tensor:
    """Another α for each agent, and another one each time."""
    return torch.tensor([1.0 - index / 20, 0.3, index / 20], dtype=dtype)


def _learn(
    stack: StackedTd3, alone: list[Alone], count: int, dtype: torch.dtype, waiting: tuple[int, ...] = ()
) -> None:
    each = [batches(10 + place, count, dtype) for place in range(len(alone))]
    for index in range(count):
        alpha = _alphas(index, dtype)
        now = [found[index] for found in each]
        stack.update(*together(now), alpha, waiting)
        for place, (one, (batch, noise)) in enumerate(zip(alone, now, strict=True)):
            if place not in waiting:
                one.noise = noise
                one.update(batch, float(alpha[place]))


@pytest.mark.parametrize(("layer_norm", "two_returns"), CASES)
@pytest.mark.parametrize(("dtype", "rtol", "atol"), [(torch.float32, 1e-5, 1e-6), (torch.float64, 1e-11, 1e-13)])
def test_one_update_has_the_gradients_of_autograd(
    layer_norm: bool, two_returns: bool, dtype: torch.dtype, rtol: float, atol: float
) -> None:
    hyper = hyper_for(layer_norm, two_returns, policy_delay=1)
    alone = [Alone(hyper, seed, dtype) for seed in SEEDS]
    stack = stack_of(alone, hyper, dtype)
    _learn(stack, alone, 1, dtype)
    for place, one in enumerate(alone):
        ours = [stack.critics.gradient[place, 0], stack.critics.gradient[place, 1], stack.actor.gradient[place, 0]]
        theirs = [flat(one.critics.first, True), flat(one.critics.second, True), flat(one.actor, True)]
        for mine, oracle in zip(ours, theirs, strict=True):
            torch.testing.assert_close(mine, oracle, rtol=rtol, atol=atol)


@pytest.mark.parametrize(("layer_norm", "two_returns"), CASES)
@pytest.mark.parametrize(("dtype", "rtol", "atol"), TOLERANCES)
def test_three_stacked_agents_equal_three_alone_over_many_updates(
    layer_norm: bool, two_returns: bool, dtype: torch.dtype, rtol: float, atol: float
) -> None:
    hyper = hyper_for(layer_norm, two_returns)
    alone = [Alone(hyper, seed, dtype) for seed in SEEDS]
    stack = stack_of(alone, hyper, dtype)
    _learn(stack, alone, 20, dtype)
    for place, one in enumerate(alone):
        mine = networks(stack, place)
        for name, oracle in flat_networks(one).items():
            torch.testing.assert_close(mine[name], oracle, rtol=rtol, atol=atol, msg=lambda t, n=name: f"{n}: {t}")
        critic, actor, q = one._sums.tolist()
        sums = [*stack.critic_sums[place].tolist(), float(stack.actor_sums[place])]
        assert sums == pytest.approx([critic, q, actor], rel=1e-4, abs=1e-5)


@pytest.mark.parametrize("hidden", [(8,), (8, 9, 10)])
def test_any_number_of_layers(hidden: tuple[int, ...]) -> None:
    hyper = hyper_for(hidden=hidden)
    alone = [Alone(hyper, seed) for seed in SEEDS]
    stack = stack_of(alone, hyper)
    _learn(stack, alone, 4, torch.float32)
    for place, one in enumerate(alone):
        torch.testing.assert_close(stack.actor.values[place, 0], flat(one.actor), rtol=1e-5, atol=1e-6)


def test_a_waiting_agent_does_not_change_by_one_bit_and_the_others_learn_as_ever() -> None:
    hyper = hyper_for()
    alone = [Alone(hyper, seed) for seed in SEEDS]
    stack = stack_of(alone, hyper)
    _learn(stack, alone, 3, torch.float32)
    before = [tensor[1].clone() for tensor in stack.tensors]
    _learn(stack, alone, 4, torch.float32, waiting=(1,))
    # The stored bits, so that a zero that has become a minus zero counts as well.
    for tensor, kept in zip(stack.tensors, before, strict=True):
        assert torch.equal(tensor[1].view(torch.int32), kept.view(torch.int32))
    assert stack.updates.tolist() == [7, 3, 7]
    _learn(stack, alone, 2, torch.float32)
    for place, one in enumerate(alone):
        # Waiting has brought the middle one out of step: its actor has its turn in other updates now.
        torch.testing.assert_close(stack.actor.values[place, 0], flat(one.actor), rtol=1e-4, atol=2e-5)
        torch.testing.assert_close(stack.average_actor[place, 0], flat(one.average_actor), rtol=1e-4, atol=2e-5)


def test_a_waiting_agent_survives_even_garbage() -> None:
    stack = stack_of([Td3(FEATURES, hyper_for(), LIMIT, seed) for seed in SEEDS], hyper_for())
    before = [tensor[2].clone() for tensor in stack.tensors]
    batch, noise = together([batches(place, 1)[0] for place in range(3)])
    batch.features[2], batch.reward[2] = torch.nan, torch.inf
    for _ in range(2):
        stack.update(batch, noise, _alphas(1), waiting=(2,))
    assert all(torch.equal(tensor[2], kept) for tensor, kept in zip(stack.tensors, before, strict=True))
    assert all(torch.isfinite(tensor).all() for tensor in stack.tensors)


def test_another_agents_data_and_alpha_change_nothing() -> None:
    hyper = hyper_for()
    results = []
    for other in (False, True):
        stack = stack_of([Td3(FEATURES, hyper, LIMIT, seed) for seed in SEEDS], hyper)
        for index in range(6):
            each = [batches(10 + place, 6)[index] for place in range(3)]
            alpha = _alphas(index)
            if other:
                each[2], alpha[2] = batches(99, 6)[index], 0.9
            stack.update(*together(each), alpha)
        results.append(stack)
    for mine, changed in zip(results[0].tensors, results[1].tensors, strict=True):
        assert torch.equal(mine[:2], changed[:2])
    assert not torch.equal(results[0].actor.values[2], results[1].actor.values[2])


def test_alpha_is_each_agents_own() -> None:
    hyper = hyper_for()
    stack = stack_of([Td3(FEATURES, hyper, LIMIT, 4) for _ in range(3)], hyper)
    same = [batches(1, 1)[0]] * 3
    for _ in range(2):
        stack.update(*together(same), torch.tensor([0.0, 1.0, 1.0]))
    assert not torch.equal(stack.actor.values[0], stack.actor.values[1])
    assert torch.equal(stack.actor.values[1], stack.actor.values[2])


def test_a_narrower_task_in_a_wide_stack_has_the_narrow_network() -> None:
    hyper, columns = hyper_for(), np.array([0, 2, 3, 4, 6])
    narrow = Td3(len(columns), hyper, LIMIT, 8)
    wide, tight = StackedTd3(1, FEATURES, hyper, LIMIT), StackedTd3(1, len(columns), hyper, LIMIT)
    move_in(wide, 0, narrow, columns)
    move_in(tight, 0, narrow, np.arange(len(columns)))
    for batch, noise in batches(3, 10):
        shown = torch.zeros(FEATURES)
        shown[columns] = 1.0
        spread = batch._replace(features=batch.features * shown, next_features=batch.next_features * shown)
        compact = batch._replace(features=batch.features[:, columns], next_features=batch.next_features[:, columns])
        wide.update(*together([(spread, noise)]), torch.tensor([0.5]))
        tight.update(*together([(compact, noise)]), torch.tensor([0.5]))
    first, only = wide.actor.layers[0].weight[0], tight.actor.layers[0].weight[0]
    torch.testing.assert_close(first[columns], only, rtol=1e-5, atol=1e-6)
    hidden = np.setdiff1d(np.arange(FEATURES), columns)
    assert not first[hidden].any()
    assert not wide.critics.layers[0].weight[:, hidden].any()


def test_those_who_stay_take_everything_with_them() -> None:
    hyper = hyper_for()
    alone = [Alone(hyper, seed) for seed in SEEDS]
    stack = stack_of(alone, hyper)
    _learn(stack, alone, 3, torch.float32)
    smaller = stack.take([2, 0])
    each = [batches(30 + place, 5) for place in range(3)]
    for index in range(5):
        now, alpha = [found[index] for found in each], _alphas(index)
        stack.update(*together(now), alpha)
        smaller.update(*together([now[2], now[0]]), alpha[[2, 0]])
    for mine, theirs in zip(smaller.tensors, stack.tensors, strict=True):
        torch.testing.assert_close(mine, theirs[[2, 0]], rtol=1e-5, atol=1e-6)
    assert smaller.updates.tolist() == [8, 8]


def test_moving_in_leaves_nothing_of_who_was_there() -> None:
    hyper = hyper_for()
    alone = [Alone(hyper, seed) for seed in SEEDS]
    stack, fresh = stack_of(alone, hyper), Td3(FEATURES, hyper, LIMIT, 77)
    _learn(stack, alone, 3, torch.float32)
    move_in(stack, 1, fresh, np.arange(FEATURES))
    beginner = stack_of([fresh], hyper)
    for mine, theirs in zip(stack.tensors, beginner.tensors, strict=True):
        assert torch.equal(mine[1], theirs[0])
    assert stack.updates.tolist() == [3, 0, 3]


def test_a_group_of_zeros_is_as_wide_as_its_shape() -> None:
    stack = StackedTd3(2, FEATURES, hyper_for(), LIMIT)
    assert isinstance(stack.critics, Group)
    linear = (FEATURES + 1) * 24 + 24 + 24 * 16 + 16 + 16 * 2 + 2
    assert stack.critics.shape.size == linear + 2 * (24 + 16)
    assert stack.critics.values.shape == (2, 2, stack.critics.shape.size)
