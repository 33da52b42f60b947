"""The real process of a stack, on the point robot: trainings of seconds."""

from __future__ import annotations

import dataclasses
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from agents.expert import NavigationExpert
from agents.stacked import training
from agents.stacked.agent import Member
from tests.agents.point_robot import POINT_ROBOT
from tests.agents.stages import HYPER
from workbench import launcher, stacked_training

HERE = Path(__file__).resolve()
SMALL = dataclasses.replace(
    HYPER, steps_per_epoch=80, evaluate_every=3, evaluation_episodes=4, final_episodes=4, replay_size=1_000,
    promotion_success=2.0,
)  # fmt: skip
train_stacked = training.train_stacked


def train(members: Sequence[Member], device: str, **options: Any) -> None:
    """As told by the runs' names: `epochs=5`."""
    epochs = int(members[0].config.name.removeprefix("epochs="))
    guided = [dataclasses.replace(member, guide=NavigationExpert()) for member in members]
    train_stacked(guided, device, domain=POINT_ROBOT, hyperparameters=dataclasses.replace(SMALL, epochs=epochs))


if __name__ == "__main__":
    # What is resumed is resumed by itself, on the same domain.
    launcher.ENTRY = (str(HERE.parents[1] / "reliability" / "small_training.py"),)
    training.train_stacked = train  # type: ignore[assignment]
    sys.exit(stacked_training.main())
