"""Shots that differ from one another: each spread does what its name says, in the kernel and in the reference."""

from __future__ import annotations

import numpy as np
import pytest

from sim.reference import ReferenceWorld
from sim.scenario import Scenario, Variation
from sim.start import initial_states
from sim.world import Fate, World
from tests.engagements import DRILL, changed, straight, task

LANES = 24
EVERYWHERE = {"range_m": 200e3, "radar_range_m": 200e3, "radar_half_angle_rad": 3.14, "tail_fraction": 1.0}


def scenario(**spreads: float) -> Scenario:
    """The drill with missiles that can be fired from anywhere, never hit, and differ by some spreads."""
    return changed(launch=EVERYWHERE | {"spread": 0.0}, missile={"fuse_m": 0.5, "arm_s": 30.0}, variation=spreads)


def flown(world: World | ReferenceWorld, seconds: int) -> World | ReferenceWorld:
    for _ in range(seconds):
        world.step(np.zeros(world.lanes))
    return world


@pytest.mark.parametrize("name", list(Variation.__dataclass_fields__))
def test_kernel_and_reference_vary_alike(name: str) -> None:
    varied = task(scenario=scenario(**{name: 0.6}))
    kernel, reference = flown(World(varied, LANES), 22), flown(ReferenceWorld(varied, LANES), 22)
    assert isinstance(kernel, World)
    assert isinstance(reference, ReferenceWorld)
    np.testing.assert_array_equal(kernel.fate, reference.fate)
    flying = kernel.fate == Fate.FLYING
    apart = np.abs(kernel.missiles["position"] - reference.missile.position).max(axis=2)[flying]
    assert apart.max() < 1.0
    plain = flown(World(task(scenario=scenario()), LANES), 22)
    assert isinstance(plain, World)
    assert not np.array_equal(plain.missiles["position"], kernel.missiles["position"])


def test_more_thrust_is_faster_and_more_drag_is_slower() -> None:
    for spread, column, sign in (("thrust_spread", 18, 1.0), ("drag_spread", 22, -1.0)):
        varied = scenario(**{spread: 0.5})
        world = flown(World(task(scenario=varied), LANES), 12)
        assert isinstance(world, World)
        factor = initial_states(varied, 0, np.arange(LANES))[:, column]
        speed = np.linalg.norm(world.missiles["velocity"][:, 0], axis=1)
        assert np.corrcoef(sign * factor, speed)[0, 1] > 0.85


def test_intervals_are_those_that_were_drawn() -> None:
    varied = scenario(interval_spread=0.5)
    world = World(task(scenario=varied), LANES)
    launches = np.full((LANES, 4), np.nan)
    for second in range(60):
        new = (world.fate != Fate.UNLAUNCHED) & np.isnan(launches)
        launches[new] = second
        world.step(straight(world.observation))
    waited = np.diff(launches, axis=1)
    factors = initial_states(varied, 0, np.arange(LANES))[:, 15:18]
    known = np.isfinite(waited)
    assert known.sum() > 30
    assert np.abs(waited - DRILL.launch.interval_s * factors)[known].max() <= 2.0


def test_masking_a_missile_leaves_the_draws_of_the_shots_alone() -> None:
    # Eq. (8): the first shot flies the same whether it is missile 1 or, with that one masked, missile 2.
    varied = scenario(**dict.fromkeys(Variation.__dataclass_fields__, 0.5))
    full, masked = (flown(World(task(*mask, scenario=varied), LANES), 10) for mask in ((), (1,)))
    assert isinstance(full, World)
    assert isinstance(masked, World)
    np.testing.assert_array_equal(full.missiles["position"][:, 0], masked.missiles["position"][:, 1])
