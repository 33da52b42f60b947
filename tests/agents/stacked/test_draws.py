"""Counted draws: uniform, normal, repeatable, and independent of who else draws."""

from __future__ import annotations

import numpy as np
import torch

from agents.stacked.draws import Purpose, normal, uniform

SEEDS = torch.tensor([2**42 + 1, 2**42 + 2, 7])


def _mixed(z: int) -> int:
    """SplitMix64's output function in whole numbers, as Steele wrote it."""
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) % 2**64
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) % 2**64
    return z ^ (z >> 31)


def test_a_number_is_the_hash_of_seed_purpose_count_and_place() -> None:
    golden, count = 0x9E3779B97F4A7C15, 12
    counts = torch.tensor([0, count, 3])
    drawn = uniform(SEEDS, Purpose.NOISE, counts, (4,))
    key = _mixed((int(SEEDS[1]) + golden * Purpose.NOISE) % 2**64)
    key = _mixed((key + golden * (count + 1)) % 2**64)
    for place in range(4):
        bits = _mixed((key + golden * (place + 1)) % 2**64) >> 11
        assert float(drawn[1, place]) == (bits + 0.5) * 2.0**-53


def test_an_agents_numbers_are_its_own() -> None:
    counts = torch.tensor([5, 5, 5])
    every = uniform(SEEDS, Purpose.SEGMENT, counts, (2, 100))
    alone = uniform(SEEDS[1:2], Purpose.SEGMENT, counts[:1], (2, 100))
    assert torch.equal(every[1:2], alone)
    others = [uniform(SEEDS, Purpose.NOISE, counts, (2, 100)), uniform(SEEDS, Purpose.SEGMENT, counts + 1, (2, 100))]
    numbers = torch.cat([every.flatten(), *(other.flatten() for other in others)])
    assert len(numbers.unique()) == numbers.numel()


def test_uniform_and_normal_numbers_have_their_moments() -> None:
    counts = torch.zeros(3, dtype=torch.int64)
    flat = uniform(SEEDS, Purpose.TRANSITIONS, counts, (60_000,)).numpy()
    assert flat.min() > 0.0 and flat.max() < 1.0
    np.testing.assert_allclose(flat.mean(axis=1), 0.5, atol=0.005)
    np.testing.assert_allclose(flat.var(axis=1), 1 / 12, atol=0.002)
    bell = normal(SEEDS, Purpose.TARGET_NOISE, counts, (60_000,)).numpy()
    np.testing.assert_allclose(bell.mean(axis=1), 0.0, atol=0.015)
    np.testing.assert_allclose(bell.std(axis=1), 1.0, atol=0.01)
    np.testing.assert_allclose((bell**4).mean(axis=1), 3.0, atol=0.15)
    assert np.abs(np.corrcoef(bell)[np.triu_indices(3, 1)]).max() < 0.02
    assert abs(np.corrcoef(bell[0, :-1], bell[0, 1:])[0, 1]) < 0.02
