"""Engagements as files: one format per suffix, and a sentence for every other suffix."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

from sim.errors import SubMasError, UsageError
from sim.trajectory import Trajectory
from workbench.run_files import write_bytes

Encoder = Callable[[Trajectory], bytes]


class ExportError(SubMasError):
    """An engagement cannot be written where it was asked for."""


def check_target(path: Path) -> None:
    """Refuse a file that cannot be written, before the engagement is flown.

    Raises:
        UsageError: the suffix is not one of FORMATS.
        ExportError: the folder does not exist, or the file is a folder.
    """
    suffix_of(path)
    if not path.parent.is_dir():
        raise ExportError(f"--out {path}: there is no folder {path.parent}")
    if path.is_dir():
        raise ExportError(f"--out {path} is a folder; give it another name")


def suffix_of(path: Path) -> str:
    """The legal suffix a file name ends in, the longest if several do.

    Raises:
        UsageError: it ends in none of FORMATS.
    """
    name = path.name.lower()
    found = [suffix for suffix in FORMATS if name.endswith(suffix) and name not in FORMATS]
    if not found:
        given = f"ends in '{path.suffix}'" if path.suffix else "has no suffix"
        raise UsageError(f"--out {path} {given}; legal are {', '.join(sorted(FORMATS))}")
    return max(found, key=len)


def export(flight: Trajectory, path: Path) -> None:
    """Write an engagement in the format its suffix names: the whole file, or none.

    Raises:
        UsageError: the suffix is not one of FORMATS.
        SubMasError: the file cannot be written.
    """
    check_target(path)
    try:
        data = encode(flight, suffix_of(path))
    except OSError as error:
        raise ExportError(f"--out {path} cannot be written: {error.strerror or error}") from error
    write_bytes(path, data)


def encode(flight: Trajectory, suffix: str) -> bytes:
    """An engagement as the content of a file with this suffix, one of FORMATS."""
    return FORMATS[suffix](flight)


def _csv(flight: Trajectory) -> bytes:
    from workbench.flight_table import csv_bytes

    return csv_bytes(flight)


def _parquet(flight: Trajectory) -> bytes:
    from workbench.flight_table import parquet_bytes

    return parquet_bytes(flight)


def _rrd(flight: Trajectory) -> bytes:
    from layouts.captions import caption
    from workbench.recordings import write_recording

    with tempfile.TemporaryDirectory() as folder:
        scratch = Path(folder) / "flight.rrd"
        write_recording(scratch, {caption(flight): flight})
        return scratch.read_bytes()


def _acmi(flight: Trajectory) -> bytes:
    from workbench.acmi import acmi_text

    return acmi_text(flight).encode()


def _zipped_acmi(flight: Trajectory) -> bytes:
    from workbench.acmi import zipped_acmi

    return zipped_acmi(flight)


def _png(flight: Trajectory) -> bytes:
    from layouts.flight_figure import picture

    return picture(flight, "png")


def _svg(flight: Trajectory) -> bytes:
    from layouts.flight_figure import picture

    return picture(flight, "svg")


FORMATS: dict[str, Encoder] = {
    ".csv": _csv,
    ".parquet": _parquet,
    ".rrd": _rrd,
    ".acmi": _acmi,
    ".zip.acmi": _zipped_acmi,
    ".png": _png,
    ".svg": _svg,
}
"""Suffix -> content of the file; `docs/exports.md` tells of them. Encoders import their libraries when asked for."""
