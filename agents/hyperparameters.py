"""Numbers of Algorithm 4 and TD3: the paper's profile (Table 2), the fast one and the one for tests."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any, Final, Literal

from sim.errors import UsageError


class ConfigError(UsageError):
    """A training configuration holds an unknown key or an impossible value."""


def _within(low: float, high: float) -> Any:
    """Field whose value must lie in [low, high]; pages and checks read the same bounds."""
    return field(metadata={"low": low, "high": high})


def check_ranges(record: Any) -> None:
    """Raise `ConfigError` if a field of a dataclass lies outside the range in its metadata."""
    for item in dataclasses.fields(record):
        value = getattr(record, item.name)
        if "low" in item.metadata and not item.metadata["low"] <= value <= item.metadata["high"]:
            low, high = item.metadata["low"], item.metadata["high"]
            raise ConfigError(f"{item.name} is {value}; legal is {low:g} to {high:g}")


@dataclass(frozen=True, kw_only=True)
class Hyperparameters:
    """Numbers of Algorithm 4 and of TD3. Steps are transitions, whatever the number of lanes."""

    hidden: tuple[int, ...]
    """Widths of the hidden layers of actor and critics."""
    replay_size: int = _within(1_000, 10_000_000)
    """Transitions the replay holds, |𝒟|."""
    epochs: int = _within(1, 10_000)
    """Largest number of epochs of one stage."""
    steps_per_epoch: int = _within(1, 1_000_000)
    """Environment steps per epoch, all lanes together."""
    learning_rate: float = _within(1e-6, 0.1)
    """Adam step of actor and critics."""
    batch_size: int = _within(1, 65_536)
    """Transitions per gradient step, K."""
    epsilon_start: float = _within(0.0, 1.0)
    """Initial share of policy reuse, ε₀ (Eq. 19)."""
    epsilon_clip: float = _within(0.0, 1.0)
    """Largest change of ε per epoch, δ_ε (Eq. 21)."""
    alpha_clip: float = _within(0.0, 1.0)
    """Largest change of α per epoch, δ_α (Eq. 20)."""
    gamma: float = _within(0.0, 1.0)
    """Discount per decision step."""
    return_steps: int = _within(1, 1_000)
    """Steps of reward summed before the value of what follows counts; more than 1 carries the exit's reward faster."""
    polyak: float = _within(0.0, 1.0)
    """Step of the target networks towards the trained ones, τ of Algorithm 4."""
    action_noise: float = _within(0.0, math.pi)
    """Standard deviation of the exploration noise [action units, rad]."""
    noise_steps: int = _within(1, 10_000)
    """Mean number of steps for which one draw of the exploration noise holds; 1 draws at every step."""
    target_noise: float = _within(0.0, math.pi)
    """Standard deviation of the target policy smoothing [action units, rad]."""
    target_noise_clip: float = _within(0.0, math.pi)
    """Bound of the target policy smoothing [action units, rad]."""
    policy_delay: int = _within(1, 100)
    """Critic updates per actor and target update."""
    lanes: int = _within(1, 65_536)
    """Episodes collected side by side."""
    updates_per_lane_step: int = _within(0, 10_000)
    """Critic updates after each step of all lanes; equal to `lanes` it is one update per transition."""
    update_after: int = _within(0, 10_000_000)
    """Transitions in the replay before the first update."""
    segment_steps: int = _within(1, 10_000)
    """Mean number of steps for which one draw of ε holds; 1 draws at every step (Eq. 18)."""
    reward_scale: float = _within(1e-6, 1e3)
    """Factor on both rewards inside the learner; reported returns never carry it."""
    layer_norm: bool
    """Normalise the hidden layers of the critics."""
    two_returns: bool
    """Critics estimate environment return and distillation return apart: Q = Q_env + α Q_dist."""
    actor_average: float = _within(0.0, 1.0)
    """Decay per actor update of the moving average that is evaluated and kept; 0 uses the actor itself."""
    evaluate_every: int = _within(1, 10_000)
    """Epochs between two held-out evaluations."""
    evaluation_episodes: int = _within(1, 100_000)
    """Episodes of one held-out evaluation."""
    beta_source: Literal["evaluation", "training"]
    """Where the success rate β is counted: held-out evaluation or the last training episodes."""
    promotion_success: float = _within(0.0, 2.0)
    """Held-out success rate that ends a stage early; more than 1 never does."""
    promotion_evaluations: int = _within(1, 1_000)
    """Held-out evaluations of one policy, each on fresh episodes, that must all reach it."""
    final_episodes: int = _within(1, 100_000)
    """Episodes that judge the stage's policy when all is over: its card's figures, in which nothing was chosen."""

    def __post_init__(self) -> None:
        """Reject numbers outside their range."""
        check_ranges(self)
        if not self.hidden or not all(1 <= width <= 4096 for width in self.hidden):
            raise ConfigError(f"hidden is {self.hidden}; give at least one width from 1 to 4096")


PAPER: Final = Hyperparameters(
    # Table 2.
    hidden=(256, 256),
    replay_size=1_000_000,
    epochs=300,
    steps_per_epoch=10_000,
    learning_rate=3e-4,
    batch_size=128,
    epsilon_start=0.8,
    epsilon_clip=0.01,
    alpha_clip=0.01,
    # "Other hyperparameters follow the default setting in OpenAI SpinningUp" (§4.1): its noise is in action
    # units, unscaled.
    gamma=0.99,
    return_steps=1,
    polyak=0.005,
    action_noise=0.1,
    noise_steps=1,
    target_noise=0.2,
    target_noise_clip=0.5,
    policy_delay=2,
    update_after=1_000,
    # SpinningUp takes 50 steps, then 50 updates; 50 lanes with one step each keep that order and that ratio.
    lanes=50,
    updates_per_lane_step=50,
    segment_steps=1,
    reward_scale=1.0,
    layer_norm=False,
    two_returns=False,
    actor_average=0.0,
    evaluate_every=1,
    # SpinningUp tests on 10 episodes; β would move in steps of 0.1, and 100 as lanes take about as long.
    evaluation_episodes=100,
    beta_source="evaluation",
    promotion_success=2.0,
    promotion_evaluations=2,
    final_episodes=1000,
)
"""Table 2 to the letter; what the paper leaves open follows SpinningUp's TD3."""

FAST: Final = dataclasses.replace(
    PAPER,
    epochs=100,
    steps_per_epoch=40_960,
    batch_size=256,
    # The exit is 600 to 1000 steps away; 0.99 to that power is nothing, and 0.998 pays for haste with risk.
    gamma=0.9995,
    action_noise=0.05 * math.pi / 2,
    lanes=256,
    updates_per_lane_step=4,
    segment_steps=60,
    # The exit's value has to travel back 1000 steps: 40 at a time, and into targets that follow in 50 updates, not 200.
    return_steps=40,
    polyak=0.02,
    reward_scale=0.01,
    layer_norm=True,
    two_returns=True,
    actor_average=0.999,
    evaluate_every=2,
    evaluation_episodes=200,
    promotion_success=0.99,
    promotion_evaluations=3,
)
"""What a person launches: minutes per stage on one core."""

SMOKE: Final = dataclasses.replace(
    FAST,
    hidden=(64, 64),
    replay_size=20_000,
    epochs=2,
    steps_per_epoch=2_048,
    batch_size=64,
    epsilon_clip=0.5,
    alpha_clip=0.5,
    actor_average=0.9,
    lanes=32,
    evaluate_every=2,
    evaluation_episodes=20,
    final_episodes=20,
)
"""Seconds per stage, for tests; it is not expected to learn."""

PROFILES: Final[Mapping[str, Hyperparameters]] = MappingProxyType({"paper": PAPER, "fast": FAST, "smoke": SMOKE})
"""Hyperparameters by profile name."""
