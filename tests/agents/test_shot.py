"""Shots: fired at once from anywhere, with nothing changed of how things fly."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from agents.envelope_axis import AxisError
from agents.shot import check_acts_on_shot, shot_states, shot_task
from sim.errors import MaskError
from sim.scenario_file import SECTIONS
from sim.world import Fate, World
from tests.engagements import DRILL, changed


@pytest.mark.parametrize("masked", [set(), {1, 3}])
def test_every_shot_is_fired_in_the_first_substep_with_the_first_missile_left(masked: set[int]) -> None:
    task = shot_task(DRILL, masked)
    ranges, aspects = (g.ravel() for g in np.meshgrid([100.0, 20e3, 500e3], np.radians(np.arange(-180.0, 181.0, 30.0))))
    world = World(task, len(ranges))
    world.reset(states=shot_states(task.scenario, ranges, aspects, 0, np.arange(len(ranges))))
    world.trace()
    world.step(np.zeros(len(ranges)))
    first = 1 if not masked else 2
    assert task.missiles == (first,)
    for lane in range(len(ranges)):
        assert world.traced(lane)[0, 20 + 8 * (first - 1)] == Fate.FLYING
    unfired = np.delete(world.fate, first - 1, axis=1)
    assert (unfired == Fate.UNLAUNCHED).all()


@pytest.mark.parametrize(("aspect_rad", "x", "y", "heading"), [
    (0.0, 20e3, 0.0, np.pi), (np.pi / 2, 0.0, 20e3, -np.pi / 2), (-np.pi / 2, 0.0, -20e3, np.pi / 2),
    (np.pi, -20e3, 0.0, 0.0),
])  # fmt: skip
def test_a_shooter_to_the_left_is_at_plus_y_and_points_at_the_evader(
    aspect_rad: float, x: float, y: float, heading: float
) -> None:
    (row,) = shot_states(DRILL, np.array([20e3]), np.array([aspect_rad]), 0, np.array([0]))
    assert row[:5].tolist() == [0.0, 0.0, 8500.0, 0.0, 280.0]
    assert row[5:10] == pytest.approx([x, y, 8500.0, heading, 290.0], abs=0.01)


def test_what_varies_from_shot_to_shot_follows_the_episode_and_not_the_cell() -> None:
    loose = changed(launch={"spread": 0.2})
    rows = shot_states(loose, np.full(4, 9e3), np.zeros(4), 3, np.array([0, 1, 0, 1]))
    np.testing.assert_array_equal(rows[:2], rows[2:])
    assert (rows[0, 10:] != rows[1, 10:]).any()


def test_free_fire_changes_nothing_of_how_things_fly() -> None:
    freed = shot_task(DRILL).scenario
    for section in ("battlefield", "evader", "interceptor", "missile", "reward", "variation", "sensor"):
        assert getattr(freed, section) == getattr(DRILL, section)
    kept = dataclasses.replace(freed.rules, max_steps=DRILL.rules.max_steps, outside_steps=DRILL.rules.outside_steps)
    assert kept == DRILL.rules


def test_numbers_that_have_no_effect_on_a_shot_are_refused() -> None:
    refused = set()
    for name in (f"{section}.{field.name}" for section, cls in SECTIONS.items() for field in dataclasses.fields(cls)):
        try:
            check_acts_on_shot(name)
        except AxisError as error:
            assert str(error).startswith(f"{name} has no effect on a shot")
            refused.add(name)
    assert {"launch.range_m", "launch.missiles", "rules.max_steps", "reward.exit", "start.y_spread_m"} <= refused
    assert not refused & {"missile.burn_s", "start.altitude_m", "rules.substeps", "sensor.drop_out", "evader.cl_max"}


def test_a_mask_that_leaves_no_missile_is_refused() -> None:
    with pytest.raises(MaskError, match="every missile is masked; a shot needs one"):
        shot_task(DRILL, {1, 2, 3, 4})
    with pytest.raises(MaskError, match="mask names missile 5"):
        shot_task(DRILL, {5})
