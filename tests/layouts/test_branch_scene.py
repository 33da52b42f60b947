"""A branch in a viser scene: drawn on its original's battlefield, from its moment on, and gone when it is removed."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
import viser

from layouts.battlefield import EXAGGERATION
from layouts.branch_bodies import LiveBodies, Pose
from layouts.branch_scene import add_branch, later
from layouts.motion import KM
from layouts.scene import FlightScene, build_scene
from layouts.theme import BRANCH, DARK, INTERCEPTOR, MISSILES, POLICY_A, POLICY_B
from sim.scenario_file import load_scenario
from sim.world import Fate, Outcome
from tests.layouts.sample import sample_flight
from tests.layouts.test_theme import SIGHTS, _seen

FROM_S = 95.0


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


@pytest.fixture
def scene(server: viser.ViserServer) -> FlightScene:
    return build_scene(server, [sample_flight(), sample_flight()], [POLICY_A, POLICY_B], root="/test")


def _branched(server: viser.ViserServer, scene: FlightScene, outcome: Outcome = Outcome.SHOT_DOWN) -> FlightScene:
    return add_branch(server, scene, 1, sample_flight(outcome=outcome), FROM_S, BRANCH, "dark", "/test/branch")


def test_a_branch_flies_from_its_moment_on_where_its_original_flies(
    server: viser.ViserServer, scene: FlightScene
) -> None:
    branch = _branched(server, scene)
    (evader,) = branch.evaders
    assert evader.time_s[0] == FROM_S
    np.testing.assert_allclose(evader.position(FROM_S), scene.evaders[1].position(FROM_S), atol=1e-9)
    body = next(body for body in branch.bodies if body.mesh.name.endswith("/evader"))
    branch.show(FROM_S - 1.0)
    assert not body.mesh.visible
    branch.show(FROM_S + 1.0)
    assert body.mesh.visible
    np.testing.assert_allclose(body.mesh.position, evader.position(FROM_S + 1.0))


def test_missiles_that_had_ended_before_are_left_out(server: viser.ViserServer, scene: FlightScene) -> None:
    # Missile 1 ended at 90 s.
    names = {body.mesh.name.rpartition("/")[2] for body in _branched(server, scene).bodies}
    assert names == {"evader", "interceptor", "missile_2", "missile_3", "missile_4"}
    assert [track.number for track in later(sample_flight(), FROM_S).missiles] == [2, 3, 4]


def test_removing_its_root_removes_all_of_it_and_nothing_else(server: viser.ViserServer, scene: FlightScene) -> None:
    before = set(server.scene._handle_from_node_name)
    _branched(server, scene)
    server.scene.remove_by_name("/test/branch")
    assert set(server.scene._handle_from_node_name) == before


def test_marks_are_of_what_ends_after_the_moment(server: viser.ViserServer, scene: FlightScene) -> None:
    branch = _branched(server, scene)
    assert all(mark.time_s > FROM_S for mark in branch.marks)
    assert sum(track.fate is Fate.HIT for track in sample_flight(outcome=Outcome.SHOT_DOWN).missiles) == 1
    assert len(branch.marks) == 4  # missiles 2 and 3 evaded, 4 hit, the evader shot down


def _pose(x_m: float) -> Pose:
    return Pose(np.array([x_m, 2e3, 5e3]), 0.0, 0.0, 0.0)


def test_live_bodies_are_placed_and_hidden_when_they_no_longer_fly(server: viser.ViserServer) -> None:
    offset = np.array([7.0, 0.0, 0.0])
    live = LiveBodies(server, "/live", BRANCH, DARK, (load_scenario().battlefield, offset))
    assert live.evader is None
    live.show(10.0, {"evader": _pose(1e3), "missile_2": _pose(3e3)})
    live.show(11.0, {"evader": _pose(2e3)})
    evader, missile = (server.scene._handle_from_node_name[f"/live/{name}"] for name in ("evader", "missile_2"))
    np.testing.assert_allclose(evader.position, [2.0 + 7.0, 2.0, 5e3 * KM * EXAGGERATION])
    assert not missile.visible
    assert live.evader is not None
    np.testing.assert_allclose(live.evader.position(10.5), [1.5 + 7.0, 2.0, 5e3 * KM * EXAGGERATION])


@pytest.mark.parametrize("sight", SIGHTS)
def test_a_branch_is_told_from_policies_and_interceptor_whatever_the_colour_vision(sight: str) -> None:
    own = _seen(BRANCH, SIGHTS[sight])
    for other in (POLICY_A, POLICY_B, INTERCEPTOR):
        assert np.linalg.norm(own - _seen(other, SIGHTS[sight])) > 0.115
    for other in MISSILES[:4]:
        assert np.linalg.norm(own - _seen(other, SIGHTS[sight])) > 0.085
