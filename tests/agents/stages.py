"""A stage of the point robot, small enough to run in a second."""

from __future__ import annotations

import dataclasses

from agents.config import PROFILES, VARIANTS, TrainingConfig
from agents.expert import NavigationExpert
from agents.stage import Stage
from tests.agents.point_robot import POINT_ROBOT, RobotTask

HYPER = dataclasses.replace(
    PROFILES["smoke"],
    hidden=(16, 16),
    batch_size=16,
    lanes=8,
    steps_per_epoch=200,
    update_after=80,
    updates_per_lane_step=3,
    epochs=2,
    evaluate_every=1,
    evaluation_episodes=10,
    alpha_clip=0.25,
    epsilon_clip=0.25,
    segment_steps=1,
)


def stage_for(variant: str = "submas", **changes: object) -> Stage:
    task = RobotTask(frozenset({2}))
    return Stage(
        task=task,
        source=task.mask([1]),
        guide=NavigationExpert(),
        domain=POINT_ROBOT,
        hyper=dataclasses.replace(HYPER, **changes),
        variant=VARIANTS[variant],
        config=TrainingConfig(missiles=1, variant=variant, seed=3),  # type: ignore[arg-type]
    )
