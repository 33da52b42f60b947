"""Definition 2: no transfer while the agent faces a subtask that the source task never had."""

from __future__ import annotations

import numpy as np

from agents.transfer_mask import TransferMask
from tests.agents.point_robot import NOT_SENSED, RobotTask

TARGET = RobotTask()
SOURCE = TARGET.mask([2])
OWN = [0.5, 0.25, 0.0, 0.125]
ONLY_FIRST = [*OWN, 1.5, 0.5, *NOT_SENSED]
BOTH = [*OWN, 1.5, 0.5, 2.0, -0.5]
OBSERVATION = np.array([ONLY_FIRST, BOTH], np.float32)


def test_a_known_subtask_does_not_prevent_transfer_and_a_fresh_one_does() -> None:
    mask = TransferMask(TARGET.layout, SOURCE.layout, NOT_SENSED)
    assert mask.allowed(OBSERVATION).tolist() == [True, False]


def test_the_guide_sees_the_shared_part() -> None:
    mask = TransferMask(TARGET.layout, SOURCE.layout, NOT_SENSED)
    np.testing.assert_array_equal(mask.shared(OBSERVATION)[0], np.array([*OWN, 1.5, 0.5], np.float32))


def test_every_masked_subtask_counts() -> None:
    empty = TransferMask(TARGET.layout, TARGET.mask([1, 2]).layout, NOT_SENSED)
    assert empty.allowed(OBSERVATION).tolist() == [False, False]
    alone = np.array([[*OWN, *NOT_SENSED, *NOT_SENSED]], np.float32)
    assert empty.allowed(alone).all()


def test_source_equal_to_target_always_allows() -> None:
    assert TransferMask(TARGET.layout, TARGET.layout, NOT_SENSED).allowed(OBSERVATION).all()
