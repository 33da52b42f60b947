"""What leaves the kernel, for Warp: the observation of Table 1, and the rows of a recording."""

import warp as wp

from sim.kernel.lane import (
    BANK,
    CLIMB,
    CLOSEST,
    HEADING,
    IN_FLIGHT,
    NOT_FINITE,
    SPEED,
    VX,
    VY,
    WIDTH,
    AircraftRows,
    IntRow,
    MissileRows,
    Model,
    State,
    X,
    Y,
    Z,
)
from sim.kernel.physics import turn_to

NO_RANGE = wp.constant(-1.0)  # observation.UNLAUNCHED, written exactly so that Eq. (13) can compare exactly
NO_AZIMUTH = wp.constant(-3.14159265358979)

OwnRows = wp.types.matrix((7, WIDTH), float)  # the columns every task has
SightRows = wp.types.matrix((2, WIDTH), float)  # range [m] and azimuth [rad] of a missile


@wp.func
def own_columns(model: Model, e: AircraftRows, i: AircraftRows) -> OwnRows:
    """x, y, heading, range to the interceptor, its aspect angle, the antenna train angle, the turn to the exit."""
    own = OwnRows()
    for j in range(WIDTH):
        offset = wp.vec3(i[X, j] - e[X, j], i[Y, j] - e[Y, j], i[Z, j] - e[Z, j])
        gate = wp.vec3(model.half_length - e[X, j], model.exit_y - e[Y, j], 0.0)
        velocity = wp.vec3(e[VX, j], e[VY, j], 0.0)
        own[0, j] = e[X, j]
        own[1, j] = e[Y, j]
        own[2, j] = e[HEADING, j]
        own[3, j] = wp.length(offset)
        own[4, j] = turn_to(wp.vec3(i[VX, j], i[VY, j], 0.0), offset)
        own[5, j] = turn_to(velocity, offset)
        own[6, j] = turn_to(velocity, gate)
    return own


@wp.func
def sight(e: AircraftRows, m: MissileRows, fate: IntRow) -> SightRows:
    """Range and azimuth of one missile from the evader; the default vector where it does not fly."""
    out = SightRows()
    for j in range(WIDTH):
        offset = wp.vec3(m[X, j] - e[X, j], m[Y, j] - e[Y, j], m[Z, j] - e[Z, j])
        flies = fate[j] == IN_FLIGHT
        azimuth = turn_to(wp.vec3(e[VX, j], e[VY, j], 0.0), offset)
        out[0, j] = wp.where(flies, wp.length(offset), NO_RANGE)
        out[1, j] = wp.where(flies, azimuth, NO_AZIMUTH)
    return out


@wp.func
def observe(model: Model, state: State, g: int, observation: wp.array2d(dtype=float)):
    """Write Table 1 for all M missiles of a group; a lane that is not finite keeps its last observation."""
    e = state.aircraft[g, 0]
    own = own_columns(model, e, state.aircraft[g, 1])
    outcome = state.outcome[g]
    for j in range(WIDTH):
        if outcome[j] != NOT_FINITE:
            for c in range(7):
                observation[g * WIDTH + j, c] = own[c, j]
    for k in range(state.fate.shape[1]):
        seen = sight(e, state.missile[g, k], state.fate[g, k])
        for j in range(WIDTH):
            if outcome[j] != NOT_FINITE:
                observation[g * WIDTH + j, 7 + 2 * k] = seen[0, j]
                observation[g * WIDTH + j, 8 + 2 * k] = seen[1, j]


@wp.func
def write_body(rows: AircraftRows, j: int, lane: int, substep: int, first: int, trace: wp.array3d(dtype=float)):
    """Write one aircraft from column `first` on: position, speed, climb, heading, bank."""
    for c in range(3):
        trace[lane, substep, first + c] = rows[X + c, j]
    trace[lane, substep, first + 3] = rows[SPEED, j]
    trace[lane, substep, first + 4] = rows[CLIMB, j]
    trace[lane, substep, first + 5] = rows[HEADING, j]
    trace[lane, substep, first + 6] = rows[BANK, j]


@wp.func
def write_trace(
    state: State, g: int, j: int, substep: int, e: AircraftRows, i: AircraftRows, trace: wp.array3d(dtype=float)
):
    """Write one substep of one lane: both aircraft [7 each], then per missile position, velocity, fate, closest."""
    lane = g * WIDTH + j
    write_body(e, j, lane, substep, 0, trace)
    write_body(i, j, lane, substep, 7, trace)
    for k in range(state.fate.shape[1]):
        m = state.missile[g, k]
        for c in range(3):
            trace[lane, substep, 14 + 8 * k + c] = m[X + c, j]
            trace[lane, substep, 17 + 8 * k + c] = m[VX + c, j]
        trace[lane, substep, 20 + 8 * k] = float(state.fate[g, k][j])
        trace[lane, substep, 21 + 8 * k] = m[CLOSEST, j]
