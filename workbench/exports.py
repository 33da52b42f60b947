"""Engagements as files: one format per suffix, and a sentence for every other suffix."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

from sim.errors import SubMasError, UsageError
from sim.trajectory import Trajectory
from workbench.run_files import write_bytes

Update = Callable[[int, int], None]
"""Called with how much is done and how much there is, by formats that take their time."""

Encoder = Callable[[Sequence[Trajectory], Update], bytes]
"""One flight, or for a format of TOGETHER also others from the same initial state, as the content of a file."""


class ExportError(SubMasError):
    """An engagement cannot be written where it was asked for."""


def check_target(path: Path, flights: int = 1) -> None:
    """Refuse a file that cannot be written, before the engagement is flown.

    Raises:
        UsageError: the suffix is not one of FORMATS, or its format does not hold two flights.
        ExportError: the folder does not exist, or the file is a folder.
        EncoderMissingError: the library of the format is not installed.
    """
    suffix = suffix_of(path)
    if flights > 1 and suffix not in TOGETHER:
        raise UsageError(f"--out {path} holds one flight; two together fit into {', '.join(sorted(TOGETHER))}")
    if suffix == ".mp4":
        from workbench.export_video import check_encoder

        check_encoder()
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


def _silent(_done: int, _total: int) -> None:
    """Tells nobody."""


def export(flight: Trajectory, path: Path, *others: Trajectory, update: Update = _silent) -> None:
    """Write an engagement in the format its suffix names: the whole file, or none.

    Args:
        flight: the engagement.
        path: the file.
        others: from the same initial state, beside the first: a second flight, a branch of either.
        update: is told the progress of formats that take their time.

    Raises:
        UsageError: the suffix is not one of FORMATS, or its format does not hold two flights.
        SubMasError: the file cannot be written.
    """
    check_target(path, 1 + len(others))
    try:
        data = encode(flight, suffix_of(path), *others, update=update)
    except OSError as error:
        raise ExportError(f"--out {path} cannot be written: {error.strerror or error}") from error
    write_bytes(path, data)


def encode(flight: Trajectory, suffix: str, *others: Trajectory, update: Update = _silent) -> bytes:
    """An engagement, and for the formats of TOGETHER others beside it, as the content of a file."""
    return FORMATS[suffix]([flight, *others], update)


def _csv(flights: Sequence[Trajectory], _update: Update) -> bytes:
    from workbench.flight_table import csv_bytes

    return csv_bytes(flights[0])


def _parquet(flights: Sequence[Trajectory], _update: Update) -> bytes:
    from workbench.flight_table import parquet_bytes

    return parquet_bytes(flights[0])


def _rrd(flights: Sequence[Trajectory], _update: Update) -> bytes:
    from layouts.captions import caption
    from layouts.letters import letters
    from workbench.recordings import write_recording

    with tempfile.TemporaryDirectory() as folder:
        scratch = Path(folder) / "flight.rrd"
        named = zip(letters(flights), flights, strict=True)
        write_recording(scratch, {f"{who} · " * bool(who) + caption(flight): flight for who, flight in named})
        return scratch.read_bytes()


def _acmi(flights: Sequence[Trajectory], _update: Update) -> bytes:
    from workbench.acmi.document import acmi_text

    return acmi_text(flights[0]).encode()


def _zipped_acmi(flights: Sequence[Trajectory], _update: Update) -> bytes:
    from workbench.acmi.document import zipped_acmi

    return zipped_acmi(flights[0])


def _png(flights: Sequence[Trajectory], _update: Update) -> bytes:
    from layouts.flight_figure import picture

    return picture(flights[0], "png")


def _svg(flights: Sequence[Trajectory], _update: Update) -> bytes:
    from layouts.flight_figure import picture

    return picture(flights[0], "svg")


def _html(flights: Sequence[Trajectory], _update: Update) -> bytes:
    from workbench.replay_page import replay_page

    return replay_page(flights)


def _gif(flights: Sequence[Trajectory], update: Update) -> bytes:
    from workbench.export_video import gif_bytes

    return gif_bytes(flights, update)


def _mp4(flights: Sequence[Trajectory], update: Update) -> bytes:
    from workbench.export_video import mp4_bytes

    return mp4_bytes(flights, update)


FORMATS: dict[str, Encoder] = {
    ".html": _html,
    ".gif": _gif,
    ".mp4": _mp4,
    ".csv": _csv,
    ".parquet": _parquet,
    ".rrd": _rrd,
    ".acmi": _acmi,
    ".zip.acmi": _zipped_acmi,
    ".png": _png,
    ".svg": _svg,
}
"""Suffix -> content of the file; `docs/exports.md` tells of them. Encoders import their libraries when asked for."""

TOGETHER = frozenset({".html", ".gif", ".mp4", ".rrd"})
"""Formats that hold several flights on one clock."""
