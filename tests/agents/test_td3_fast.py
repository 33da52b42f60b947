"""The hand-written learner against the readable one: gradients, parameters after many updates, statistics."""

from __future__ import annotations

import dataclasses

import pytest
import torch

from agents.config import PROFILES, Hyperparameters
from agents.replay import Batch
from agents.td3 import Td3
from agents.td3_fast import FastTd3

ROWS, FEATURES = 48, 7
CASES = [(layer_norm, two_returns) for layer_norm in (False, True) for two_returns in (False, True)]


def _hyper(layer_norm: bool, two_returns: bool, hidden: tuple[int, ...] = (24, 16)) -> Hyperparameters:
    return dataclasses.replace(
        PROFILES["fast"], hidden=hidden, layer_norm=layer_norm, two_returns=two_returns, reward_scale=0.5
    )


def _batches(count: int) -> list[Batch]:
    g = torch.Generator().manual_seed(3)

    def draw(*shape: int) -> torch.Tensor:
        return torch.randn(shape, generator=g)

    def batch() -> Batch:
        ends = (torch.rand(ROWS, generator=g) < 0.1).float()
        action = draw(ROWS, 1).clamp(-1, 1)
        return Batch(
            draw(ROWS, FEATURES), action, draw(ROWS), -draw(ROWS).abs(), 0.99 * (1.0 - ends), draw(ROWS, FEATURES)
        )

    return [batch() for _ in range(count)]


def _pair(hyper: Hyperparameters) -> tuple[Td3, FastTd3]:
    return Td3(FEATURES, hyper, 1.5, seed=4), FastTd3(FEATURES, hyper, 1.5, seed=4)


@pytest.mark.parametrize(("layer_norm", "two_returns"), CASES)
def test_one_update_has_the_gradients_of_autograd(layer_norm: bool, two_returns: bool) -> None:
    plain, fast = _pair(_hyper(layer_norm, two_returns))
    (batch,) = _batches(1)
    for learner in (plain, fast):
        learner._update_critics(batch, 0.7, learner.weights(0.7))
        learner._update_actor(batch, learner.weights(0.7))
    for name in ("critics", "actor"):
        theirs = dict(getattr(plain, name).named_parameters())
        for key, ours in getattr(fast, name).named_parameters():
            torch.testing.assert_close(ours.grad, theirs[key].grad, rtol=1e-5, atol=1e-6, msg=key)


@pytest.mark.parametrize(("layer_norm", "two_returns"), CASES)
def test_all_networks_stay_equal_over_many_updates(layer_norm: bool, two_returns: bool) -> None:
    plain, fast = _pair(_hyper(layer_norm, two_returns))
    for index, batch in enumerate(_batches(20)):
        plain.update(batch, 1.0 - index / 20)
        fast.update(batch, 1.0 - index / 20)
    for name in ("actor", "critics", "target_actor", "target_critics", "average_actor"):
        theirs = dict(getattr(plain, name).named_parameters())
        for key, ours in getattr(fast, name).named_parameters():
            torch.testing.assert_close(ours, theirs[key].detach(), rtol=1e-4, atol=2e-5, msg=f"{name} {key}")
    one, other = plain.take_statistics(), fast.take_statistics()
    assert dataclasses.astuple(one) == pytest.approx(dataclasses.astuple(other), rel=1e-3, abs=1e-4)


@pytest.mark.parametrize("hidden", [(8,), (8, 9, 10)])
def test_any_number_of_layers(hidden: tuple[int, ...]) -> None:
    plain, fast = _pair(_hyper(True, True, hidden))
    for batch in _batches(4):
        plain.update(batch, 0.5)
        fast.update(batch, 0.5)
    for ours, theirs in zip(fast.actor.parameters(), plain.actor.parameters(), strict=True):
        torch.testing.assert_close(ours, theirs.detach(), rtol=1e-4, atol=1e-5)


def test_networks_share_memory_with_the_flat_tensors_and_with_nothing_else() -> None:
    _, fast = _pair(_hyper(True, True))
    fast._flat_actor.zero_()
    assert all(not parameter.any() for parameter in fast.actor.parameters())
    assert any(parameter.any() for parameter in fast.target_actor.parameters())
    assert any(parameter.any() for parameter in fast.average_actor.parameters())
