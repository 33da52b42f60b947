"""Observation columns: names, sizes, blocks, and how layouts of nested tasks relate."""

from __future__ import annotations

import math

import numpy as np
import pytest

from sim.observation import OWN_NAMES, UNLAUNCHED, ObservationLayout, is_default, keep_masked, keep_shared
from tests.engagements import MASKS, MISSILES

LAYOUTS = [ObservationLayout(tuple(m for m in MISSILES if m not in masked)) for masked in MASKS]


@pytest.mark.parametrize("layout", LAYOUTS, ids=str)
def test_size_is_seven_and_two_per_missile(layout: ObservationLayout) -> None:
    assert layout.size == len(layout.names) == 7 + 2 * len(layout.missiles)


def test_names_of_a_task_with_missiles_1_and_3() -> None:
    own = ("x", "y", "psi", "l", "theta_AA", "theta_ATA", "phi_exit")
    assert ObservationLayout((1, 3)).names == (*own, "r_1", "phi_1", "r_3", "phi_3")


@pytest.mark.parametrize("layout", LAYOUTS, ids=str)
def test_a_block_holds_range_and_azimuth_of_its_missile(layout: ObservationLayout) -> None:
    for missile in layout.missiles:
        assert layout.names[layout.block(missile)] == (f"r_{missile}", f"phi_{missile}")


def test_a_masked_missile_has_no_block() -> None:
    with pytest.raises(ValueError, match="not in tuple"):
        ObservationLayout((1, 3)).block(2)


def test_digests_tell_the_sixteen_layouts_apart_and_stay_the_same() -> None:
    digests = {layout.digest for layout in LAYOUTS}
    assert len(digests) == 16
    # Policy files carry it: changing it makes every existing file unreadable.
    assert ObservationLayout(MISSILES).digest == "33a769468bd7"


def test_default_block_lies_outside_what_a_flying_missile_can_show() -> None:
    distance, azimuth = UNLAUNCHED
    assert distance < 0.0
    assert azimuth == -math.pi


def test_two_missing_missiles_are_default_only_together() -> None:
    block = np.array(UNLAUNCHED, dtype=np.float32)
    seen = np.array([2e4, 0.3], dtype=np.float32)
    rows = np.stack([np.r_[block, block], np.r_[block, seen], np.r_[seen, block], np.r_[seen, seen]])
    np.testing.assert_array_equal(is_default(rows), [True, False, False, False])


def test_nothing_masked_is_always_default() -> None:
    assert is_default(np.zeros((3, 0), dtype=np.float32)).all()


@pytest.mark.parametrize("change", [(1e-3, 0.0), (0.0, 1e-3)])
def test_a_block_near_the_default_is_not_default(change: tuple[float, float]) -> None:
    almost = (np.array([UNLAUNCHED]) + change).astype(np.float32)
    assert not is_default(almost).any()


def test_maps_of_float64_observations_agree_with_float32() -> None:
    # Trajectories hold float64 copies of the kernel's float32 values; the default vector must be found in them too.
    row = np.array([[*range(7), *UNLAUNCHED, 5.0, 0.1]], dtype=np.float32)
    target, source = ObservationLayout((1, 2)), ObservationLayout((2,))
    for kind in (np.float32, np.float64):
        observation = row.astype(kind)
        assert is_default(keep_masked(observation, target, source)).all()
        np.testing.assert_array_equal(keep_shared(observation, target, source), [[*range(7), 5.0, np.float32(0.1)]])


def test_own_columns_come_first_in_every_layout() -> None:
    assert all(layout.names[:7] == OWN_NAMES for layout in LAYOUTS)
