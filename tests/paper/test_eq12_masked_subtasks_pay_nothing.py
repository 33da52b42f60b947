"""Eq. (12): while the masked blocks show the default vector, the masked subtasks' rewards are zero."""

from __future__ import annotations

import numpy as np

from agents.transfer_mask import at_default
from tests.agents.point_robot import NOT_SENSED, RobotTask, RobotWorld


def test_undetected_subtasks_pay_nothing_in_any_of_many_steps() -> None:
    target = RobotTask()
    source = target.mask([2])
    world = RobotWorld(target, lanes=64, seed=3)
    generator = np.random.default_rng(0)
    observation, paid, undetected = world.reset(), 0, 0
    columns = target.layout.masked_columns(source.layout)
    for _ in range(120):
        hidden = at_default(observation[:, columns], NOT_SENSED)
        step = world.step(generator.normal(0.0, 0.2, 64))
        masked_reward = step.reward_terms[:, 2]
        assert not masked_reward[hidden].any()
        paid, undetected = paid + int((masked_reward != 0).sum()), undetected + int(hidden.sum())
        observation = world.reset(lanes=np.flatnonzero(step.terminated | step.truncated))
    assert paid > 10 and undetected > 1000  # the law was put to the test on both sides
