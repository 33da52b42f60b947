"""Fig. 10: a flight is replayed in 3-D, everything where and when it was."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from layouts.scene import FlightScene, build_scene
from sim.trajectory import Trajectory, fly
from sim.world import Fate
from tests.engagements import DRILL, drag, straight, task


class Scene:
    """Stands for a viser scene: every `add_...` gives a handle that remembers what it was given."""

    def __init__(self) -> None:
        self.handles: dict[str, Any] = {}

    def __getattr__(self, verb: str) -> Callable[..., Any]:
        def remember(*unnamed: Any, **given: Any) -> Any:
            name = unnamed[0] if verb.startswith("add_") else verb
            self.handles[name] = SimpleNamespace(**{"name": name, "visible": True, **given})
            return self.handles[name]

        return remember


class Server:
    """Stands for a viser server without a socket."""

    def __init__(self) -> None:
        self.scene = Scene()

    @contextlib.contextmanager
    def atomic(self) -> Iterator[None]:
        yield


FLIGHTS = [fly(task(), act, act.__name__, seed=5, episode=e) for act, e in ((drag, 1), (straight, 1))]


@pytest.fixture
def shown() -> tuple[FlightScene, dict[str, Any]]:
    server: Any = Server()
    scene = build_scene(server, FLIGHTS, ["#4aa3ff", "#ffb84a"])
    return scene, server.scene.handles


def seen(handles: dict[str, Any], end: str) -> list[Any]:
    return [handle for name, handle in sorted(handles.items()) if name.endswith(end)]


@pytest.mark.parametrize("time_s", [0.0, 12.5, 40.0])
def test_aircraft_stand_where_they_were_at_that_time(shown: tuple[FlightScene, dict[str, Any]], time_s: float) -> None:
    scene, handles = shown
    scene.show(time_s)
    apart_km = []
    for flight, evader, interceptor in zip(
        FLIGHTS, seen(handles, "/evader"), seen(handles, "/interceptor"), strict=True
    ):
        at = round(time_s * DRILL.rules.substeps)
        # Both share their battlefield's offset, so their distance along x and y is the recorded one.
        offset = (flight.interceptor.position_m[at] - flight.evader.position_m[at])[:2] / 1e3
        np.testing.assert_allclose((interceptor.position - evader.position)[:2], offset, atol=0.02)
        apart_km.append(evader.position[0] - flight.evader.position_m[at, 0] / 1e3)
    # Two flights, side by side: the battlefields do not overlap.
    assert apart_km[1] - apart_km[0] >= DRILL.battlefield.length_m / 1e3


def test_missiles_are_shown_only_while_they_fly(shown: tuple[FlightScene, dict[str, Any]]) -> None:
    scene, handles = shown
    checked = 0
    for number, flight in enumerate(FLIGHTS):
        for missile in flight.missiles:
            found = seen(handles, f"flight_{number}/missile_{missile.number}")
            assert len(found) == (missile.fate is not Fate.UNLAUNCHED)
            if missile.fate not in (Fate.EVADED, Fate.HIT):
                continue
            for time_s, visible in (
                (missile.launch_s - 1, False),
                (missile.launch_s + 1, True),
                (missile.end_s + 1, False),
            ):
                scene.show(time_s)
                assert found[0].visible == visible
            checked += 1
    assert checked >= 2


def test_the_replay_holds_every_recorded_flight(shown: tuple[FlightScene, dict[str, Any]]) -> None:
    assert len(shown[0].evaders) == len(FLIGHTS)
    flight: Trajectory = FLIGHTS[0]
    assert shown[0].evaders[0].time_s[-1] == pytest.approx(flight.duration_s)
