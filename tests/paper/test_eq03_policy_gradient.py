"""Eq. (3): the actor climbs ∇_a Q(s, a) at a = μ(s), chained through ∇_θ μ_θ(s)."""

from __future__ import annotations

import dataclasses

import torch

from agents.config import PROFILES
from agents.replay import Batch
from agents.td3 import Td3

HYPER = dataclasses.replace(PROFILES["smoke"], hidden=(4,), layer_norm=False, two_returns=False)


def _batch(rows: int = 5) -> Batch:
    generator = torch.Generator().manual_seed(1)
    zeros = torch.zeros(rows)
    features = torch.randn((rows, 3), generator=generator)
    return Batch(features, torch.zeros((rows, 1)), zeros, zeros, zeros, features)


def test_the_gradient_is_the_mean_of_the_products_of_both_derivatives() -> None:
    learner = Td3(3, HYPER, 1.0, seed=0)
    batch = _batch()
    learner._update_actor(batch, learner.weights(0.0))
    by_hand = [torch.zeros_like(p) for p in learner.actor.parameters()]
    for row in batch.features:
        action = learner_action = _actor_before(row)
        action = action.detach().requires_grad_()
        value = learner.critics.first(row[None], action)
        (slope,) = torch.autograd.grad(value.sum(), action)
        pieces = torch.autograd.grad(learner_action.sum(), list(_ACTOR.parameters()))
        by_hand = [total + slope.item() * piece / 5 for total, piece in zip(by_hand, pieces, strict=True)]
    for parameter, expected in zip(learner.actor.parameters(), by_hand, strict=True):
        # The optimiser descends, so the stored gradient is that of -J.
        torch.testing.assert_close(parameter.grad, -expected)


def test_only_the_first_critic_leads_the_actor() -> None:
    learner, other = Td3(3, HYPER, 1.0, seed=0), Td3(3, HYPER, 1.0, seed=0)
    with torch.no_grad():
        for parameter in other.critics.second.parameters():
            parameter.add_(1.0)
    for each in (learner, other):
        each._update_actor(_batch(), each.weights(0.0))
    for one, two in zip(learner.actor.parameters(), other.actor.parameters(), strict=True):
        assert torch.equal(one, two)


def test_with_two_returns_the_actor_climbs_their_sum_weighted_by_alpha() -> None:
    hyper = dataclasses.replace(HYPER, two_returns=True)
    learner = Td3(3, hyper, 1.0, seed=0)
    assert learner.weights(0.25).tolist() == [1.0, 0.25]
    first, second = torch.tensor([[2.0, 8.0]]), torch.tensor([[3.0, 2.0]])
    assert (first @ learner.weights(0.25)).item() == 4.0
    assert (second @ learner.weights(0.25)).item() == 3.5


_ACTOR = Td3(3, HYPER, 1.0, seed=0).actor


def _actor_before(row: torch.Tensor) -> torch.Tensor:
    return _ACTOR(row[None])
