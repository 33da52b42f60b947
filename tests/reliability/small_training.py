"""A training process with the real learner on the point robot: a training of seconds, by the real entry point."""

from __future__ import annotations

import dataclasses
import math
import sys
from pathlib import Path

from agents.snapshot import Snapshot
from workbench import launcher, pulse, training
from workbench.recorder import RunRecorder
from workbench.runs import Run, RunStore

EPOCHS = 6


def learn(run: Run, store: RunStore, recorder: RunRecorder, snapshot: Snapshot | None) -> None:
    import torch

    from agents.expert import NavigationExpert
    from agents.submas import train
    from tests.agents.point_robot import POINT_ROBOT
    from tests.agents.stages import HYPER

    torch.set_num_threads(1)
    hyper = dataclasses.replace(
        HYPER, epochs=EPOCHS, steps_per_epoch=80, evaluate_every=3, evaluation_episodes=4, final_episodes=4,
        replay_size=1_000, return_steps=5, actor_average=0.99, promotion_success=2.0,
    )  # fmt: skip
    train(run.config, recorder, NavigationExpert(), domain=POINT_ROBOT, hyperparameters=hyper, snapshot=snapshot)


def one_route() -> str:
    """A busy machine must not choose another route for the run that nothing interrupts."""
    return "default"


if __name__ == "__main__":
    from agents import numerics

    numerics.choose_matmul_route = one_route
    pulse.SAVING_SHARE = math.inf
    launcher.ENTRY = (str(Path(__file__).resolve()),)
    training._learn = learn
    sys.exit(training.main())
