"""Recordings hold both flights under their prefixes, on one clock."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from rerun.chunk import RrdReader

from layouts.blueprint import APPLICATION, CLOCK
from tests.layouts.sample import END_S, sample_flight
from workbench.recordings import write_recording


def test_an_application_name_without_a_dot_is_kept_by_rerun() -> None:
    assert "." not in APPLICATION


def test_both_flights_are_there_with_curves_events_and_trails(tmp_path: Path) -> None:
    path = tmp_path / "flights.rrd"
    write_recording(path, {"A": sample_flight(), "B": sample_flight(masked=frozenset({2}))})
    chunks = list(RrdReader(path).stream())
    entities = {str(chunk.entity_path) for chunk in chunks}
    for wanted in ("/a/space/evader", "/b/space/interceptor_tail", "/a/azimuth/missile_2", "/b/range/missile_1"):
        assert wanted in entities
    assert "/b/space/missile_2" not in entities
    assert "/a/events" in entities


def test_the_clock_covers_the_flight(tmp_path: Path) -> None:
    path = tmp_path / "flight.rrd"
    write_recording(path, {"only": sample_flight()})
    tracks = [c for c in RrdReader(path).stream() if str(c.entity_path) == "/a/space/evader" and not c.is_static]
    times = np.concatenate([c.to_record_batch().column(CLOCK).cast("int64").to_numpy() for c in tracks])
    assert times.min() == 0
    assert times.max() <= END_S * 1e9
    assert times.max() > (END_S - 2) * 1e9
