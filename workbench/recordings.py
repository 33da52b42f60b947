"""Rerun recordings (`.rrd`) of flights, written when somebody asks; a cache, as the format changes by release."""

from __future__ import annotations

import hashlib
import importlib.metadata
import os
import tempfile
from collections.abc import Mapping
from pathlib import Path

from layouts.letters import evader_inks
from sim.trajectory import Trajectory
from workbench.cache_folder import cache_folder, keep_newest

PREFIXES = "abcdefgh"
"""Entities of the first flight are under `/a`, of the second under `/b`, and so on."""

FORM = 2
"""Counts changes of what is written of a flight, so that no older file is taken for a new one."""

KEPT = 64
"""Recordings kept in the cache (about 1.5 MB each); the oldest go first."""


class Recordings:
    """The cache folder of one user. Names are made from what a recording holds, so equal flights share one file."""

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = folder or cache_folder() / "rrd"

    def compare(self, flights: Mapping[str, Trajectory]) -> str:
        """Name of the recording that shows these flights side by side on one clock, written if there is none.

        Args:
            flights: each flight by its caption, left to right; at most eight.
        """
        name = f"flights-{_digest(flights)}.rrd"
        path = self.folder / name
        if path.is_file():
            os.utime(path)  # the oldest files are those nobody looked at
            return name
        self.folder.mkdir(parents=True, exist_ok=True)
        handle, scratch = tempfile.mkstemp(dir=self.folder, suffix=".tmp")
        os.close(handle)
        try:
            write_recording(Path(scratch), flights)
            os.replace(scratch, path)
        finally:
            Path(scratch).unlink(missing_ok=True)
        keep_newest(self.folder, "flights-*.rrd", KEPT)
        return name


def write_recording(path: Path, flights: Mapping[str, Trajectory]) -> None:
    """Write flights, by their captions, into one recording that opens side by side; 0.1 s a flight.

    Raises:
        OSError: the file cannot be written.
    """
    import rerun as rr

    from layouts.battlefield import drawing_scale
    from layouts.blueprint import APPLICATION, compare_blueprint, log_flight

    with path.open("wb"):  # Rerun only warns when it cannot write
        pass
    titles = dict(zip(PREFIXES, flights, strict=False))
    longest_s = max(flight.duration_s for flight in flights.values())
    scale = max(drawing_scale(flight.task.scenario.battlefield) for flight in flights.values())
    recording = rr.RecordingStream(APPLICATION, recording_id=_digest(flights))
    recording.save(path)
    # Active, not only the default: a viewer that shows other flights would keep their views and titles.
    recording.send_blueprint(compare_blueprint(titles, longest_s, scale), make_active=True, make_default=True)
    for (prefix, title), ink in zip(titles.items(), evader_inks(list(flights.values())), strict=False):
        log_flight(recording, prefix, flights[title], ink)
    recording.flush()
    recording.disconnect()


def _digest(flights: Mapping[str, Trajectory]) -> str:
    seal = hashlib.sha256(f"{importlib.metadata.version('rerun-sdk')}|{FORM}".encode())
    for title, flight in flights.items():
        seal.update(f"|{title}|{flight.task.scenario.digest}|{sorted(flight.task.masked)}|".encode())
        seal.update(flight.evader.position_m.tobytes())
        for track in flight.missiles:
            seal.update(track.position_m.tobytes())
    return seal.hexdigest()[:20]
