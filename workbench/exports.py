"""Engagements as files: one writer per suffix, and a sentence for every other suffix."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from sim.errors import SubMasError, UsageError
from sim.trajectory import BodyTrack, MissileTrack, Trajectory
from workbench.run_files import write_bytes

Columns = dict[str, NDArray[np.float64]]


class ExportError(SubMasError):
    """An engagement cannot be written where it was asked for."""


def check_target(path: Path) -> None:
    """Refuse a file that cannot be written, before the engagement is flown.

    Raises:
        UsageError: the suffix is not one of WRITERS.
        ExportError: the folder does not exist.
    """
    if path.suffix.lower() not in WRITERS:
        given = f"ends in '{path.suffix}'" if path.suffix else "has no suffix"
        raise UsageError(f"--out {path} {given}; legal are {', '.join(sorted(WRITERS))}")
    if not path.parent.is_dir():
        raise ExportError(f"--out {path}: there is no folder {path.parent}")


def export(flight: Trajectory, path: Path) -> None:
    """Write an engagement in the format its suffix names.

    Raises:
        ExportError: the file cannot be written.
    """
    check_target(path)
    try:
        WRITERS[path.suffix.lower()](flight, path)
    except OSError as error:
        raise ExportError(f"--out {path} cannot be written: {error.strerror or error}") from error


def table(flight: Trajectory) -> Columns:
    """Columns `[T]` by name, one value per recorded instant; NaN while a missile does not fly."""
    columns: Columns = {"time_s": flight.time_s}
    columns |= _body("evader", flight.evader) | _body("interceptor", flight.interceptor)
    for missile in flight.missiles:
        columns |= _missile(missile)
    # Actions and rewards belong to whole decision steps: each instant shows those of the step it lies in.
    step = np.clip(np.searchsorted(flight.step_time_s, flight.time_s, side="right") - 1, 0, len(flight.action_rad) - 1)
    columns["action_rad"] = flight.action_rad[step]
    columns["reward"] = flight.reward_terms.sum(axis=1)[step]
    return columns


def _body(name: str, track: BodyTrack) -> Columns:
    places = {f"{name}_{axis}_m": track.position_m[:, i] for i, axis in enumerate("xyz")}
    angles = {f"{name}_{kind}_rad": getattr(track, f"{kind}_rad") for kind in ("heading", "pitch", "bank")}
    return places | angles | {f"{name}_speed_m_s": track.speed_m_s}


def _missile(track: MissileTrack) -> Columns:
    name = f"missile_{track.number}"
    places = {f"{name}_{axis}_m": track.position_m[:, i] for i, axis in enumerate("xyz")}
    kinds = ("heading_rad", "pitch_rad", "speed_m_s", "range_m", "azimuth_rad")
    return places | {f"{name}_{kind}": getattr(track, kind) for kind in kinds}


def _write_csv(flight: Trajectory, path: Path) -> None:
    columns = table(flight)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(columns)
    for row in zip(*columns.values(), strict=True):
        writer.writerow("" if np.isnan(value) else f"{value:.9g}" for value in row)
    write_bytes(path, text.getvalue().encode())


def _write_rrd(flight: Trajectory, path: Path) -> None:
    from workbench.recordings import write_recording

    write_recording(path, {flight.policy: flight})


WRITERS: dict[str, Callable[[Trajectory, Path], None]] = {".csv": _write_csv, ".rrd": _write_rrd}
"""Suffix -> writer."""
