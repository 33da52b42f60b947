"""The 3-D replay: bodies point where they fly, come and go, and marks stay."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
import viser

from layouts.battlefield import EXAGGERATION
from layouts.meshes import Mesh, aircraft, missile
from layouts.motion import motion, quaternions
from layouts.scene import build_scene
from layouts.theme import POLICY_A, POLICY_B
from sim.world import Outcome
from tests.layouts.sample import sample_flight


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


def _turn(wxyz: np.ndarray, vector: tuple[float, float, float]) -> np.ndarray:
    w, axis, v = wxyz[0], wxyz[1:], np.array(vector)
    return v + 2 * np.cross(axis, np.cross(axis, v) + w * v)


@pytest.mark.parametrize("mesh", [aircraft(), missile()])
def test_meshes_are_about_one_unit_long_nose_first(mesh: Mesh) -> None:
    assert mesh.vertices[:, 0].max() == pytest.approx(0.5)
    assert mesh.vertices[:, 0].min() > -0.6
    assert mesh.faces.max() < len(mesh.vertices)


def test_attitudes_turn_the_nose_left_and_up_and_the_left_wing_down() -> None:
    quarter = np.pi / 2
    left, up, bank = quaternions(np.array([quarter, 0, 0]), np.array([0, quarter, 0]), np.array([0, 0, quarter]))
    assert _turn(left, (1, 0, 0)) == pytest.approx([0, 1, 0], abs=1e-9)
    assert _turn(up, (1, 0, 0)) == pytest.approx([0, 0, 1], abs=1e-9)
    assert _turn(bank, (0, 1, 0)) == pytest.approx([0, 0, -1], abs=1e-9)


def test_a_motion_is_in_kilometres_with_exaggerated_altitude() -> None:
    flight = sample_flight()
    path = motion(flight.evader, flight.time_s, 4.0, np.array([1000.0, 0.0, 0.0]))
    assert path.position(0.0) == pytest.approx([900.0, 0.0, 28.0])
    assert path.position(2.0) == pytest.approx([900.5, 0.0, 28.0])
    assert path.tail(100.0, 40.0, 5).shape == (4, 2, 3)
    assert path.tail(100.0, 40.0, 5)[-1, 1] == pytest.approx(path.position(100.0))


def test_missiles_are_seen_only_while_they_fly(server: viser.ViserServer) -> None:
    scene = build_scene(server, [sample_flight()], [POLICY_A])
    missile_1 = next(body for body in scene.bodies if body.mesh.name.endswith("missile_1"))
    seen = []
    for time in (0.0, 60.0, 100.0):
        scene.show(time)
        seen.append(missile_1.mesh.visible)
    assert seen == [False, True, False]


def test_a_shot_down_evader_disappears_and_leaves_a_mark(server: viser.ViserServer) -> None:
    scene = build_scene(server, [sample_flight(outcome=Outcome.SHOT_DOWN)], [POLICY_A])
    evader = next(body for body in scene.bodies if body.mesh.name.endswith("evader"))
    scene.show(201.0)
    assert not evader.mesh.visible
    assert all(mark.handle.visible for mark in scene.marks if not mark.is_label)
    scene.show(0.0)
    assert evader.mesh.visible
    assert not any(mark.handle.visible for mark in scene.marks)


def test_two_flights_are_side_by_side_or_on_one_field(server: viser.ViserServer) -> None:
    flights = [sample_flight(), sample_flight(masked=frozenset({4}))]
    apart = build_scene(server, flights, [POLICY_A, POLICY_B], "light", root="/one")
    together = build_scene(server, flights, [POLICY_A, POLICY_B], overlay=True, root="/two")
    assert apart.width_km > 2 * together.width_km
    gap = apart.evaders[1].position(0.0) - apart.evaders[0].position(0.0)
    assert gap[0] > flights[0].task.scenario.battlefield.length_m / 1e3
    assert together.evaders[1].position(0.0) == pytest.approx(together.evaders[0].position(0.0))


def test_bodies_are_where_the_flight_says(server: viser.ViserServer) -> None:
    flight = sample_flight()
    scene = build_scene(server, [flight], [POLICY_A])
    scene.show(50.0)
    evader = next(body for body in scene.bodies if body.mesh.name.endswith("evader"))
    place = flight.evader.position_m[500] / 1e3 * (1.0, 1.0, EXAGGERATION)
    assert np.asarray(evader.mesh.position) == pytest.approx(place, abs=1e-3)
