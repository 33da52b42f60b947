"""The kernel that starts lanes anew."""

import warp as wp

from sim.kernel.elementary import cosine, sine, wrap_to_pi
from sim.kernel.lane import (
    BANK,
    CARRY,
    CLIMB,
    CLOSEST,
    CRUISE,
    DRAG,
    HEADING,
    INTERVAL,
    LEVEL,
    MISSILE_ROWS,
    NAVIGATION,
    OPTIONS,
    REACH,
    RESPONSE,
    SPEED,
    THRUST,
    VX,
    VY,
    VZ,
    WIDTH,
    AircraftRows,
    IntRow,
    MissileRows,
    Model,
    State,
    X,
)
from sim.kernel.launching import prepare
from sim.kernel.readout import observe

wp.set_module_options(OPTIONS)

NEVER = wp.constant(1.0e6)  # since the last launch [s], before the first


@wp.func
def draw_shot(
    model: Model, m: MissileRows, j: int, start: wp.array2d(dtype=float), lane: int, shot: int
) -> MissileRows:
    """Missile rows in which one lane holds a fresh missile with the draws of its shot; see `sim.start`."""
    out = m
    missiles = (start.shape[1] - 10) / 6
    for c in range(MISSILE_ROWS):
        out[c, j] = 0.0
    out[CLOSEST, j] = wp.inf
    out[REACH, j] = start[lane, 10 + shot]
    out[INTERVAL, j] = start[lane, 10 + missiles + shot]
    out[THRUST, j] = start[lane, 10 + 2 * missiles + shot]
    out[DRAG, j] = start[lane, 10 + 3 * missiles + shot]
    out[NAVIGATION, j] = start[lane, 10 + 4 * missiles + shot]
    out[RESPONSE, j] = 1.0 - wp.exp(-model.dt / (model.missile.lag * start[lane, 10 + 5 * missiles + shot]))
    return out


@wp.func
def place(rows: AircraftRows, j: int, start: wp.array2d(dtype=float), lane: int, first: int) -> AircraftRows:
    """Aircraft rows in which one lane holds a fresh level flight from five columns of its initial state."""
    out = rows
    heading = wrap_to_pi(start[lane, first + 3])
    speed = start[lane, first + 4]
    for c in range(3):
        out[X + c, j] = start[lane, first + c]
        out[CARRY + c, j] = 0.0
    out[VX, j] = speed * cosine(heading)
    out[VY, j] = speed * sine(heading)
    out[VZ, j] = 0.0
    out[SPEED, j] = speed
    out[CLIMB, j] = 0.0
    out[HEADING, j] = heading
    out[BANK, j] = 0.0
    out[LEVEL, j] = start[lane, first + 2]
    out[CRUISE, j] = speed
    return out


@wp.func
def cleared(row: IntRow, j: int) -> IntRow:
    """A row with a zero in one lane."""
    out = row
    out[j] = 0
    return out


@wp.func
def begin(model: Model, state: State, g: int, j: int, start: wp.array2d(dtype=float)):
    """Put one lane back to its initial state."""
    lane = g * WIDTH + j
    state.aircraft[g, 0] = place(state.aircraft[g, 0], j, start, lane, 0)
    state.aircraft[g, 1] = place(state.aircraft[g, 1], j, start, lane, 5)
    shot = int(0)
    for k in range(state.fate.shape[1]):
        state.fate[g, k] = cleared(state.fate[g, k], j)
        # Draws belong to shots in the order in which they are fired, so masking a missile leaves those of the others.
        state.missile[g, k] = draw_shot(model, state.missile[g, k], j, start, lane, shot)
        shot = shot + state.available[k]
        shot = wp.min(shot, state.fate.shape[1] - 1)
    since = state.since_launch[g]
    since[j] = NEVER
    state.since_launch[g] = since
    state.steps[g] = cleared(state.steps[g], j)
    state.outside[g] = cleared(state.outside[g], j)
    state.outcome[g] = cleared(state.outcome[g], j)
    state.killer[g] = cleared(state.killer[g], j)
    prepare(model, state, g, j)


@wp.kernel
def reset_groups(
    model: Model,
    state: State,
    groups: wp.array(dtype=int),
    chosen: wp.array(dtype=int),
    start: wp.array2d(dtype=float),
    observation: wp.array2d(dtype=float),
):
    """Put the `chosen [L]` lanes of some groups back to their rows of `start [L, 10 + 6 M]`; see `sim.start`."""
    g = groups[wp.tid()]
    for j in range(WIDTH):
        if chosen[g * WIDTH + j] == 1:
            begin(model, state, g, j, start)
    observe(model, state, g, observation)
