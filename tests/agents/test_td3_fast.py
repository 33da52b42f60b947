"""The hand-written learner against the readable one: gradients, parameters after many updates, statistics."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np
import pytest
import torch

from agents.config import PROFILES, Hyperparameters
from agents.replay import Batch
from agents.td3 import Td3
from agents.td3_fast import FastTd3

ROWS, FEATURES = 48, 7
MOMENTS = ("exp_avg", "exp_avg_sq")
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


def _after_twenty_updates(layer_norm: bool, two_returns: bool) -> tuple[Td3, FastTd3]:
    plain, fast = _pair(_hyper(layer_norm, two_returns))
    for index, batch in enumerate(_batches(20)):
        plain.update(batch, 1.0 - index / 20)
        fast.update(batch, 1.0 - index / 20)
    return plain, fast


def _parameters(plain: Td3, fast: FastTd3) -> Iterator[tuple[str, torch.Tensor, torch.Tensor]]:
    """Every parameter of every network: name, the fast learner's, the readable one's."""
    for name in ("actor", "critics", "target_actor", "target_critics", "average_actor"):
        theirs = dict(getattr(plain, name).named_parameters())
        for key, ours in getattr(fast, name).named_parameters():
            yield f"{name} {key}", ours, theirs[key].detach()


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
    plain, fast = _after_twenty_updates(layer_norm, two_returns)
    for name, ours, theirs in _parameters(plain, fast):
        torch.testing.assert_close(ours, theirs, rtol=1e-4, atol=2e-5, msg=name)
    one, other = plain.take_statistics(), fast.take_statistics()
    assert dataclasses.astuple(one) == pytest.approx(dataclasses.astuple(other), rel=1e-3, abs=1e-4)


@pytest.fixture
def double() -> Iterator[None]:
    """Everything in double precision, where rounding is too small to hide another formula."""
    torch.set_default_dtype(torch.float64)
    yield
    torch.set_default_dtype(torch.float32)


@pytest.mark.usefixtures("double")
@pytest.mark.parametrize(("layer_norm", "two_returns"), CASES)
def test_after_twenty_updates_only_rounding_is_between_them(layer_norm: bool, two_returns: bool) -> None:
    plain, fast = _after_twenty_updates(layer_norm, two_returns)
    for name, ours, theirs in _parameters(plain, fast):
        assert ours.dtype == torch.float64
        torch.testing.assert_close(ours, theirs, rtol=0.0, atol=1e-9, msg=name)


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
    fast.flat_actor.values.zero_()
    assert all(not parameter.any() for parameter in fast.actor.parameters())
    assert any(parameter.any() for parameter in fast.target_actor.parameters())
    assert any(parameter.any() for parameter in fast.average_actor.parameters())


@pytest.mark.usefixtures("double")
def test_moments_are_kept_in_the_order_of_the_modules_whatever_the_order_in_memory() -> None:
    plain, fast = _pair(_hyper(True, True))
    for batch in _batches(3):
        plain.update(batch, 0.5)
        fast.update(batch, 0.5)
    one_by_one, flat = plain.arrays(), fast.arrays()
    for name, module in (("actor_optimizer", plain.actor), ("critic_optimizer", plain.critics)):
        for moment in MOMENTS:
            parts = [one_by_one[f"{name}/{index}/{moment}"].ravel() for index, _ in enumerate(module.parameters())]
            np.testing.assert_allclose(flat[f"{name}/0/{moment}"], np.concatenate(parts), rtol=0.0, atol=1e-12)


def test_a_learner_that_was_put_back_goes_on_bit_for_bit() -> None:
    _, fast = _pair(_hyper(True, True))
    batches = _batches(6)
    for batch in batches[:3]:
        fast.update(batch, 0.5)
    other = FastTd3(FEATURES, fast.hyper, 1.5, seed=9)
    other.restore(fast.arrays())
    for batch in batches[3:]:
        fast.update(batch, 0.5)
        other.update(batch, 0.5)
    for (name, ours), theirs in zip(fast.arrays().items(), other.arrays().values(), strict=True):
        np.testing.assert_array_equal(ours, theirs, err_msg=name)
