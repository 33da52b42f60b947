"""Firing missiles, for Warp: which one is next in a lane, when it may go, and how it leaves."""

import warp as wp

from sim.kernel.formation import may_fire, total
from sim.kernel.lane import (
    AGE,
    AX,
    CARRIED,
    CLOSEST,
    IN_FLIGHT,
    INTERVAL,
    REACH,
    SPEED,
    UNLAUNCHED,
    VX,
    VY,
    VZ,
    WIDTH,
    AircraftRows,
    IntRow,
    Model,
    Row,
    State,
    X,
    Y,
    Z,
)
from sim.kernel.physics import Aircraft
from sim.kernel.rules import launch_zone


@wp.func
def next_missile(state: State, g: int, j: int) -> int:
    """Lowest missile of a lane that is neither masked nor fired, or -1."""
    found = int(-1)
    for k in range(state.fate.shape[1]):
        if found < 0 and state.available[k] == 1 and state.fate[g, k][j] == UNLAUNCHED:
            found = k
    return found


@wp.func
def prepare(model: Model, state: State, g: int, j: int):
    """Choose the missile of a lane that is fired next, how long it waits, and from how far it can be fired."""
    k = next_missile(state, g, j)
    waiting = state.waiting[g]
    patience = state.patience[g]
    reach = state.reach[g]
    waiting[j] = k
    patience[j] = wp.inf
    reach[j] = 0.0
    if k >= 0:
        m = state.missile[g, k]
        # Whole substeps, less half a one: a float32 sum of twentieths of a second must not cost another.
        patience[j] = (wp.ceil(model.interval * m[INTERVAL, j] / model.dt - 1.0e-3) - 0.5) * model.dt
        reach[j] = wp.min(model.radar_range, model.launch_range * m[REACH, j])
    state.waiting[g] = waiting
    state.patience[g] = patience
    state.reach[g] = reach


@wp.func
def aircraft_in(rows: AircraftRows, j: int) -> Aircraft:
    """One aircraft out of its group; for use outside loops that must be fast."""
    a = Aircraft()
    a.position = wp.vec3(rows[X, j], rows[Y, j], rows[Z, j])
    a.velocity = wp.vec3(rows[VX, j], rows[VY, j], rows[VZ, j])
    a.speed = rows[SPEED, j]
    return a


@wp.func
def fire(state: State, g: int, j: int, k: int, carrier: Aircraft, distance: float):
    """Missile k of a lane leaves with the place and velocity of its carrier."""
    m = state.missile[g, k]
    for c in range(3):
        m[X + c, j] = carrier.position[c]
        m[VX + c, j] = carrier.velocity[c]
        m[AX + c, j] = 0.0
        m[CARRIED + c, j] = 0.0
    m[AGE, j] = 0.0
    m[CLOSEST, j] = distance
    state.missile[g, k] = m
    fate = state.fate[g, k]
    fate[j] = IN_FLIGHT
    state.fate[g, k] = fate


@wp.func
def launch(model: Model, state: State, g: int, e: AircraftRows, i: AircraftRows, outcome: IntRow, since: Row) -> Row:
    """Fire in every lane where the interval has passed and the evader is in the zone; returns the time since then."""
    out = since
    ready = may_fire(e, i, outcome, since, state.patience[g], state.reach[g])
    if total(ready) > 0:
        waiting = state.waiting[g]
        for j in range(WIDTH):
            k = waiting[j]
            if ready[j] == 1 and k >= 0:
                evader = aircraft_in(e, j)
                carrier = aircraft_in(i, j)
                if launch_zone(model, evader, carrier, state.missile[g, k][REACH, j]):
                    fire(state, g, j, k, carrier, wp.length(evader.position - carrier.position))
                    prepare(model, state, g, j)
                    out[j] = 0.0
    return out
