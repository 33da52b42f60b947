"""Envelopes: where a policy survives, over the range and aspect of a shot or over any two numbers of the scenario."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.envelope_axis import GEOMETRY, Axis, AxisError, varied
from agents.envelope_flights import LANES, Flights, fly_flights
from agents.policy import Act, Policy, bind
from agents.shot import check_acts_on_shot, shot_states, shot_task
from sim.scenario import Scenario
from sim.start import initial_states
from sim.task import Task

Progress = Callable[[int, int], None]
"""Called with (flights decided, flights in all)."""
FloatMap = NDArray[np.float64]
FLIGHTS_LIMIT = 10_000_000


@dataclass(frozen=True)
class Envelope:
    """A map of survival; arrays `[X, Y]`, value i of the x axis and j of the y axis in cell `[i, j]`."""

    policy: str
    scenario: str
    digest: str
    """`Scenario.digest` of the scenario before axes and held numbers changed it."""
    kind: str
    """`shot`: one missile, fired at once, until it is decided. `engagement`: whole engagements of the scenario."""
    missiles: tuple[int, ...]
    """Missiles that are not masked; in the cell with the most of them, if their number is an axis."""
    seed: int
    episodes: int
    """Flights in each cell: episodes 0, 1, ... of the seed, the same in every cell."""
    x: Axis
    y: Axis
    held: Mapping[str, float]
    """What else was set, by name."""
    survived: FloatMap
    """Share of the flights in which the evader was not shot down."""
    exited: FloatMap
    """Share of the flights in which the evader reached the exit."""
    closest_m: FloatMap
    """Mean closest approach of any missile [m], over the flights in which one was fired; NaN when none was."""
    time_s: FloatMap
    """Mean time until the shot or the engagement was decided [s]."""

    def to_json(self) -> dict[str, Any]:
        """Everything as plain JSON values; maps are lists over x of lists over y."""
        axes = {
            key: {"name": axis.name, "unit": axis.unit, "values": list(axis.values)}
            for key, axis in (("x", self.x), ("y", self.y))
        }
        names = ("policy", "scenario", "digest", "kind", "seed", "episodes")
        about = {"study": "envelope"} | {name: getattr(self, name) for name in names}
        maps = {name: values.tolist() for name, values in self._maps().items()}
        more = {"missiles": list(self.missiles), "held": dict(self.held), **axes}
        return about | more | maps | {"boundaries": [dict(row) for row in self.boundaries()]}

    def rows(self) -> Iterator[dict[str, float]]:
        """One row per cell, the columns of the CSV file: both axes, then the maps."""
        maps = self._maps()
        for i, x in enumerate(self.x.values):
            for j, y in enumerate(self.y.values):
                yield {self.x.name: x, self.y.name: y} | {name: float(m[i, j]) for name, m in maps.items()}

    def boundaries(self) -> list[dict[str, float | None]]:
        """Limits of the launch range [m] for every value of the other axis; empty when the range is not mapped.

        `no_escape_from_m`, `no_escape_to_m`: the longest unbroken run of launch ranges at which nobody survives; None
        when somebody survives everywhere. `last_hit_m`: the longest range at which a shot still hits; None when none
        does. All are values of the axis, so as fine as it is.
        """
        if "launch_range_m" not in (self.x.name, self.y.name):
            return []
        along_x = self.x.name == "launch_range_m"
        ranges, other = (self.x, self.y) if along_x else (self.y, self.x)
        survived = self.survived if along_x else self.survived.T
        return [{other.name: value, **_limits(ranges.values, survived[:, j])} for j, value in enumerate(other.values)]

    def _maps(self) -> dict[str, FloatMap]:
        maps = {"survived": self.survived, "closest_m": self.closest_m.round(2), "time_s": self.time_s.round(3)}
        # Within a shot nobody gets to the exit.
        return maps if self.kind == "shot" else {"survived": self.survived, "exited": self.exited, **maps}


def envelope(
    policy: Policy,
    scenario: Scenario,
    x: Axis,
    y: Axis,
    *,
    held: Sequence[Axis] = (),
    masked: Iterable[int] = (),
    episodes: int = 1,
    seed: int = 0,
    threads: int = 1,
    lanes: int = LANES,
    progress: Progress | None = None,
) -> Envelope:
    """Fly a policy in every cell of two axes and map what becomes of it.

    If launch range or aspect is among axes and held values, each flight is one shot (`agents.shot`); what is not given
    of the two is the scenario's launch range and nose-on. Otherwise each is a whole engagement of the cell's scenario.

    Raises:
        AxisError: two axes of one quantity, or a number that has no effect on a shot; or too many flights.
        ScenarioError: a cell whose numbers contradict each other.
        MaskError: a mask that names no missile, or leaves none for a shot.
        PolicyError: the policy cannot see a missile of the task.
    """
    axes = (x, y, *held)
    _check_axes(axes, len(x.values) * len(y.values) * episodes)
    is_shot = any(axis.is_geometry for axis in axes)
    fixed = (_usual_shot(scenario, axes) if is_shot else {}) | {axis.name: axis.values[0] for axis in held}
    places = [fixed | {x.name: a, y.name: b} for a in x.values for b in y.values]
    masked = frozenset(masked)
    parts = list(_parts(policy, scenario, places, masked, is_shot))
    maps = {name: np.empty((len(x.values), len(y.values))) for name in ("survived", "exited", "closest_m", "time_s")}
    decided = 0
    for part in parts:
        told = None if progress is None else partial(_tell, progress, decided, len(places) * episodes)
        flights = _fly(part, episodes, seed, threads=threads, lanes=lanes, shots=is_shot, progress=told)
        decided += len(part.places) * episodes
        for name, values in _averages(flights, episodes).items():
            maps[name].flat[part.cells] = values
    return Envelope(
        policy.name, scenario.name, scenario.digest, "shot" if is_shot else "engagement",
        max((part.task.missiles for part in parts), key=len), seed, episodes, x, y, fixed, **maps,
    )  # fmt: skip


def _check_axes(axes: Sequence[Axis], flights: int) -> None:
    quantities = [axis.quantity for axis in axes]
    twice = next((q for q in quantities if quantities.count(q) > 1), None)
    if twice:
        raise AxisError(f"{twice} is given twice; two axes and what is held must differ")
    if any(axis.is_geometry for axis in axes):
        for axis in axes:
            if not axis.is_geometry:
                check_acts_on_shot(axis.name)
    if not 1 <= flights <= FLIGHTS_LIMIT:
        raise AxisError(f"the study has {flights} flights; legal are 1 to {FLIGHTS_LIMIT}")


def _usual_shot(scenario: Scenario, axes: Sequence[Axis]) -> dict[str, float]:
    given = {axis.quantity for axis in axes}
    usual = {"launch_range_m": scenario.launch.range_m} if "launch_range_m" not in given else {}
    return usual | ({"aspect_deg": 0.0} if "aspect" not in given else {})


@dataclass(frozen=True)
class _Part:
    """Cells that share a scenario and fly in one world."""

    task: Task
    act: Act
    cells: list[int]
    places: list[dict[str, float]]


def _parts(
    policy: Policy, scenario: Scenario, places: list[dict[str, float]], masked: frozenset[int], is_shot: bool
) -> Iterator[_Part]:
    cells: dict[tuple[tuple[str, float], ...], list[int]] = {}
    for cell, place in enumerate(places):
        numbers = tuple((name, value) for name, value in place.items() if name not in GEOMETRY)
        cells.setdefault(numbers, []).append(cell)
    for numbers, members in cells.items():
        changes = dict(numbers)
        task = shot_task(scenario, masked, changes) if is_shot else Task(varied(scenario, changes), masked)
        yield _Part(task, bind(policy, task), members, [places[cell] for cell in members])


def _fly(part: _Part, episodes: int, seed: int, *, shots: bool, **how: Any) -> Flights:
    """The flights of a part, cell by cell and in each by episode."""
    scenario, numbers = part.task.scenario, np.tile(np.arange(episodes), len(part.places))
    if not shots:
        states, order = initial_states(scenario, seed, numbers), np.arange(len(numbers))
    else:
        range_m = np.repeat([place["launch_range_m"] for place in part.places], episodes)
        aspect_rad = np.repeat([_aspect_rad(place) for place in part.places], episodes)
        states = shot_states(scenario, range_m, aspect_rad, seed, numbers)
        # The longest flights first, so that lanes that find nothing more to fly wait for short ones.
        order = np.argsort(-range_m, kind="stable")
    flights = fly_flights(part.task, part.act, states[order], numbers[order], seed=seed, shots=shots, **how)
    back = np.argsort(order)
    return Flights(**{name: values[back] for name, values in vars(flights).items()})


def _aspect_rad(place: Mapping[str, float]) -> float:
    return place["aspect_rad"] if "aspect_rad" in place else math.radians(place["aspect_deg"])


def _averages(flights: Flights, episodes: int) -> dict[str, FloatMap]:
    """Each figure's mean over a cell's episodes, `[cells]`."""
    fired = np.isfinite(flights.closest_m).reshape(-1, episodes)
    closest_m = np.where(fired, flights.closest_m.reshape(-1, episodes), 0.0).sum(axis=1)
    shots = fired.sum(axis=1)
    return {
        "survived": flights.survived.reshape(-1, episodes).mean(axis=1),
        "exited": flights.exited.reshape(-1, episodes).mean(axis=1),
        "closest_m": np.divide(closest_m, shots, out=np.full(len(shots), math.nan), where=shots > 0),
        "time_s": flights.time_s.reshape(-1, episodes).mean(axis=1),
    }


def _limits(ranges_m: Sequence[float], survived: NDArray[np.float64]) -> dict[str, float | None]:
    """The boundaries in survival `[n]` along ascending launch ranges."""
    deadly = np.concatenate([[False], survived == 0.0, [False]])
    begins, ends = np.flatnonzero(deadly[1:] & ~deadly[:-1]), np.flatnonzero(deadly[:-1] & ~deadly[1:])
    hits = np.flatnonzero(survived < 1.0)
    longest = (ends - begins).argmax() if len(begins) else None
    return {
        "no_escape_from_m": None if longest is None else ranges_m[begins[longest]],
        "no_escape_to_m": None if longest is None else ranges_m[ends[longest] - 1],
        "last_hit_m": ranges_m[hits[-1]] if len(hits) else None,
    }


def _tell(progress: Progress, before: int, total: int, done: int) -> None:
    progress(before + done, total)
