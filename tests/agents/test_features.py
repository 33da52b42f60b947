"""What the networks see: scaled lengths, sines and cosines, and a flag that no detected missile can imitate."""

from __future__ import annotations

import math

import numpy as np
import pytest

from agents.evasion import EVASION
from agents.features import ObservationFeatures, adapt, stem, subtask_number, unseen_subtasks
from sim.observation import UNLAUNCHED, ObservationLayout

LAYOUT = ObservationLayout((1, 2))
FEATURES = EVASION.features(LAYOUT)
OWN = [50_000.0, -100_000.0, math.pi / 2, 80_000.0, 0.0, math.pi, -math.pi / 2]
OBSERVATION = np.array([[*OWN, 25_000.0, math.pi / 2, *UNLAUNCHED]], np.float32)


def test_hand_computed_features() -> None:
    lengths = [0.5, -1.0, 0.8, 0.5, 0.0]
    sines = [1, 0, 0, -1, 1, 0]
    cosines = [0, 1, -1, 0, 0, 0]
    flags = [1, 0]
    encoded = FEATURES.encode(OBSERVATION)
    assert encoded.shape == (1, FEATURES.size) and encoded.dtype == np.float32
    np.testing.assert_allclose(encoded[0], lengths + sines + cosines + flags, atol=1e-6)


def test_the_default_vector_stays_distinguishable_from_every_missile_in_flight() -> None:
    generator = np.random.default_rng(0)
    flying = np.tile(OBSERVATION, (1000, 1))
    flying[:, 9] = generator.uniform(0.0, 60_000.0, 1000)
    flying[:, 10] = -generator.uniform(-math.pi, math.pi, 1000)
    flying[0, 9:] = (0.0, 0.0)
    flying[1, 9:] = (0.0, math.pi)
    difference = np.abs(FEATURES.encode(flying) - FEATURES.encode(OBSERVATION)).max(axis=1)
    assert difference.min() >= 1.0  # the flag alone
    assert FEATURES.detected(flying)[:, 1].all()


def test_features_are_bounded_for_a_layout_without_missiles_and_with_four() -> None:
    for missiles in ((), (1, 2, 3, 4)):
        layout = ObservationLayout(missiles)
        features = EVASION.features(layout)
        assert features.size == 11 + 4 * len(missiles)
        assert np.isfinite(features.encode(np.zeros((3, layout.size), np.float32))).all()


def test_missing_missiles_are_filled_in_as_undetected() -> None:
    small = ObservationLayout((2,))
    seen = np.array([[*OWN, 9_000.0, 0.25]], np.float32)
    filled = adapt(seen, small, LAYOUT, UNLAUNCHED)
    np.testing.assert_array_equal(filled, np.array([[*OWN, *UNLAUNCHED, 9_000.0, 0.25]], np.float32))
    assert FEATURES.detected(filled).tolist() == [[False, True]]


def test_column_names() -> None:
    assert (stem("r_3"), subtask_number("r_3")) == ("r", 3)
    assert (stem("theta_AA"), subtask_number("theta_AA")) == ("theta_AA", 0)
    assert (stem("phi_exit"), subtask_number("phi_exit")) == ("phi_exit", 0)
    assert unseen_subtasks(ObservationLayout((1,)), ObservationLayout((1, 2, 4))) == (2, 4)


@pytest.mark.parametrize("scale", [1e5, 9e4])
def test_the_digest_changes_with_the_scales(scale: float) -> None:
    other = ObservationFeatures(LAYOUT, (1, 2), {"x": scale, "y": 1e5, "l": 1e5, "r": 5e4}, UNLAUNCHED)
    assert (other.digest == FEATURES.digest) is (scale == 1e5)
