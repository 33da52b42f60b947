"""Weights of policy distillation (α) and policy reuse (ε): adaptive and clipped, or decayed (Table 3)."""

from __future__ import annotations

from agents.config import Schedule


def adaptive_alpha(beta: float) -> float:
    """Weight of distillation for a success rate β, α = 1 - β: Eq. (16), §3.3.2."""
    return 1.0 - beta


def adaptive_epsilon(beta: float, epsilon_start: float) -> float:
    """Probability of reuse for a success rate β, ε = ε₀ (1 - β): Eq. (19), §3.3.3."""
    return epsilon_start * (1.0 - beta)


def decayed(start: float, epoch: int, epochs: int) -> float:
    """Linear decay from `start` at epoch 0 to 0 at the last epoch: DecPd and DecPr of Table 3, §4.2."""
    return start * max(0.0, 1.0 - epoch / epochs)


def clip_change(value: float, previous: float, bound: float) -> float:
    """`value`, moved away from `previous` by at most `bound`: Eq. (20) with δ_α, Eq. (21) with δ_ε."""
    return min(max(value, previous - bound), previous + bound)


def next_alpha(alpha: float, beta: float, clip: float, schedule: Schedule, epoch: int, epochs: int) -> float:
    """α after an epoch: Algorithm 4, line 24 (Eq. 16, 20), or the linear decay of DecPd.

    Args:
        alpha: weight during the epoch that ended.
        beta: success rate of that epoch.
        clip: largest change, δ_α.
        schedule: `adaptive` or `decayed`.
        epoch: number of epochs done.
        epochs: number of epochs of the stage.
    """
    if schedule == "decayed":
        return decayed(1.0, epoch, epochs)
    return clip_change(adaptive_alpha(beta), alpha, clip)


def next_epsilon(
    epsilon: float, beta: float, epsilon_start: float, clip: float, schedule: Schedule, epoch: int, epochs: int
) -> float:
    """ε after an epoch: Algorithm 4, line 25 (Eq. 19, 21), or the linear decay of DecPr; see `next_alpha`."""
    if schedule == "decayed":
        return decayed(epsilon_start, epoch, epochs)
    return clip_change(adaptive_epsilon(beta, epsilon_start), epsilon, clip)
