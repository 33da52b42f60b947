"""The cache of recordings: one file per content, never half a file, never too many."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from sim.world import Outcome
from tests.layouts.sample import sample_flight
from workbench import recordings
from workbench.recordings import Recordings, write_recording


@pytest.fixture
def cache(tmp_path: Path) -> Recordings:
    return Recordings(tmp_path / "rrd")


def test_equal_flights_share_one_recording(cache: Recordings) -> None:
    names = {cache.compare({"A": sample_flight(), "B": sample_flight()}) for _ in range(2)}
    assert len(names) == 1
    assert [path.name for path in cache.folder.iterdir()] == list(names)
    assert (cache.folder / names.pop()).read_bytes()[:4] == b"RRF2"


def test_another_flight_mask_or_caption_is_another_recording(cache: Recordings) -> None:
    flights = [sample_flight(), sample_flight(outcome=Outcome.SHOT_DOWN, masked=frozenset({1}))]
    names = {cache.compare({"A": flight}) for flight in flights} | {cache.compare({"other": flights[0]})}
    assert len(names) == 3


def test_the_oldest_recordings_make_room(cache: Recordings, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recordings, "KEPT", 2)
    names = []
    for age, missile in enumerate((1, 2, 3)):
        names.append(cache.compare({"A": sample_flight(masked=frozenset({missile}))}))
        os.utime(cache.folder / names[-1], (1000.0 + age, 1000.0 + age))
    assert not (cache.folder / names[0]).exists()
    assert (cache.folder / names[2]).exists()


def test_looking_at_a_recording_keeps_it(cache: Recordings) -> None:
    name = cache.compare({"A": sample_flight()})
    os.utime(cache.folder / name, (1000.0, 1000.0))
    cache.compare({"A": sample_flight()})
    assert (cache.folder / name).stat().st_mtime > 2000.0


def test_a_recording_that_fails_leaves_nothing_behind(cache: Recordings, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(*_arguments: object) -> None:
        raise OSError("disk full")

    monkeypatch.setattr(recordings, "write_recording", fail)
    with pytest.raises(OSError, match="disk full"):
        cache.compare({"A": sample_flight()})
    assert list(cache.folder.iterdir()) == []


def test_an_impossible_place_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(OSError):
        write_recording(tmp_path / "no" / "such.rrd", {"A": sample_flight()})
