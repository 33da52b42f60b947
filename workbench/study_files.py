"""A study as a file: JSON, a CSV row per cell, or a picture."""

from __future__ import annotations

import csv
import io
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from sim.errors import UsageError
from workbench.exports import ExportError
from workbench.run_files import strict, write_bytes

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from agents.envelope import Envelope


def check_study_file(path: Path) -> None:
    """Refuse a file that cannot be written, before anything is flown.

    Raises:
        UsageError: the suffix is not one of `FORMATS`.
        ExportError: the folder does not exist, or the file is a folder.
    """
    if path.suffix.lower() not in FORMATS:
        given = f"ends in '{path.suffix}'" if path.suffix else "has no suffix"
        raise UsageError(f"--out {path} {given}; legal are {', '.join(FORMATS)}")
    if not path.parent.is_dir():
        raise ExportError(f"--out {path}: there is no folder {path.parent}")
    if path.is_dir():
        raise ExportError(f"--out {path} is a folder; give it another name")


def write_study(study: Envelope, path: Path) -> None:
    """Write a study in the format its suffix names, the whole file or none; equal studies give equal bytes.

    Raises:
        UsageError: the suffix is not one of `FORMATS`.
        SubMasError: the file cannot be written.
    """
    check_study_file(path)
    write_bytes(path, FORMATS[path.suffix.lower()](study))


def envelope_figure(study: Envelope) -> Figure:
    """The map drawn: polar for launch range and aspect, else a rectangle."""
    from layouts.envelope import Scale, grid_map, polar_map

    words = title(study), caption(study)
    by_quantity = {axis.quantity: axis for axis in (study.x, study.y)}
    if set(by_quantity) == {"launch_range_m", "aspect"}:
        aspect = by_quantity["aspect"]
        survived = study.survived if study.y is aspect else study.survived.T
        values = np.array(aspect.values)
        angles = np.radians(values) if aspect.name == "aspect_deg" else values
        return polar_map(np.array(by_quantity["launch_range_m"].values), angles, survived, *words)
    x, y = (Scale(axis.label, axis.unit, axis.values) for axis in (study.x, study.y))
    return grid_map(x, y, study.survived, *words)


def title(study: Envelope) -> str:
    """What the map shows, in words."""
    what = "one missile" if study.kind == "shot" else "whole engagements"
    return f"Where {study.policy} survives {what}"


def caption(study: Envelope) -> str:
    """What was flown, in two lines: scenario and missiles, cells and flights."""
    numbers = ", ".join(map(str, study.missiles)) or "none"
    missiles = f"missile{'s' * (len(study.missiles) != 1)} {numbers}"
    held = "".join(f", {name} = {value:g}" for name, value in study.held.items())
    flights = f"{study.episodes} flight{'s' * (study.episodes != 1)} each, seed {study.seed}"
    cells = f"{study.x.name} × {study.y.name}: {len(study.x.values)} × {len(study.y.values)} cells"
    return f"scenario {study.scenario} ({study.digest}), {missiles}{held}\n{cells}, {flights}"


def _json(study: Envelope) -> bytes:
    return (json.dumps(strict(study.to_json()), ensure_ascii=False, allow_nan=False) + "\n").encode()


def _csv(study: Envelope) -> bytes:
    text = io.StringIO()
    rows = list(study.rows())
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(rows[0])
    for row in rows:
        writer.writerow("" if math.isnan(value) else f"{value:.9g}" for value in row.values())
    return text.getvalue().encode()


def _png(study: Envelope) -> bytes:
    from layouts.envelope import picture

    return picture(envelope_figure(study), "png")


def _svg(study: Envelope) -> bytes:
    from layouts.envelope import picture

    return picture(envelope_figure(study), "svg")


FORMATS: dict[str, Callable[[Envelope], bytes]] = {".json": _json, ".csv": _csv, ".png": _png, ".svg": _svg}
"""Suffix -> content of the file."""
