"""Moving a group of lanes by one substep, for Warp: loops that the compiler turns into vector instructions.

Rows are read and written in the loops themselves, one by one: handing a whole group to a function inside a loop copies
it each time, and the loop falls back to one lane after the other, fifteen times slower.
"""

import warp as wp

from sim.kernel.elementary import wrap_to_pi
from sim.kernel.lane import (
    AGE,
    AX,
    AY,
    AZ,
    BANK,
    CARRIED,
    CARRY,
    CLIMB,
    CLOSEST,
    CRUISE,
    DRAG,
    EVADED,
    EXIT,
    FLYING,
    HEADING,
    HIT,
    IN_FLIGHT,
    LEVEL,
    MISS,
    NAVIGATION,
    RESPONSE,
    SPEED,
    THRUST,
    UNLAUNCHED,
    VX,
    VY,
    VZ,
    WIDTH,
    AircraftRows,
    IntRow,
    MissileRows,
    Model,
    Row,
    X,
    Y,
    Z,
)
from sim.kernel.physics import (
    Aircraft,
    AircraftModel,
    Missile,
    Shot,
    closest_approach,
    fly_aircraft,
    fly_missile,
    turn_to,
)
from sim.kernel.rules import spent, through_gate


@wp.func
def time_steps(model: Model, outcome: IntRow) -> Row:
    """Substep [s] of every lane: 0, so that nothing moves, where the engagement is over."""
    dt = Row()
    for j in range(WIDTH):
        dt[j] = wp.where(outcome[j] == FLYING, model.dt, 0.0)
    return dt


@wp.func
def turns_to(command: Row, evader: AircraftRows) -> Row:
    """Turns [rad] the evaders still have to make to their commanded headings."""
    turn = Row()
    for j in range(WIDTH):
        turn[j] = wrap_to_pi(command[j] - evader[HEADING, j])
    return turn


@wp.func
def turns_after(interceptor: AircraftRows, evader: AircraftRows) -> Row:
    """Turns [rad] that point the interceptors at their evaders."""
    turn = Row()
    for j in range(WIDTH):
        x = evader[X, j] - interceptor[X, j]
        y = evader[Y, j] - interceptor[Y, j]
        velocity = wp.vec3(interceptor[VX, j], interceptor[VY, j], 0.0)
        turn[j] = turn_to(velocity, wp.vec3(x, y, 0.0))
    return turn


@wp.func
def chase_speeds(model: Model, interceptor: AircraftRows, evader: AircraftRows) -> Row:
    """Speeds [m/s] the interceptors hold: one that is too close to fire falls back."""
    speed = Row()
    for j in range(WIDTH):
        x = evader[X, j] - interceptor[X, j]
        y = evader[Y, j] - interceptor[Y, j]
        z = evader[Z, j] - interceptor[Z, j]
        close = x * x + y * y + z * z < model.range_min * model.range_min
        cruise = interceptor[CRUISE, j]
        speed[j] = wp.where(close, wp.min(cruise, evader[SPEED, j] - 20.0), cruise)
    return speed


@wp.func
def fly_group(model: AircraftModel, rows: AircraftRows, turn: Row, speed: Row, dt: Row) -> AircraftRows:
    """Fly one aircraft of every lane."""
    out = rows
    for j in range(WIDTH):
        a = Aircraft()
        a.position = wp.vec3(rows[X, j], rows[Y, j], rows[Z, j])
        a.velocity = wp.vec3(rows[VX, j], rows[VY, j], rows[VZ, j])
        a.carry = wp.vec3(rows[CARRY, j], rows[CARRY + 1, j], rows[CARRY + 2, j])
        a.speed = rows[SPEED, j]
        a.climb = rows[CLIMB, j]
        a.heading = rows[HEADING, j]
        a.bank = rows[BANK, j]
        b = fly_aircraft(a, model, turn[j], rows[LEVEL, j], speed[j], dt[j])
        out[X, j] = b.position[0]
        out[Y, j] = b.position[1]
        out[Z, j] = b.position[2]
        out[VX, j] = b.velocity[0]
        out[VY, j] = b.velocity[1]
        out[VZ, j] = b.velocity[2]
        out[CARRY, j] = b.carry[0]
        out[CARRY + 1, j] = b.carry[1]
        out[CARRY + 2, j] = b.carry[2]
        out[SPEED, j] = b.speed
        out[CLIMB, j] = b.climb
        out[HEADING, j] = b.heading
        out[BANK, j] = b.bank
    return out


@wp.func
def aloft(fate: IntRow, outcome: IntRow) -> IntRow:
    """1 in the lanes where a missile has to be moved."""
    on = IntRow()
    for j in range(WIDTH):
        on[j] = wp.where(fate[j] == IN_FLIGHT and outcome[j] == FLYING, 1, 0)
    return on


@wp.func
def total(row: IntRow) -> int:
    """Sum of a row."""
    count = int(0)
    for j in range(WIDTH):
        count = count + row[j]
    return count


@wp.func
def differences(a: IntRow, b: IntRow) -> int:
    """In how many lanes two rows differ."""
    count = int(0)
    for j in range(WIDTH):
        count = count + wp.where(a[j] == b[j], 0, 1)
    return count


@wp.func
def fly_missiles(model: Model, m: MissileRows, before: AircraftRows, after: AircraftRows, on: IntRow) -> MissileRows:
    """Fly one missile in the lanes where `on` is 1; its rows carry the smallest distance along."""
    out = m
    for j in range(WIDTH):
        s = Missile()
        s.position = wp.vec3(m[X, j], m[Y, j], m[Z, j])
        s.velocity = wp.vec3(m[VX, j], m[VY, j], m[VZ, j])
        s.lateral = wp.vec3(m[AX, j], m[AY, j], m[AZ, j])
        s.carry = wp.vec3(m[CARRIED, j], m[CARRIED + 1, j], m[CARRIED + 2, j])
        s.age = m[AGE, j]
        shot = Shot()
        shot.thrust = m[THRUST, j]
        shot.drag = m[DRAG, j]
        shot.navigation = m[NAVIGATION, j]
        shot.response = m[RESPONSE, j]
        target = wp.vec3(before[X, j], before[Y, j], before[Z, j])
        velocity = wp.vec3(before[VX, j], before[VY, j], before[VZ, j])
        moved = wp.vec3(after[X, j], after[Y, j], after[Z, j])
        n = fly_missile(s, model.missile, shot, target, velocity, model.dt)
        miss = closest_approach(target - s.position, moved - n.position)
        flies = on[j] == 1
        out[X, j] = wp.where(flies, n.position[0], m[X, j])
        out[Y, j] = wp.where(flies, n.position[1], m[Y, j])
        out[Z, j] = wp.where(flies, n.position[2], m[Z, j])
        out[VX, j] = wp.where(flies, n.velocity[0], m[VX, j])
        out[VY, j] = wp.where(flies, n.velocity[1], m[VY, j])
        out[VZ, j] = wp.where(flies, n.velocity[2], m[VZ, j])
        out[AX, j] = wp.where(flies, n.lateral[0], m[AX, j])
        out[AY, j] = wp.where(flies, n.lateral[1], m[AY, j])
        out[AZ, j] = wp.where(flies, n.lateral[2], m[AZ, j])
        out[CARRIED, j] = wp.where(flies, n.carry[0], m[CARRIED, j])
        out[CARRIED + 1, j] = wp.where(flies, n.carry[1], m[CARRIED + 1, j])
        out[CARRIED + 2, j] = wp.where(flies, n.carry[2], m[CARRIED + 2, j])
        out[AGE, j] = wp.where(flies, n.age, m[AGE, j])
        out[MISS, j] = miss
        out[CLOSEST, j] = wp.where(flies, wp.min(m[CLOSEST, j], miss), m[CLOSEST, j])
    return out


@wp.func
def fates_after(model: Model, m: MissileRows, after: AircraftRows, fate: IntRow, on: IntRow) -> IntRow:
    """Fates of one missile: it hits, is evaded, or flies on."""
    out = fate
    for j in range(WIDTH):
        s = Missile()
        s.velocity = wp.vec3(m[VX, j], m[VY, j], m[VZ, j])
        s.age = m[AGE, j]
        offset = wp.vec3(after[X, j] - m[X, j], after[Y, j] - m[Y, j], after[Z, j] - m[Z, j])
        # Half a substep of slack: a float32 sum of twentieths of a second must not cost one.
        hit = m[MISS, j] <= model.missile.fuse and s.age >= model.missile.arm - 0.5 * model.dt
        gone = spent(model.missile, s, wp.length(offset), m[CLOSEST, j])
        out[j] = wp.where(on[j] == 1, wp.where(hit, HIT, wp.where(gone, EVADED, IN_FLIGHT)), fate[j])
    return out


@wp.func
def leave_by_gate(model: Model, before: AircraftRows, after: AircraftRows, outcome: IntRow) -> IntRow:
    """Outcomes once those evaders that fly have crossed, or not, the exit gate."""
    out = outcome
    for j in range(WIDTH):
        p = wp.vec3(before[X, j], before[Y, j], 0.0)
        q = wp.vec3(after[X, j], after[Y, j], 0.0)
        out[j] = wp.where(outcome[j] == FLYING and through_gate(model, p, q), EXIT, outcome[j])
    return out


@wp.func
def may_fire(e: AircraftRows, i: AircraftRows, outcome: IntRow, since: Row, patience: Row, reach: Row) -> IntRow:
    """1 in the lanes where the next missile has waited long enough and the evader is near enough to look closer."""
    ready = IntRow()
    for j in range(WIDTH):
        x = e[X, j] - i[X, j]
        y = e[Y, j] - i[Y, j]
        z = e[Z, j] - i[Z, j]
        near = x * x + y * y + z * z <= reach[j] * reach[j]
        ready[j] = wp.where(near and outcome[j] == FLYING and since[j] >= patience[j], 1, 0)
    return ready


@wp.func
def squares(rows: AircraftRows) -> Row:
    """Sums of squares of position and velocity: not finite when one of them is not."""
    out = Row()
    for j in range(WIDTH):
        p = wp.vec3(rows[X, j], rows[Y, j], rows[Z, j])
        v = wp.vec3(rows[VX, j], rows[VY, j], rows[VZ, j])
        out[j] = wp.length_sq(p) + wp.length_sq(v)
    return out


@wp.func
def missile_squares(rows: MissileRows, fate: IntRow) -> Row:
    """The same of a missile that was fired, 0 of one that was not."""
    out = Row()
    for j in range(WIDTH):
        p = wp.vec3(rows[X, j], rows[Y, j], rows[Z, j])
        v = wp.vec3(rows[VX, j], rows[VY, j], rows[VZ, j])
        out[j] = wp.where(fate[j] == UNLAUNCHED, 0.0, wp.length_sq(p) + wp.length_sq(v))
    return out
