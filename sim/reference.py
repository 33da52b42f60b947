"""The world a second time, to be read: the executable specification that the kernel is checked against.

Vectorised over lanes in float64 NumPy: up to a hundred times slower with one lane, five to ten times with thousands.
It shares the scenario, the initial states and the types of `sim.world` with the kernel, and no code that flies.
"""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.observation import UNLAUNCHED
from sim.reference_physics import (
    AircraftState,
    Array,
    MissileState,
    bearing,
    closest_approach,
    dot,
    flight_velocity,
    fly_aircraft,
    fly_missile,
    length,
    put,
    take,
    wrap,
)
from sim.scenario import Missile, Scenario, Sensor
from sim.sensor import sense
from sim.start import initial_states
from sim.task import Task
from sim.world import Fate, Outcome, Step, World

EVADER, INTERCEPTOR = 0, 1
HELD = ("held_altitude", "held_speed")
"""What the controllers of both aircraft hold, as `sim.world.World.aircraft` names it."""
SHOTS = ("reach", "interval", "thrust", "drag", "navigation", "lag")
"""Factors drawn for every shot, in the order of the blocks of `sim.start.initial_states`."""


class ReferenceWorld:
    """L lanes of a task with the interface of `sim.world.World`: `reset`, `step`, and what they leave.

    Arrays have a leading axis of lanes `[L, ...]`; both aircraft are side by side `[L, 2, ...]`, evader first.
    """

    def __init__(self, task: Task, lanes: int, seed: int = 0) -> None:
        """Start episodes 0 to `lanes` - 1 of a task."""
        self.task, self.lanes, self.seed = task, lanes, seed
        missiles = task.scenario.launch.missiles
        speed, climb, heading, bank = np.zeros((4, lanes, 2))
        self.aircraft = AircraftState(np.zeros((lanes, 2, 3)), speed, climb, heading, bank)
        position, velocity, lateral = np.zeros((3, lanes, missiles, 3))
        self.missile = MissileState(position, velocity, lateral, age=np.zeros((lanes, missiles)))
        self.fate = np.zeros((lanes, missiles), np.int32)
        self.closest = np.zeros((lanes, missiles))
        self.shot = {name: np.ones((lanes, missiles)) for name in SHOTS}
        self.held_altitude, self.held_speed = np.zeros((2, lanes, 2))
        self.waited = np.zeros(lanes, np.int64)  # substeps since the last launch
        self.steps, self.outside, self.outcome, self.killer = np.zeros((4, lanes), np.int32)
        self._fleet = _side_by_side(task.scenario)
        self._armed = np.array([m in task.missiles for m in range(1, missiles + 1)])
        self._dt = task.scenario.rules.step_s / task.scenario.rules.substeps
        self._order = np.cumsum(self._armed) - self._armed  # which shot an armed missile is
        self.episode, self._next_episode = np.zeros(lanes, np.int64), 0
        self.reset()

    def reset(self, lanes: ArrayLike | None = None, episodes: ArrayLike | None = None) -> NDArray[np.float32]:
        """Start lanes (all by default) with numbered episodes (the next unused by default); every observation."""
        chosen = np.arange(self.lanes)[slice(None) if lanes is None else np.asarray(lanes)]
        if episodes is None:
            episodes = self._next_episode + np.arange(len(chosen))
            self._next_episode += len(chosen)
        if len(chosen):
            self.episode[chosen] = episodes
            self._start(chosen, initial_states(self.task.scenario, self.seed, np.asarray(episodes)).astype(float))
        return self.observation

    def step(self, actions: ArrayLike) -> Step:
        """Fly one decision step with turning angles `[L]` or `[L, 1]` [rad] in every lane that has not ended."""
        turn = np.clip(np.asarray(actions, dtype=float).reshape(self.lanes), -np.pi / 2, np.pi / 2)
        flying = self.outcome == Outcome.FLYING
        command = self.aircraft.heading[:, EVADER] + turn
        terms = np.zeros((self.lanes, len(self._armed) + 2))
        for _ in range(self.task.scenario.rules.substeps):
            self._substep(command, terms)
        self._finish(flying, terms)
        ended = flying & (self.outcome != Outcome.FLYING)
        truncated = ended & (self.outcome == Outcome.TIMEOUT)
        return Step(self.observation, terms.astype(np.float32), ended & ~truncated, truncated)

    @classmethod
    def taking_over(cls, world: World) -> ReferenceWorld:
        """A reference in the very state that a world is in now: comparisons may begin in the middle of a flight."""
        taken = cls(world.task, world.lanes, world.seed)
        state, dt = world.state(), taken._dt
        for bodies, rows in ((taken.aircraft, world.aircraft), (taken.missile, world.missiles)):
            for field in dataclasses.fields(bodies):
                setattr(bodies, field.name, rows[field.name].astype(float))
        taken.missile.age = np.round(np.round(taken.missile.age / dt) * dt, 9)
        for name in ("fate", "steps", "outside", "outcome", "killer", "episode"):
            setattr(taken, name, state[name])
        taken.closest = world.closest.astype(float)
        taken.held_altitude, taken.held_speed = (world.aircraft[name].astype(float) for name in HELD)
        taken.waited = np.round(state["since_launch"] / dt).astype(np.int64)
        rows = initial_states(world.task.scenario, world.seed, taken.episode).astype(float)
        taken._draw(np.arange(world.lanes), rows)
        return taken

    @property
    def observation(self) -> NDArray[np.float32]:
        """Table 1 in the task's layout `[L, d]`: metres and radians from the evader's view."""
        place, heading = self.aircraft.position, self.aircraft.heading
        here, own_heading = place[:, EVADER], heading[:, EVADER]
        to_interceptor = place[:, INTERCEPTOR] - here
        field = self.task.scenario.battlefield
        to_exit = np.array([field.length_m / 2, field.exit_y_m, 0.0]) - here
        own = (here[:, 0], here[:, 1], own_heading, length(to_interceptor),
               wrap(bearing(to_interceptor) - heading[:, INTERCEPTOR]),  # theta_AA, 0 when the interceptor flees
               wrap(bearing(to_interceptor) - own_heading),
               wrap(bearing(to_exit) - own_heading))  # fmt: skip
        to_missile = self.missile.position - here[:, None]
        seen = np.stack((length(to_missile), wrap(bearing(to_missile) - own_heading[:, None])), axis=-1)
        blocks = np.where((self.fate == Fate.FLYING)[..., None], seen, UNLAUNCHED)[:, self._armed]
        truth = np.column_stack((*own, blocks.reshape(self.lanes, -1))).astype(np.float32)
        sensor, age_s = self.task.scenario.sensor, self.missile.age[:, self._armed]
        return truth if sensor == Sensor() else sense(sensor, self.seed, self.episode, self.steps, age_s, truth)

    def _start(self, lanes: NDArray[np.intp], start: Array) -> None:
        """Put lanes to rows x, y, altitude, heading, speed of both aircraft and the draws of the shots."""
        sides = start[:, :10].reshape(-1, 2, 5)
        level = np.zeros((len(lanes), 2))
        put(self.aircraft, lanes, AircraftState(sides[..., :3], sides[..., 4], level, wrap(sides[..., 3]), level))
        self.held_altitude[lanes], self.held_speed[lanes] = sides[..., 2], sides[..., 4]
        self._draw(lanes, start)
        self.fate[lanes], self.closest[lanes] = Fate.UNLAUNCHED, np.inf
        self.waited[lanes] = np.iinfo(np.int64).max // 2  # the first missile need not wait
        for counter in (self.steps, self.outside, self.outcome, self.killer):
            counter[lanes] = 0

    def _draw(self, lanes: NDArray[np.intp], start: Array) -> None:
        """Give every missile the draws of the shot that it will be."""
        blocks = start[:, 10:].reshape(len(lanes), len(SHOTS), -1)
        for name, block in zip(SHOTS, np.moveaxis(blocks, 1, 0), strict=True):
            self.shot[name][lanes] = block[:, np.minimum(self._order, len(self._order) - 1)]

    def _substep(self, command: Array, terms: Array) -> None:
        """Everything moves at once from where it was; then the exit is judged, then the interceptor may fire."""
        on = np.flatnonzero(self.outcome == Outcome.FLYING)
        before = take(self.aircraft, on)
        chase = before.position[:, EVADER] - before.position[:, INTERCEPTOR]
        heading = np.column_stack((command[on], bearing(chase)))
        speed = self.held_speed[on]
        # An interceptor that is too close to fire falls back.
        slow = np.minimum(speed[:, INTERCEPTOR], before.speed[:, EVADER] - 20.0)
        speed[:, INTERCEPTOR] = np.where(
            length(chase) < self.task.scenario.launch.range_min_m, slow, speed[:, INTERCEPTOR]
        )
        after = fly_aircraft(before, self._fleet, heading, self.held_altitude[on], speed, self._dt)
        if (self.fate[on] == Fate.FLYING).any():
            self._move_missiles(on, take(before, (slice(None), EVADER)), after.position[:, EVADER], terms)
        put(self.aircraft, on, after)
        through = self._through_gate(before.position[:, EVADER], after.position[:, EVADER])
        self.outcome[on[through & (self.outcome[on] == Outcome.FLYING)]] = Outcome.EXIT
        self._launch()

    def _move_missiles(self, on: NDArray[np.intp], evader: AircraftState, evader_after: Array, terms: Array) -> None:
        """Fly the missiles of lanes `on`; each hits, is evaded, or flies on. A hit ends it all for higher numbers."""
        row, k = np.nonzero(self.fate[on] == Fate.FLYING)
        lane, model, reward = on[row], self.task.scenario.missile, self.task.scenario.reward
        old = take(self.missile, (lane, k))
        drawn = self._varied(model, lane, k)
        new = fly_missile(old, drawn, evader.position[row], flight_velocity(evader)[row], self._dt)
        offset = evader_after[row] - new.position
        miss = closest_approach(evader.position[row] - old.position, offset)
        hit = (miss <= model.fuse_m) & (new.age >= model.arm_s)
        hits = np.zeros((len(on), len(self._armed)), dtype=int)
        hits[row, k] = hit
        moves = (hits.cumsum(axis=1) - hits)[row, k] == 0
        lane, k, hit, miss, offset, new = (
            lane[moves],
            k[moves],
            hit[moves],
            miss[moves],
            offset[moves],
            take(new, moves),
        )
        put(self.missile, (lane, k), new)
        self.closest[lane, k] = np.minimum(self.closest[lane, k], miss)
        evaded = ~hit & self._spent(new, length(offset), self.closest[lane, k])
        self.fate[lane[hit], k[hit]], self.fate[lane[evaded], k[evaded]] = Fate.HIT, Fate.EVADED
        self.outcome[lane[hit]], self.killer[lane[hit]] = Outcome.SHOT_DOWN, k[hit] + 1
        terms[lane, 1 + k] += np.where(hit, reward.shot_down, np.where(evaded, reward.evaded, 0.0))

    def _varied(self, model: Missile, lane: NDArray[np.intp], k: NDArray[np.intp]) -> Any:
        """The missile's numbers as drawn for some shots, each an array `[n]` where it varies."""
        factor = {name: values[lane, k] for name, values in self.shot.items()}
        numbers: dict[str, Any] = {
            "thrust_n": model.thrust_n * factor["thrust"],
            "cd0": model.cd0 * factor["drag"],
            "navigation_constant": model.navigation_constant * factor["navigation"],
            "lag_s": model.lag_s * factor["lag"],
        }
        return dataclasses.replace(model, **numbers)

    def _spent(self, missile: MissileState, distance: Array, closest: Array) -> NDArray[np.bool_]:
        """Whether missiles `[n]` are too slow, too old, or opening again after their closest approach."""
        model = self.task.scenario.missile
        slow = (missile.age > model.burn_s) & (length(missile.velocity) < model.speed_min_m_s)
        opening = (missile.age > model.arm_s) & (distance > closest + model.opening_m)
        return slow | opening | (missile.age > model.age_max_s)

    def _through_gate(self, before: Array, after: Array) -> NDArray[np.bool_]:
        """Whether moves `[n, 3]` cross the right edge outwards within the gate."""
        field = self.task.scenario.battlefield
        edge = field.length_m / 2
        crosses = (before[:, 0] < edge) & (after[:, 0] >= edge)
        share = (edge - before[:, 0]) / np.where(crosses, after[:, 0] - before[:, 0], 1.0)
        y = before[:, 1] + share * (after[:, 1] - before[:, 1])
        return crosses & (np.abs(y - field.exit_y_m) <= field.exit_half_width_m)

    def _launch(self) -> None:
        """Fire the lowest missile left when the interval has passed and the evader is in its launch zone."""
        self.waited += 1
        left = (self.fate == Fate.UNLAUNCHED) & self._armed
        lane = np.flatnonzero((self.outcome == Outcome.FLYING) & left.any(axis=1))
        k = left[lane].argmax(axis=1)
        interval = self.task.scenario.launch.interval_s * self.shot["interval"][lane, k]
        zone = (self.waited[lane] >= np.ceil(interval / self._dt - 1e-3)) & self._in_zone(lane, k)
        lane, k = lane[zone], k[zone]
        carrier = take(self.aircraft, (lane, INTERCEPTOR))
        still = np.zeros((len(lane), 3))
        fired = MissileState(carrier.position, flight_velocity(carrier), still, np.zeros(len(lane)))
        put(self.missile, (lane, k), fired)
        self.closest[lane, k] = length(self.aircraft.position[lane, EVADER] - carrier.position)
        self.fate[lane, k], self.waited[lane] = Fate.FLYING, 0

    def _in_zone(self, lane: NDArray[np.intp], k: NDArray[np.intp]) -> NDArray[np.bool_]:
        """Radar, field of view, and a range that grows with the cosine from tail chase to head-on."""
        launch = self.task.scenario.launch
        evader, interceptor = (take(self.aircraft, (lane, side)) for side in (EVADER, INTERCEPTOR))
        offset = evader.position - interceptor.position
        distance = length(offset)
        head_on = 0.5 - 0.5 * dot(flight_velocity(evader), offset) / (evader.speed * distance)
        aspect = launch.tail_fraction + (1.0 - launch.tail_fraction) * head_on
        reach = np.minimum(launch.radar_range_m, launch.range_m * self.shot["reach"][lane, k] * aspect)
        off_nose = np.abs(wrap(bearing(offset) - interceptor.heading))
        return (distance >= launch.range_min_m) & (distance <= reach) & (off_nose <= launch.radar_half_angle_rad)

    def _finish(self, flying: NDArray[np.bool_], terms: Array) -> None:
        """Rules of the decision step: time passes, the exit pays, who stays outside is lost, the step limit."""
        scenario, place = self.task.scenario, self.aircraft.position[:, EVADER]
        half = np.array([scenario.battlefield.length_m, scenario.battlefield.width_m]) / 2
        self.steps += flying
        inside = (np.abs(place[:, :2]) <= half).all(axis=1)
        self.outside = np.where(flying, np.where(inside, 0, self.outside + 1), self.outside)
        still = self.outcome == Outcome.FLYING
        left = still & (self.outside > scenario.rules.outside_steps)
        late = still & ~left & (self.steps >= scenario.rules.max_steps)
        self.outcome[left], self.outcome[late] = Outcome.LEFT_FIELD, Outcome.TIMEOUT
        terms[flying, -1] = scenario.reward.step
        terms[flying & (self.outcome == Outcome.EXIT), 0] = scenario.reward.exit
        terms[left, 0] = scenario.reward.shot_down


def _side_by_side(scenario: Scenario) -> Any:
    """The numbers of both aircraft in one `Aircraft`, each an array `[2]`."""
    sides = (dataclasses.asdict(scenario.evader), dataclasses.asdict(scenario.interceptor))
    arrays: dict[str, Any] = {name: np.array([side[name] for side in sides]) for name in sides[0]}
    return dataclasses.replace(scenario.evader, **arrays)
