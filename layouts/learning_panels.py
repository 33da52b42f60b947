"""Which figures of learning are drawn together, in which ink, and what each of them means."""

from __future__ import annotations

from dataclasses import dataclass

from layouts.theme import NEUTRAL, POLICY_A, POLICY_B, SUCCESS, missile_colour


@dataclass(frozen=True)
class LearningCurve:
    """One figure of a metrics row."""

    name: str
    """Its name in the row."""
    label: str
    ink: str
    help: str
    digits: int = 2
    """Decimals of its value."""
    share: bool = False
    """A share 0..1 that is written as a percentage."""
    held_out: bool = False
    """Measured only at held-out evaluations."""


@dataclass(frozen=True)
class LearningPanel:
    """Curves that share a vertical axis."""

    key: str
    """How it is called in an address and in the names of its downloads."""
    title: str
    help: str
    curves: tuple[LearningCurve, ...]
    rate: bool = False
    """The axis goes from 0 to 1."""


PANELS = (
    LearningPanel(
        "success", "Success", "Share of episodes that reach the exit.",
        (
            LearningCurve(
                "success_rate", "held-out", SUCCESS, "of the policy alone, without noise or guide, on initial states "
                "it was not trained on; this is what promotes a stage", 1, share=True, held_out=True,
            ),
            LearningCurve(
                "train_success_rate", "in training", NEUTRAL,
                "of the latest 100 training episodes, with noise and guide", 1, share=True,
            ),
        ),
        rate=True,
    ),
    LearningPanel(
        "return", "Return", "Sum of the rewards of an episode: 600 less 0.1 a second is the most with four missiles.",
        (
            LearningCurve("return_mean", "held-out", POLICY_A, "mean of the held-out episodes", 0, held_out=True),
            LearningCurve("train_return_mean", "in training", NEUTRAL, "mean of the latest 100 training episodes", 0),
        ),
    ),
    LearningPanel(
        "weights", "Guide weights", "How much the guide's knowledge counts; it falls as the policy succeeds.",
        (
            LearningCurve("alpha", "α", POLICY_A, "weight of policy distillation (Eq. 16, 20)"),
            LearningCurve("epsilon", "ε", POLICY_B, "probability of policy reuse (Eq. 19, 21)"),
            LearningCurve("beta", "β", SUCCESS, "success rate that moves α and ε"),
        ),
        rate=True,
    ),
    LearningPanel(
        "transfer", "Transfer", "How often the transfer mask lets knowledge through, and how often the guide flies.",
        (
            LearningCurve(
                "transfer_share", "allowed", missile_colour(1), "share of steps in which the transfer mask allowed "
                "transfer (Eq. 13)", 1, share=True,
            ),
            LearningCurve(
                "guide_share", "guide flies", missile_colour(4), "share of steps flown by the guide (Eq. 18); in old "
                "runs as expected, ε times the share in which transfer was allowed", 1, share=True,
            ),
        ),
        rate=True,
    ),
    LearningPanel(
        "q", "Mean Q", "What the critic expects of the actor's actions; a value that runs away means divergence.",
        (LearningCurve("q_mean", "Q", POLICY_A, "mean over the minibatches of an epoch", 1),),
    ),
    LearningPanel(
        "critic", "Critic loss", "Mean squared Bellman error, of scaled rewards where the profile scales them.",
        (LearningCurve("critic_loss", "critic", POLICY_B, "mean over the epoch", 4),),
    ),
    LearningPanel(
        "actor", "Actor loss", "Minus the value of the actor's own actions: it falls as the policy improves.",
        (LearningCurve("actor_loss", "actor", missile_colour(3), "mean over the epoch", 3),),
    ),
    LearningPanel(
        "speed", "Updates a second", "Gradient steps a second over a whole epoch, episodes flown included.",
        (LearningCurve("updates_per_s", "updates/s", missile_colour(4), "of one process", 0),),
    ),
)  # fmt: skip
"""In the order of the page."""
