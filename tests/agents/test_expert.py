"""The two experts and chance, on hand-written situations."""

from __future__ import annotations

import math

import numpy as np
import pytest

from agents.expert import DraggingExpert, NavigationExpert, RandomPolicy, drag_turn, wrap_to_pi
from sim.observation import UNLAUNCHED, ObservationLayout

LAYOUT = ObservationLayout((1, 2, 4))


def _observation(exit_azimuth: float, *blocks: tuple[float, float]) -> np.ndarray:
    own = [0.0, 0.0, 0.0, 50_000.0, 0.0, 0.0, exit_azimuth]
    return np.array([[*own, *(number for block in blocks for number in block)]], np.float32)


@pytest.mark.parametrize(("azimuth", "turn"), [(0.3, 0.3), (-0.4, -0.4), (2.0, math.pi / 2), (-3.0, -math.pi / 2)])
def test_navigation_heads_for_the_exit(azimuth: float, turn: float) -> None:
    seen = _observation(azimuth, (5_000.0, 0.1), UNLAUNCHED, UNLAUNCHED)
    assert NavigationExpert().act(seen, LAYOUT).item() == pytest.approx(turn)


@pytest.mark.parametrize(
    ("azimuth", "turn"),
    [
        (math.radians(80), math.radians(-10)),  # on the left, a little ahead: turn right, away from it
        (math.radians(100), math.radians(10)),
        (math.radians(-80), math.radians(10)),
        (math.radians(-100), math.radians(-10)),
        (math.radians(170), math.radians(80)),
        (math.radians(90), 0.0),
    ],
)
def test_dragging_turns_the_closest_missile_to_ninety_degrees_by_the_smaller_turn(azimuth: float, turn: float) -> None:
    seen = _observation(0.5, (20_000.0, 1.0), (9_000.0, azimuth), UNLAUNCHED)
    assert DraggingExpert().act(seen, LAYOUT).item() == pytest.approx(turn, abs=1e-6)


def test_after_the_turn_the_missile_is_at_the_angle() -> None:
    azimuth = np.linspace(-math.pi + 1e-3, math.pi, 101, dtype=np.float32)
    for angle in (math.pi / 2, math.radians(120)):
        after = wrap_to_pi(azimuth - drag_turn(azimuth, angle))
        np.testing.assert_allclose(np.abs(after), angle, atol=1e-5)
        assert np.abs(drag_turn(azimuth, angle)).max() <= max(angle, math.pi - angle) + 1e-5


def test_the_angle_is_a_parameter() -> None:
    seen = _observation(0.5, (20_000.0, math.radians(100)), UNLAUNCHED, UNLAUNCHED)
    expert = DraggingExpert(math.radians(120))
    assert expert.act(seen, LAYOUT).item() == pytest.approx(math.radians(-20), abs=1e-6)
    assert (DraggingExpert().name, expert.name) == ("expert-dragging", "expert-dragging-120")


def test_without_a_missile_in_flight_it_navigates() -> None:
    assert DraggingExpert().act(_observation(0.5, UNLAUNCHED, UNLAUNCHED, UNLAUNCHED), LAYOUT).item() == 0.5
    bare = ObservationLayout(())
    assert DraggingExpert().act(_observation(0.5), bare).item() == 0.5


def test_lanes_do_not_mix() -> None:
    seen = np.concatenate(
        [
            _observation(0.5, UNLAUNCHED, UNLAUNCHED, UNLAUNCHED),
            _observation(0.5, (1_000.0, math.pi / 2), (2_000.0, 0.0), UNLAUNCHED),
        ]
    )
    np.testing.assert_allclose(DraggingExpert().act(seen, LAYOUT), [[0.5], [0.0]], atol=1e-6)


def test_random_turns_are_uniform_and_follow_the_seed() -> None:
    seen = np.zeros((4000, LAYOUT.size), np.float32)
    turns = RandomPolicy(3).act(seen, LAYOUT)
    assert np.abs(turns).max() <= math.pi / 2 and abs(turns.mean()) < 0.05
    assert turns.std() == pytest.approx(math.pi / math.sqrt(12), rel=0.05)
    np.testing.assert_array_equal(turns, RandomPolicy(3).act(seen, LAYOUT))


def test_angles_wrap_into_the_half_open_interval() -> None:
    wrapped = wrap_to_pi(np.array([math.pi, -math.pi, 3 * math.pi / 2, 0.1], np.float32))
    np.testing.assert_allclose(wrapped, [math.pi, math.pi, -math.pi / 2, 0.1], atol=1e-6)
