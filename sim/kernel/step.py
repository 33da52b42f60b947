"""The kernel that moves the world: one thread per group of lanes, one launch per decision step, all substeps inside."""

import warp as wp

from sim.kernel.elementary import HALF_PI
from sim.kernel.formation import (
    aloft,
    chase_speeds,
    differences,
    fates_after,
    fly_group,
    fly_missiles,
    leave_by_gate,
    missile_squares,
    squares,
    time_steps,
    total,
    turns_after,
    turns_to,
)  # fmt: skip
from sim.kernel.lane import (
    AIRCRAFT_ROWS,
    CRUISE,
    EXIT,
    FLYING,
    HEADING,
    HIT,
    LEFT_FIELD,
    NOT_FINITE,
    OPTIONS,
    SHOT_DOWN,
    TIMEOUT,
    WIDTH,
    AircraftRows,
    IntRow,
    Model,
    Row,
    State,
    X,
    Y,
)
from sim.kernel.launching import launch
from sim.kernel.readout import observe, write_trace

wp.set_module_options(OPTIONS)


@wp.func
def pay_for(
    model: Model, state: State, g: int, k: int, fate: IntRow, outcome: IntRow, terms: wp.array2d(dtype=float)
) -> IntRow:
    """Write the reward for those missiles k whose fate is no longer that of the state; returns the outcomes."""
    out = outcome
    was = state.fate[g, k]
    killer = state.killer[g]
    for j in range(WIDTH):
        if fate[j] != was[j]:
            terms[g * WIDTH + j, 1 + k] = wp.where(fate[j] == HIT, model.reward_shot_down, model.reward_evaded)
            if fate[j] == HIT:
                out[j] = SHOT_DOWN
                killer[j] = k + 1
    state.killer[g] = killer
    return out


@wp.func
def move_missiles(
    model: Model, state: State, g: int, e: AircraftRows, moved: AircraftRows, outcome: IntRow,
    terms: wp.array2d(dtype=float),
) -> IntRow:  # fmt: skip
    """Move all missiles in flight by one substep while evaders go from `e` to `moved`; returns the outcomes.

    Missiles move in the order of their numbers; after a hit the others of that lane stay where they are.
    """
    out = outcome
    for k in range(state.fate.shape[1]):
        fate = state.fate[g, k]
        on = aloft(fate, out)
        if total(on) > 0:
            missile = fly_missiles(model, state.missile[g, k], e, moved, on)
            became = fates_after(model, missile, moved, fate, on)
            state.missile[g, k] = missile
            if differences(became, fate) > 0:
                out = pay_for(model, state, g, k, became, out, terms)
                state.fate[g, k] = became
    return out


@wp.func
def finite(state: State, g: int, e: AircraftRows, i: AircraftRows) -> IntRow:
    """1 in the lanes where all that moves has finite numbers."""
    out = IntRow()
    sums = squares(e) + squares(i)
    for k in range(state.fate.shape[1]):
        sums = sums + missile_squares(state.missile[g, k], state.fate[g, k])
    for j in range(WIDTH):
        out[j] = wp.where(wp.isfinite(sums[j]), 1, 0)
    return out


@wp.func
def judge(model: Model, state: State, g: int, e: AircraftRows, began: IntRow, outcome: IntRow) -> IntRow:
    """Count the step in the lanes that began it and apply the rules that act once per step; returns the outcomes."""
    out = outcome
    steps = state.steps[g]
    outside = state.outside[g]
    for j in range(WIDTH):
        inside = wp.abs(e[X, j]) <= model.half_length and wp.abs(e[Y, j]) <= model.half_width
        steps[j] = steps[j] + began[j]
        outside[j] = wp.where(inside, 0, outside[j] + began[j])
        late = wp.where(steps[j] >= model.max_steps, TIMEOUT, FLYING)
        verdict = wp.where(outside[j] > model.outside_steps, LEFT_FIELD, late)
        out[j] = wp.where(outcome[j] == FLYING, verdict, outcome[j])
    state.steps[g] = steps
    state.outside[g] = outside
    return out


@wp.func
def close_step(
    model: Model, state: State, g: int, e: AircraftRows, i: AircraftRows, began: IntRow, outcome: IntRow,
    terms: wp.array2d(dtype=float),
):  # fmt: skip
    """Keep the state, judge the step and pay goal and time; where a number is not finite, the last ones stay."""
    sound = finite(state, g, e, i)
    kept_e = e
    kept_i = i
    out = judge(model, state, g, e, began, outcome)
    was_e = state.aircraft[g, 0]
    was_i = state.aircraft[g, 1]
    for j in range(WIDTH):
        lane = g * WIDTH + j
        if began[j] == 1:
            terms[lane, 0] = wp.where(
                out[j] == EXIT, model.reward_exit, wp.where(out[j] == LEFT_FIELD, model.reward_shot_down, 0.0)
            )
            terms[lane, state.fate.shape[1] + 1] = model.reward_step
        if began[j] == 1 and sound[j] == 0:
            out[j] = NOT_FINITE
            for c in range(state.fate.shape[1] + 2):
                terms[lane, c] = 0.0
            for c in range(AIRCRAFT_ROWS):
                kept_e[c, j] = was_e[c, j]
                kept_i[c, j] = was_i[c, j]
    state.aircraft[g, 0] = kept_e
    state.aircraft[g, 1] = kept_i
    state.outcome[g] = out


@wp.kernel
def step_groups(
    first: int,
    model: Model,
    state: State,
    action: wp.array(dtype=Row),
    terms: wp.array2d(dtype=float),
    observation: wp.array2d(dtype=float),
    flown: wp.array(dtype=IntRow),
    trace: wp.array3d(dtype=float),
    tracing: int,
):
    """One decision step of every lane that still flies, in the groups from `first` on.

    Writes reward `terms [L, M + 2]` (goal, missiles, time), the next `observation [L, 7 + 2 M]`, the number of substeps
    `flown` and, when `tracing`, one row of `trace [L, substeps, 14 + 8 M]` per substep.
    """
    g = first + wp.tid()
    outcome = state.outcome[g]
    began = IntRow()
    for j in range(WIDTH):
        began[j] = wp.where(outcome[j] == FLYING, 1, 0)
        for c in range(state.fate.shape[1] + 2):
            terms[g * WIDTH + j, c] = 0.0
    count = IntRow()
    if total(began) > 0:
        e = state.aircraft[g, 0]
        i = state.aircraft[g, 1]
        turn = action[g]
        command = Row()
        cruise = Row()
        for j in range(WIDTH):
            command[j] = e[HEADING, j] + wp.clamp(turn[j], -HALF_PI, HALF_PI)
            cruise[j] = e[CRUISE, j]
        since = state.since_launch[g]
        for s in range(model.substeps):
            dt = time_steps(model, outcome)
            moved = fly_group(model.evader, e, turns_to(command, e), cruise, dt)
            chaser = fly_group(model.interceptor, i, turns_after(i, e), chase_speeds(model, i, e), dt)
            for j in range(WIDTH):
                count[j] = wp.where(outcome[j] == FLYING, s + 1, count[j])
            outcome = move_missiles(model, state, g, e, moved, outcome, terms)
            outcome = leave_by_gate(model, e, moved, outcome)
            since = launch(model, state, g, moved, chaser, outcome, since + dt)
            e = moved
            i = chaser
            if tracing == 1:
                for j in range(WIDTH):
                    if count[j] == s + 1:
                        write_trace(state, g, j, s, e, i, trace)
        state.since_launch[g] = since
        close_step(model, state, g, e, i, began, outcome, terms)
        observe(model, state, g, observation)
    flown[g] = count
