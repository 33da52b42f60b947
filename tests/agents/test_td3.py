"""TD3 on probe problems whose values are known, and its counters, noise and determinism."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import pytest
import torch

from agents.config import PROFILES
from agents.replay import Batch
from agents.td3 import Td3

HYPER = dataclasses.replace(
    PROFILES["smoke"],
    hidden=(32, 32),
    layer_norm=False,
    two_returns=False,
    reward_scale=1.0,
    learning_rate=3e-3,
    polyak=0.05,
    gamma=0.9,
)
ROWS = 128


def _learn(make: Callable[[torch.Generator], Batch], updates: int = 600, **changes: object) -> Td3:
    learner = Td3(1, dataclasses.replace(HYPER, **changes), 1.0, seed=0)
    generator = torch.Generator().manual_seed(5)
    for _ in range(updates):
        learner.update(make(generator), alpha=1.0)
    return learner


def _batch(state: torch.Tensor, action: torch.Tensor, reward: torch.Tensor, ends: float, after: float = 0.0) -> Batch:
    zero = torch.zeros(ROWS)
    following = torch.full((ROWS, 1), after)
    return Batch(state, action, reward.reshape(ROWS), zero, zero + HYPER.gamma * (1.0 - ends), following)


def _action(generator: torch.Generator) -> torch.Tensor:
    return torch.rand((ROWS, 1), generator=generator) * 2 - 1


def _value(learner: Td3, state: float, action: float = 0.0) -> float:
    return learner.critics.first(torch.tensor([[state]]), torch.tensor([[action]]))[0, 0].item()


def test_a_constant_reward_at_the_end_is_the_value() -> None:
    learner = _learn(lambda g: _batch(torch.zeros((ROWS, 1)), _action(g), torch.ones(ROWS), 1.0), 300)
    assert _value(learner, 0.0) == pytest.approx(1.0, abs=0.05)


def test_a_reward_that_depends_on_the_state() -> None:
    def make(generator: torch.Generator) -> Batch:
        state = torch.randint(0, 2, (ROWS, 1), generator=generator) * 2.0 - 1.0
        return _batch(state, _action(generator), state, 1.0)

    learner = _learn(make, 300)
    assert _value(learner, 1.0) == pytest.approx(1.0, abs=0.1)
    assert _value(learner, -1.0) == pytest.approx(-1.0, abs=0.1)


def test_a_reward_one_step_later_is_discounted_once() -> None:
    def make(generator: torch.Generator) -> Batch:
        first = torch.rand((ROWS, 1), generator=generator) < 0.5
        state = torch.where(first, -1.0, 1.0)
        zero = torch.zeros(ROWS)
        return Batch(
            state, _action(generator), (~first).float()[:, 0], zero, 0.9 * first.float()[:, 0], torch.ones((ROWS, 1))
        )

    learner = _learn(make)
    assert _value(learner, 1.0) == pytest.approx(1.0, abs=0.05)
    assert _value(learner, -1.0) == pytest.approx(0.9, abs=0.05)


def test_the_policy_finds_the_best_action() -> None:
    def make(generator: torch.Generator) -> Batch:
        action = _action(generator)
        return _batch(torch.zeros((ROWS, 1)), action, -((action - 0.5) ** 2), 1.0)

    learner = _learn(make)
    assert learner.actor(torch.zeros((1, 1))).item() == pytest.approx(0.5, abs=0.1)
    assert _value(learner, 0.0, 0.5) == pytest.approx(0.0, abs=0.05)
    assert _value(learner, 0.0, -0.5) == pytest.approx(-1.0, abs=0.1)


@pytest.mark.parametrize("two_returns", [False, True])
@pytest.mark.parametrize("layer_norm", [False, True])
def test_the_policy_finds_the_best_action_of_every_state(two_returns: bool, layer_norm: bool) -> None:
    def make(generator: torch.Generator) -> Batch:
        state, action = _action(generator), _action(generator)
        return _batch(state, action, -((action - state / 2) ** 2), 1.0)

    learner = _learn(make, 800, two_returns=two_returns, layer_norm=layer_norm)
    for state in (-0.8, 0.0, 0.8):
        assert learner.actor(torch.tensor([[state]])).item() == pytest.approx(state / 2, abs=0.12)


def test_with_two_returns_alpha_decides_between_reward_and_imitation_without_relearning() -> None:
    def make(generator: torch.Generator) -> Batch:
        action, zero = _action(generator), torch.zeros(ROWS)
        state = torch.zeros((ROWS, 1))
        return Batch(state, action, action[:, 0] * 0.5, -(action + 0.5).abs()[:, 0], zero, state)

    learner = _learn(make, two_returns=True)
    values = learner.critics.first(torch.zeros((1, 1)), torch.tensor([[0.5]]))[0]
    assert values.tolist() == pytest.approx([0.25, -1.0], abs=0.1)
    assert learner.actor(torch.zeros((1, 1))).item() == pytest.approx(-0.5, abs=0.15)
    generator = torch.Generator().manual_seed(6)
    for _ in range(600):
        learner.update(make(generator), alpha=0.0)
    assert learner.actor(torch.zeros((1, 1))).item() > 0.5


def test_targets_and_actor_move_on_every_second_update_only() -> None:
    learner = Td3(1, HYPER, 1.0, seed=0)
    batch = _batch(torch.ones((ROWS, 1)), torch.zeros((ROWS, 1)), torch.ones(ROWS), 0.0)

    def moved(before: list[torch.Tensor], module: torch.nn.Module) -> bool:
        return any(not torch.equal(a, b) for a, b in zip(before, module.parameters(), strict=True))

    for update, expected in ((1, False), (2, True), (3, False), (4, True)):
        copies = {
            name: [p.detach().clone() for p in getattr(learner, name).parameters()]
            for name in ("actor", "target_actor", "target_critics", "average_actor", "critics")
        }
        learner.update(batch, 0.0)
        assert learner.updates == update
        assert moved(copies["critics"], learner.critics)
        for name in ("actor", "target_actor", "target_critics", "average_actor"):
            assert moved(copies[name], getattr(learner, name)) is expected


def test_target_noise_differs_in_every_row_and_stays_within_its_bound() -> None:
    learner = Td3(1, dataclasses.replace(HYPER, target_noise=0.2, target_noise_clip=0.5, gamma=1.0), 1.0, seed=0)
    learner.target_actor = lambda features: torch.zeros((len(features), 1))  # type: ignore[assignment]
    seen: list[torch.Tensor] = []

    def spy(features: torch.Tensor, action: torch.Tensor) -> tuple[torch.Tensor, torch.Tensor]:
        seen.append(action)
        return action, action

    learner.target_critics = spy  # type: ignore[assignment]
    rows = torch.zeros((4096, 1))
    batch = Batch(rows, rows, rows[:, 0], rows[:, 0], rows[:, 0], rows)
    learner.targets(batch, 0.0, learner.weights(0.0))
    noise = seen[0].flatten()
    assert len(noise.unique()) > 3000
    assert noise.abs().max().item() == pytest.approx(0.5)
    assert noise.std().item() == pytest.approx(0.2, abs=0.02)


def test_one_seed_one_result() -> None:
    def digest(seed: int) -> list[float]:
        learner = Td3(1, HYPER, 1.0, seed=seed)
        for _ in range(20):
            learner.update(_batch(torch.ones((ROWS, 1)), torch.zeros((ROWS, 1)), torch.ones(ROWS), 0.0), 0.0)
        return torch.cat([p.flatten() for p in learner.actor.parameters()]).tolist()

    assert digest(1) == digest(1) != digest(2)


def test_statistics_are_means_since_the_last_call() -> None:
    learner = Td3(1, dataclasses.replace(HYPER, reward_scale=0.5), 1.0, seed=0)
    batch = _batch(torch.ones((ROWS, 1)), torch.zeros((ROWS, 1)), torch.ones(ROWS), 1.0)
    for _ in range(400):
        learner.update(batch, 0.0)
    learner.take_statistics()
    for _ in range(10):
        learner.update(batch, 0.0)
    statistics = learner.take_statistics()
    # Reported in rewards of the task, not in the learner's scaled ones.
    assert statistics.q_mean == pytest.approx(1.0, abs=0.05)
    assert statistics.critic_loss < 0.01
