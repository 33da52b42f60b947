"""What the paper reports (§4.2 to 4.4), to stand beside what is measured here."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

TABLE_4: Final[Mapping[str, tuple[float, float]]] = MappingProxyType(
    {
        "submas": (466.34, 0.948),
        "wo-pd": (340.65, 0.808),
        "wo-pr": (-59.98, 0.0),
        "dec-pd": (373.49, 0.854),
        "dec-pr": (390.16, 0.862),
        "td3": (64.61, 0.0),
        "ppo": (-310.70, 0.0),
        "sac": (77.17, 0.0),
    }
)
"""Table 4: episode return and success rate of the best of ten seeds over 1000 episodes, by variant."""

EXPERT_ON_TARGET: Final = 0.621
"""Success rate of the dragging expert on the target task (§4.4, Fig. 13)."""

HOURS_PER_TASK: Final = 30.0
"""Training time of one task on the paper's machine (§4.1) [h]."""

TABLE_1: Final[Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        f"source-{4 - missiles}" if missiles < 4 else "target": (
            *("x", "y", "psi", "l", "theta_AA", "theta_ATA", "phi_exit"),
            *(f"{kind}_{missile}" for missile in range(1, missiles + 1) for kind in ("r", "phi")),
        )
        for missiles in (4, 3, 2, 1, 0)
    }
)
"""Table 1: the state space of every task, in the paper's order; its symbols as our columns."""

TABLE_2: Final[Mapping[str, tuple[str, str, object]]] = MappingProxyType(
    {
        "hidden": ("Network architecture", "", (256, 256)),
        "replay_size": ("Replay buffer size", "|𝒟|", 10**6),
        "epochs": ("Number of epochs", "", 300),
        "steps_per_epoch": ("Steps per epoch", "", 10**4),
        "learning_rate": ("Learning rate", "", 3e-4),
        "batch_size": ("Batch size", "K", 128),
        "epsilon_start": ("ε-start", "ε₀", 0.8),
        "epsilon_clip": ("ε-clip", "δ_ε", 0.01),
        "alpha_clip": ("α-clip", "δ_α", 0.01),
    }
)
"""Table 2: the paper's name, symbol and value of each hyperparameter, by our name for it."""

TABLE_3: Final[Mapping[str, tuple[bool, bool, str, str]]] = MappingProxyType(
    {
        "submas": (True, True, "adaptive", "adaptive"),
        "wo-pd": (False, True, "", "adaptive"),
        "wo-pr": (True, False, "adaptive", ""),
        "dec-pd": (True, True, "decayed", "adaptive"),
        "dec-pr": (True, True, "adaptive", "decayed"),
    }
)
"""Table 3: policy distillation, policy reuse, schedule of α, schedule of ε; empty where it has none."""

WITHOUT_REUSE_ON_SOURCE_3: Final = 0.5
"""Average success rate that w/oPr achieves in source task 3 (§4.2)."""
