"""The one kernel that moves the world: one thread per lane, one launch per decision step, all substeps inside."""

import warp as wp

from sim.physics import (
    Aircraft,
    AircraftModel,
    Missile,
    MissileModel,
    closest_approach,
    direction,
    fly_aircraft,
    fly_missile,
    wrap_to_pi,
)

# Warp greets and reports compilations on standard output, where commands print one JSON object and nothing else.
wp.config.log_level = wp.LOG_ERROR
wp.set_module_options({"enable_backward": False, "fast_math": False})

HALF_TURN = wp.constant(1.57079632679)
NO_RANGE = wp.constant(-1.0)  # observation.UNLAUNCHED, written exactly so that Eq. (13) can compare exactly
NO_AZIMUTH = wp.constant(-3.14159265358979)

UNLAUNCHED = wp.constant(0)  # the values of sim.world.Fate
IN_FLIGHT = wp.constant(1)
EVADED = wp.constant(2)
HIT = wp.constant(3)

FLYING = wp.constant(0)  # the values of sim.world.Outcome
EXIT = wp.constant(1)
SHOT_DOWN = wp.constant(2)
LEFT_FIELD = wp.constant(3)
TIMEOUT = wp.constant(4)


@wp.struct
class Model:
    """A scenario as the kernel reads it; units as in `sim.scenario`."""

    evader: AircraftModel
    interceptor: AircraftModel
    missile: MissileModel
    half_length: float
    half_width: float
    exit_y: float
    exit_half_width: float
    radar_range: float
    radar_half_angle: float
    launch_range: float
    tail_fraction: float
    range_min: float
    interval: float
    dt: float
    substeps: int
    max_steps: int
    outside_steps: int
    reward_exit: float
    reward_evaded: float
    reward_shot_down: float
    reward_step: float


@wp.struct
class State:
    """All mutable arrays of the world, leading axis lanes L; aircraft axis [evader, interceptor], missile axis M."""

    aircraft: wp.array2d(dtype=Aircraft)
    altitude: wp.array2d(dtype=float)  # held by the controllers [m]
    speed: wp.array2d(dtype=float)  # held by the controllers [m/s]
    missile: wp.array2d(dtype=Missile)
    fate: wp.array2d(dtype=int)
    closest: wp.array2d(dtype=float)  # smallest distance so far [m]
    range_factor: wp.array2d(dtype=float)  # random share of the launch range
    available: wp.array(dtype=int)  # 1 when the missile is not masked [M]
    since_launch: wp.array(dtype=float)  # [s]
    steps: wp.array(dtype=int)
    outside: wp.array(dtype=int)  # consecutive steps outside the battlefield
    outcome: wp.array(dtype=int)
    killer: wp.array(dtype=int)


@wp.func
def planar_bearing(offset: wp.vec3) -> float:
    """Heading [rad] that points along an offset [m] seen from above."""
    return wp.atan2(offset[1], offset[0])


@wp.func
def launch_zone(model: Model, evader: Aircraft, interceptor: Aircraft, factor: float) -> bool:
    """Whether the interceptor may fire: radar, field of view, and a range that grows from tail chase to head-on."""
    offset = evader.position - interceptor.position
    distance = wp.length(offset)
    facing = -wp.dot(direction(evader.climb, evader.heading), offset) / distance
    aspect_share = model.tail_fraction + (1.0 - model.tail_fraction) * 0.5 * (1.0 + facing)
    off_nose = wp.abs(wrap_to_pi(planar_bearing(offset) - interceptor.heading))
    in_range = distance >= model.range_min and distance <= model.launch_range * factor * aspect_share
    return in_range and distance <= model.radar_range and off_nose <= model.radar_half_angle


@wp.func
def next_missile(state: State, lane: int) -> int:
    """Lowest missile that is neither masked nor fired, or -1."""
    found = int(-1)
    for k in range(state.fate.shape[1]):
        if found < 0 and state.available[k] == 1 and state.fate[lane, k] == UNLAUNCHED:
            found = k
    return found


@wp.func
def evaded(model: MissileModel, missile: Missile, distance: float, closest: float) -> bool:
    """Whether a missile is spent: too slow, too old, or opening again after its closest approach."""
    slow = missile.age > model.burn and wp.length(missile.velocity) < model.speed_min
    opening = missile.age > model.arm and distance > closest + model.opening
    return slow or missile.age > model.age_max or opening


@wp.func
def step_missile(model: Model, state: State, lane: int, k: int, before: Aircraft, after: Aircraft) -> float:
    """Move one missile in flight by one substep; returns its reward term and records a kill."""
    old = state.missile[lane, k]
    velocity = before.speed * direction(before.climb, before.heading)
    new = fly_missile(old, model.missile, before.position, velocity, model.dt)
    miss = closest_approach(before.position - old.position, after.position - new.position)
    distance = wp.length(after.position - new.position)
    state.closest[lane, k] = wp.min(state.closest[lane, k], miss)
    state.missile[lane, k] = new
    reward = float(0.0)
    if miss <= model.missile.fuse and new.age >= model.missile.arm - 0.5 * model.dt:
        state.fate[lane, k] = HIT
        state.outcome[lane] = SHOT_DOWN
        state.killer[lane] = k + 1
        reward = model.reward_shot_down
    elif evaded(model.missile, new, distance, state.closest[lane, k]):
        state.fate[lane, k] = EVADED
        reward = model.reward_evaded
    return reward


@wp.func
def launch(model: Model, state: State, lane: int, interceptor: Aircraft, evader: Aircraft):
    """Fire the next missile when the interval has passed and the evader is in the zone; with the carrier's velocity."""
    state.since_launch[lane] = state.since_launch[lane] + model.dt
    k = next_missile(state, lane)
    # Half a substep of slack: a float32 sum of twentieths of a second must not cost one.
    ready = state.outcome[lane] == FLYING and state.since_launch[lane] >= model.interval - 0.5 * model.dt
    if k >= 0 and ready and launch_zone(model, evader, interceptor, state.range_factor[lane, wp.max(k, 0)]):
        missile = Missile()
        missile.position = interceptor.position
        missile.velocity = interceptor.speed * direction(interceptor.climb, interceptor.heading)
        state.missile[lane, k] = missile
        state.fate[lane, k] = IN_FLIGHT
        state.closest[lane, k] = wp.length(evader.position - interceptor.position)
        state.since_launch[lane] = 0.0


@wp.func
def through_gate(model: Model, before: wp.vec3, after: wp.vec3) -> bool:
    """Whether a straight move crosses the exit gate on the right edge from inside."""
    share = (model.half_length - before[0]) / wp.max(after[0] - before[0], 1.0e-9)
    crossing = before[1] + share * (after[1] - before[1])
    crosses = before[0] < model.half_length and after[0] >= model.half_length
    return crosses and wp.abs(crossing - model.exit_y) <= model.exit_half_width


@wp.func
def observe(model: Model, state: State, lane: int, observation: wp.array2d(dtype=float)):
    """Write Table 1 for all M missiles; blocks of missiles that do not fly hold the default vector."""
    e = state.aircraft[lane, 0]
    i = state.aircraft[lane, 1]
    offset = i.position - e.position
    gate = wp.vec3(model.half_length, model.exit_y, 0.0) - e.position
    observation[lane, 0] = e.position[0]
    observation[lane, 1] = e.position[1]
    observation[lane, 2] = e.heading
    observation[lane, 3] = wp.length(offset)
    observation[lane, 4] = wrap_to_pi(planar_bearing(-offset) - i.heading - 2.0 * HALF_TURN)
    observation[lane, 5] = wrap_to_pi(planar_bearing(offset) - e.heading)
    observation[lane, 6] = wrap_to_pi(planar_bearing(gate) - e.heading)
    for k in range(state.fate.shape[1]):
        distance = float(NO_RANGE)
        angle = float(NO_AZIMUTH)
        if state.fate[lane, k] == IN_FLIGHT:
            towards = state.missile[lane, k].position - e.position
            distance = wp.length(towards)
            angle = wrap_to_pi(planar_bearing(towards) - e.heading)
        observation[lane, 7 + 2 * k] = distance
        observation[lane, 8 + 2 * k] = angle


@wp.func
def write_trace(state: State, lane: int, substep: int, e: Aircraft, i: Aircraft, trace: wp.array3d(dtype=float)):
    """Write one substep of a recording: both aircraft [7 each], then per missile position, velocity, fate, closest."""
    for side in range(2):
        a = e
        if side == 1:
            a = i
        for c in range(3):
            trace[lane, substep, 7 * side + c] = a.position[c]
        trace[lane, substep, 7 * side + 3] = a.speed
        trace[lane, substep, 7 * side + 4] = a.climb
        trace[lane, substep, 7 * side + 5] = a.heading
        trace[lane, substep, 7 * side + 6] = a.bank
    for k in range(state.fate.shape[1]):
        m = state.missile[lane, k]
        for c in range(3):
            trace[lane, substep, 14 + 8 * k + c] = m.position[c]
            trace[lane, substep, 17 + 8 * k + c] = m.velocity[c]
        trace[lane, substep, 20 + 8 * k] = float(state.fate[lane, k])
        trace[lane, substep, 21 + 8 * k] = state.closest[lane, k]


@wp.func
def finish_step(model: Model, state: State, lane: int, position: wp.vec3) -> float:
    """Count the step and apply the rules that act once per step; returns the goal's reward term."""
    state.steps[lane] = state.steps[lane] + 1
    inside = wp.abs(position[0]) <= model.half_length and wp.abs(position[1]) <= model.half_width
    state.outside[lane] = wp.where(inside, 0, state.outside[lane] + 1)
    if state.outcome[lane] == EXIT:
        return model.reward_exit
    if state.outcome[lane] == FLYING and state.outside[lane] > model.outside_steps:
        state.outcome[lane] = LEFT_FIELD
        return model.reward_shot_down
    if state.outcome[lane] == FLYING and state.steps[lane] >= model.max_steps:
        state.outcome[lane] = TIMEOUT
    return 0.0


@wp.kernel
def step_lanes(
    first: int,
    model: Model,
    state: State,
    action: wp.array(dtype=float),
    terms: wp.array2d(dtype=float),
    observation: wp.array2d(dtype=float),
    flown: wp.array(dtype=int),
    trace: wp.array3d(dtype=float),
    tracing: int,
):
    """One decision step of every lane from `first` on that still flies.

    Writes reward `terms [L, M + 2]` (goal, missiles, time), the next `observation [L, 7 + 2 M]`, the number of substeps
    `flown [L]` and, when `tracing`, one row of `trace [L, substeps, 14 + 8 M]` per substep.
    """
    lane = first + wp.tid()
    missiles = state.fate.shape[1]
    for c in range(missiles + 2):
        terms[lane, c] = 0.0
    flown[lane] = 0
    if state.outcome[lane] != FLYING:
        return
    e = state.aircraft[lane, 0]
    i = state.aircraft[lane, 1]
    command = e.heading + wp.clamp(action[lane], -HALF_TURN, HALF_TURN)
    for s in range(model.substeps):
        if state.outcome[lane] == FLYING:
            offset = e.position - i.position
            close = wp.length(offset) < model.range_min
            chase = wp.where(close, wp.min(state.speed[lane, 1], e.speed - 20.0), state.speed[lane, 1])
            e1 = fly_aircraft(e, model.evader, command, state.altitude[lane, 0], state.speed[lane, 0], model.dt)
            i1 = fly_aircraft(i, model.interceptor, planar_bearing(offset), state.altitude[lane, 1], chase, model.dt)
            for k in range(missiles):
                if state.outcome[lane] == FLYING and state.fate[lane, k] == IN_FLIGHT:
                    terms[lane, 1 + k] = terms[lane, 1 + k] + step_missile(model, state, lane, k, e, e1)
            if state.outcome[lane] == FLYING and through_gate(model, e.position, e1.position):
                state.outcome[lane] = EXIT
            launch(model, state, lane, i1, e1)
            e = e1
            i = i1
            flown[lane] = s + 1
            if tracing == 1:
                write_trace(state, lane, s, e, i, trace)
    state.aircraft[lane, 0] = e
    state.aircraft[lane, 1] = i
    terms[lane, 0] = finish_step(model, state, lane, e.position)
    terms[lane, missiles + 1] = model.reward_step
    observe(model, state, lane, observation)


@wp.kernel
def reset_lanes(
    model: Model,
    state: State,
    lanes: wp.array(dtype=int),
    start: wp.array2d(dtype=float),
    observation: wp.array2d(dtype=float),
):
    """Put lanes back to initial states `start [n, 10 + M]`: aircraft x, y, altitude, heading, speed; range factors."""
    row = wp.tid()
    lane = lanes[row]
    for side in range(2):
        a = Aircraft()
        a.position = wp.vec3(start[row, 5 * side], start[row, 5 * side + 1], start[row, 5 * side + 2])
        a.heading = wrap_to_pi(start[row, 5 * side + 3])
        a.speed = start[row, 5 * side + 4]
        state.aircraft[lane, side] = a
        state.altitude[lane, side] = start[row, 5 * side + 2]
        state.speed[lane, side] = start[row, 5 * side + 4]
    for k in range(state.fate.shape[1]):
        state.fate[lane, k] = UNLAUNCHED
        state.closest[lane, k] = wp.inf
        state.missile[lane, k] = Missile()
        state.range_factor[lane, k] = start[row, 10 + k]
    state.since_launch[lane] = model.interval
    state.steps[lane] = 0
    state.outside[lane] = 0
    state.outcome[lane] = FLYING
    state.killer[lane] = 0
    observe(model, state, lane, observation)
