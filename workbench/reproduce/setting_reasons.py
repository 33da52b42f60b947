"""Why the profile `fast` differs from the paper, setting by setting; PAPER.md has the same table."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Final

FAST_BECAUSE: Final[Mapping[str, str]] = MappingProxyType(
    {
        "epochs": "a stage usually passes long before",
        "steps_per_epoch": "640 updates, as many as 160 steps of all lanes take",
        "batch_size": "fewer and larger updates",
        "gamma": "the exit is 600 to 1000 steps away; a smaller one pays for haste with risk",
        "return_steps": "rewards of forty steps before the critics are asked: the value of the exit has a "
        "thousand to travel",
        "polyak": "for the same reason: targets follow in 50 updates instead of 200",
        "action_noise": "5 % of the largest turning angle",
        "lanes": "episodes side by side",
        "updates_per_lane_step": "one update per 64 transitions instead of one per transition; the simulator gives "
        "them for next to nothing",
        "segment_steps": "one draw of ε (Eq. 18) holds for a minute on average: drawn anew at each step the guide "
        "corrects every error at once",
        "reward_scale": "values near 1 for the critics; reported returns are unscaled",
        "layer_norm": "steadier critics",
        "two_returns": "Q = Q_env + α Q_dist, learned apart, so that a change of α needs no relearning",
        "actor_average": "the evaluated policy is a moving average of the actor",
        "evaluate_every": "epochs between held-out evaluations",
        "evaluation_episodes": "episodes of one",
        "promotion_success": "a stage ends when a policy reaches it; 2 never happens",
        "promotion_evaluations": "in that many evaluations, each on fresh episodes",
    }
)
"""Setting -> reason, for every setting in which `fast` and `paper` differ."""
