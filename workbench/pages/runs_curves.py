"""The curves of the Runs page: what is ticked, over each other in two figures, with the pinned baseline."""

from __future__ import annotations

import html
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui as pmui

from layouts.run_curves import BASELINE_INK, RUN_INKS, Level, RunCurve, curve_figure
from workbench.pages.runs_baseline import EXPERT_SHORT, expert_rate
from workbench.pages.runs_groups import Group
from workbench.pages.runs_metrics import RATES, X_LABELS, Look, RunMetrics, curve_of, group_curve, metrics_of
from workbench.pages.runs_settings import EXPERT, METRICS, NO_BASELINE, STAGES, X_AXES, RunsSettings
from workbench.pages.wrapping import wrapping
from workbench.run_index.record import RunRecord

MOST_MEMBERS = 30
"""Runs of a group that are read for its curve: the newest."""
HEIGHT = 290
HINT = (
    "Tick runs in the table to lay their curves over each other; with groups, tick a group for its mean and interval."
)
CURVES_CSS = """
:host { color: var(--panel-on-background-color); font: 13.5px/1.4 var(--bokeh-base-font, sans-serif) }
.key { display: flex; flex-wrap: wrap; gap: 3px 16px; align-items: center }
.key span { display: inline-flex; align-items: center; gap: 7px; max-width: 330px }
.key b { font-weight: 550; overflow: hidden; text-overflow: ellipsis; white-space: nowrap }
.key i { width: 18px; border-top: 3px solid var(--ink); flex: none }
.key i.dashed { border-top-style: dashed }
.key em { font-style: normal; color: #e5414d }
.hint { opacity: .8 }
"""


@dataclass(frozen=True)
class Source:
    """What has a curve: a run, or a group of them."""

    label: str
    ink: str
    members: tuple[RunMetrics, ...]
    group: bool = False
    dashed: bool = False

    @property
    def problem(self) -> str:
        """Why not all of it could be read."""
        return next((each.problem for each in self.members if each.problem), "")

    def curve(self, metric: str, look: Look) -> RunCurve | None:
        """Its curve of this figure; None where there is nothing to draw."""
        if self.group:
            return group_curve(self.members, metric, look, self.label, self.ink)
        curve = curve_of(self.members[0], metric, look, self.label, self.ink, self.dashed)
        return curve if len(curve.x) else None


@dataclass(frozen=True)
class Drawing:
    """Everything the two figures show."""

    sources: tuple[Source, ...]
    curves: tuple[tuple[RunCurve, ...], tuple[RunCurve, ...]]
    levels: tuple[Level, ...]


def drawing(
    settings: RunsSettings, root: Path, records: Mapping[str, RunRecord], groups: Mapping[str, Group]
) -> Drawing:
    """Read what is shown and make its curves. Takes its time: not for the event loop.

    Args:
        settings: the view.
        root: the runs folder.
        records: the records of the runs that are shown, read about or pinned, by id.
        groups: the groups of the list by key.
    """
    sources = _sources(settings, root, records, groups)
    look = Look(settings.x, settings.stages, settings.smooth / 100.0)
    first, second = (
        tuple(curve for source in sources if (curve := source.curve(metric, look))) for metric in settings.metrics
    )
    return Drawing(tuple(sources), (first, second), _levels(settings, records, groups))


def _shown(settings: RunsSettings) -> list[tuple[int, str]]:
    """Place and key of what is shown; the run that is read about where nothing is ticked."""
    shown = [(place, key) for place, key in enumerate(settings.shown) if key]
    return shown or ([(0, settings.run)] if settings.run else [])


def _sources(
    settings: RunsSettings, root: Path, records: Mapping[str, RunRecord], groups: Mapping[str, Group]
) -> list[Source]:
    sources = []
    for place, key in _shown(settings):
        ink = RUN_INKS[place % len(RUN_INKS)]
        if group := groups.get(key.removeprefix("group:")) if key.startswith("group:") else None:
            members = tuple(metrics_of(root / record.folder) for record in group.records[:MOST_MEMBERS])
            sources.append(Source(group.key, ink, members, group=True))
        elif (record := records.get(key)) and key != settings.baseline:
            sources.append(Source(run_label(record), ink, (metrics_of(root / record.folder),)))
    if pinned := records.get(settings.baseline):
        members = (metrics_of(root / pinned.folder),)
        sources.append(Source(f"baseline: {run_label(pinned)}", BASELINE_INK, members, dashed=True))
    return sources


def run_label(record: RunRecord) -> str:
    """A run in a few words, to tell it from others."""
    seed = "" if record.seed is None else f"seed {record.seed}"
    return " · ".join(filter(None, [record.title, record.variant, seed, "" if record.name else record.id[-6:]]))


def _levels(settings: RunsSettings, records: Mapping[str, RunRecord], groups: Mapping[str, Group]) -> tuple[Level, ...]:
    """The expert's success on the tasks that the shown runs end with: at most four lines."""
    if settings.baseline in records and (rate := records[settings.baseline].success) is not None:
        return (Level(f"baseline {100 * rate:.1f} %", rate),)
    if settings.baseline != EXPERT:
        return ()
    shown = [records[key] for _, key in _shown(settings) if key in records]
    shown += [group.records[0] for _, key in _shown(settings) if (group := groups.get(key.removeprefix("group:")))]
    tasks = dict.fromkeys((record.scenario, record.subtasks) for record in shown if not record.problem)
    levels = {}
    for scenario, subtasks in [*tasks][:4]:
        task, rate = expert_rate(scenario, subtasks)
        if rate is not None:
            levels[f"dragging expert, {task} {100 * rate:.1f} %"] = rate
    return tuple(Level(label, rate) for label, rate in levels.items())


class RunsCurves:
    """Two figures, what they show, and how they are looked at; `on_change` hears what a person changes."""

    def __init__(self, settings: RunsSettings, on_change: Callable[..., None]) -> None:
        self._figures = [curve_figure(f"runs-{number}", HEIGHT) for number in (1, 2)]
        for each in self._figures:
            each.figure.background_fill_alpha = each.figure.border_fill_alpha = 0.0
        self._key = pn.pane.HTML("", stylesheets=[CURVES_CSS], sizing_mode="stretch_width", margin=0)
        self._panes = [pn.pane.Bokeh(each.figure, sizing_mode="stretch_width", margin=0) for each in self._figures]
        self._make_controls(settings, on_change)
        flex = {"flex": "1 1 380px", "min-width": "0"}
        figures = wrapping(*(pmui.Column(pane, margin=0, styles=flex) for pane in self._panes), gap="8px")
        self._plots = pn.Column(figures, sizing_mode="stretch_width", margin=0, visible=False)
        self.layout = pn.Column(self._controls, self._key, self._plots, sizing_mode="stretch_width", margin=0,
                                styles={"gap": "8px"})  # fmt: skip

    def _make_controls(self, settings: RunsSettings, on_change: Callable[..., None]) -> None:
        self._widgets: dict[str, Any] = {
            "left": _select("Left figure", METRICS, settings.metrics[0], "2 1 132px"),
            "right": _select("Right figure", METRICS, settings.metrics[1], "2 1 132px"),
            "x": _select("Horizontal axis", X_AXES, settings.x, "1 1 100px"),
            "stages": _select("Stages", STAGES, settings.stages, "1 1 90px"),
            "baseline": _select("Baseline", _baselines(settings), settings.baseline, "2 1 132px"),
            "smooth": pmui.IntSlider(
                label="Smooth [%]", value=settings.smooth, start=0, end=99, size="small", margin=(0, 6),
                styles={"flex": "1 1 100px"},
            ),
        }  # fmt: skip
        for name, widget in self._widgets.items():
            what = "value_throttled" if name == "smooth" else "value"
            widget.param.watch(lambda _event: self._heard(on_change), what)
        self._controls = wrapping(*self._widgets.values(), gap="8px 10px", align="center")
        self._quiet = False

    def _heard(self, on_change: Callable[..., None]) -> None:
        if self._quiet:
            return
        chosen = {name: widget.value for name, widget in self._widgets.items()}
        metrics = (chosen["left"], chosen["right"])
        on_change(metrics=metrics, **{name: chosen[name] for name in ("x", "stages", "baseline", "smooth")})

    def take(self, settings: RunsSettings) -> None:
        """Show these settings in the controls, without telling of it."""
        self._quiet = True
        try:
            self._widgets["baseline"].options = {words: value for value, words in _baselines(settings).items()}
            values = {"left": settings.metrics[0], "right": settings.metrics[1], "x": settings.x}
            values |= {"stages": settings.stages, "baseline": settings.baseline, "smooth": settings.smooth}
            for name, value in values.items():
                self._widgets[name].value = value
        finally:
            self._quiet = False

    def show(self, settings: RunsSettings, found: Drawing) -> None:
        """Draw this."""
        drawn = bool(found.sources)
        self._plots.visible = self._controls.visible = drawn
        self._key.object = _key(found) if drawn else f'<span class="hint">{HINT}</span>'
        if not drawn:
            return
        for sheet, metric, curves in zip(self._figures, settings.metrics, found.curves, strict=True):
            levels = found.levels if "success" in metric else ()
            sheet.show(curves, METRICS[metric], X_LABELS[settings.x], levels, rate=metric in RATES)


def _select(label: str, words: Mapping[str, str], value: str, flex: str) -> pmui.Select:
    options = {text: key for key, text in words.items()}
    return pmui.Select(label=label, options=options, value=value, size="small", margin=0, styles={"flex": flex})


def _baselines(settings: RunsSettings) -> dict[str, str]:
    pinned = {} if settings.baseline in (EXPERT, NO_BASELINE) else {settings.baseline: f"run {settings.baseline}"}
    return {EXPERT: EXPERT_SHORT, **pinned, NO_BASELINE: "no baseline"}


def _key(found: Drawing) -> str:
    """Which ink is what; labels are data."""
    entries = []
    for source in found.sources:
        style = "dashed" if source.dashed else ""
        empty = not any(curve.ink == source.ink for curves in found.curves for curve in curves)
        trouble = source.problem or ("has no epoch yet" if empty else "")
        said = f" <em>{html.escape(trouble)}</em>" if trouble else ""
        entries.append(
            f'<span style="--ink: {source.ink}"><i class="{style}"></i><b>{html.escape(source.label)}</b>{said}</span>'
        )
    entries += [
        f'<span style="--ink: {BASELINE_INK}"><i class="dashed"></i><b>{html.escape(level.label)}</b></span>'
        for level in found.levels
    ]
    return f'<div class="key">{"".join(entries)}</div>'
