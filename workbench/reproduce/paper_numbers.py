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
