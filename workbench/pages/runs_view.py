"""Everything the Runs page shows for one view, gathered from index and folders away from the event loop."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from layouts.run_curves import RUN_INKS
from sim.errors import SubMasError
from workbench.pages.runs_bar import facet_options
from workbench.pages.runs_curves import Drawing, drawing, run_label
from workbench.pages.runs_difference import difference
from workbench.pages.runs_lineage import lineage_of
from workbench.pages.runs_lines import Listing, baseline_line, listing
from workbench.pages.runs_settings import RunsSettings
from workbench.run_folder import is_run_id, problem_of
from workbench.run_index.index import RunIndex
from workbench.run_index.record import RunRecord
from workbench.runs import Run, RunStore


@dataclass(frozen=True)
class RunsList:
    """The table and the bar above it."""

    listing: Listing
    pinned: dict[str, Any] | None
    facets: list[dict[str, Any]]
    record: RunRecord | None
    """The run that is read about."""
    run: Run | None
    missing: str
    """Why there is nothing to read about although the address names a run; empty otherwise."""
    version: int
    """Of the index, before it was asked."""


@dataclass(frozen=True)
class RunsMore:
    """What takes longer: curves, difference and lineage."""

    drawing: Drawing
    difference: str = ""
    lineage: str = ""


def gather_list(index: RunIndex, settings: RunsSettings, first: int = 0) -> RunsList:
    """What the table and the panel of the run show."""
    version = index.version
    record = _record(index, settings.run)
    return RunsList(
        listing=listing(index, settings, first),
        pinned=baseline_line(settings, _record(index, settings.baseline)),
        facets=facet_options(index.facets(settings.search.trashed), settings.search.chosen),
        record=record,
        run=None if record is None else run_of(index, record),
        missing=_missing(index, settings.run) if record is None and settings.run else "",
        version=version,
    )


def gather_more(index: RunIndex, settings: RunsSettings, shown: Listing, with_lineage: bool = True) -> RunsMore:
    """What the curves, the difference and the lineage show."""
    wanted = dict.fromkeys([*settings.shown_runs, settings.run, settings.baseline])
    records = {key: record for key in wanted if (record := _record(index, key))}
    return RunsMore(
        drawing(settings, index.root, records, shown.groups),
        _difference(index, settings, records),
        _lineage(index, records.get(settings.run)) if with_lineage else "",
    )


def _missing(index: RunIndex, run_id: str) -> str:
    try:
        RunStore(index.root).get(run_id)
    except SubMasError as error:
        return f"{error}."
    return ""  # it has just been made: the next look finds it


def _record(index: RunIndex, run_id: str) -> RunRecord | None:
    return index.get(run_id) if is_run_id(run_id) else None


def run_of(index: RunIndex, record: RunRecord) -> Run:
    """The run folder behind a record, wherever it lies."""
    run = Run(index.root / record.folder)
    run.problem = problem_of(run)
    return run


def _difference(index: RunIndex, settings: RunsSettings, records: dict[str, RunRecord]) -> str:
    compared = [
        (run_of(index, records[key]), run_label(records[key]), RUN_INKS[settings.shown.index(key) % len(RUN_INKS)])
        for key in settings.shown_runs
        if key in records
    ]
    return difference(compared, settings.every_field) if len(compared) > 1 else ""


def _lineage(index: RunIndex, record: RunRecord | None) -> str:
    if record is None or record.problem:
        return ""
    try:
        return lineage_of(run_of(index, record), record, index)
    except SubMasError:  # it changed under our eyes; the next look tells
        return ""
