"""The reward as terms, computed by hand."""

from __future__ import annotations

import numpy as np
import pytest

from sim.reward import GOAL, masked_reward, source_reward, total_reward

#                 goal  m1     m2    m3   m4   time
EXIT = np.array([400.0, 0.0, 0.0, 0.0, 50.0, -0.1])
"""The step in which the exit is reached and missile 4 gives up."""
KILLED = np.array([0.0, 50.0, -400.0, 0.0, 0.0, -0.1])
"""The step in which missile 2 hits and missile 1 gives up."""


def test_a_step_with_exit_and_evaded_missile_earns_449_9() -> None:
    assert total_reward(EXIT) == pytest.approx(449.9)


def test_the_source_task_without_missile_4_earns_399_9_for_it() -> None:
    assert source_reward(EXIT, [4]) == pytest.approx(399.9)


def test_being_shot_down_by_a_missile_is_that_missiles_term() -> None:
    # In the source task without missile 2 nobody is shot down: what is left is missile 1's bonus and the time.
    assert masked_reward(KILLED, {2}) == -400.0
    assert source_reward(KILLED, {2}) == pytest.approx(49.9)


def test_masking_nothing_removes_nothing() -> None:
    assert masked_reward(KILLED, ()) == 0.0


def test_terms_may_have_any_leading_axes() -> None:
    terms = np.stack([[EXIT, KILLED], [KILLED, EXIT], [EXIT, EXIT]])
    assert source_reward(terms, {1, 4}).shape == (3, 2)


def test_the_goal_is_the_first_column() -> None:
    assert EXIT[GOAL] == 400.0
