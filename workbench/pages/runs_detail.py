"""One run in full: its state, what can be done with it, its note and tags, its lineage, its configuration and files."""

from __future__ import annotations

import contextlib
import html
from collections.abc import Callable
from pathlib import Path
from typing import Any

import panel as pn
import panel_material_ui as pmui

from layouts.run_lineage import LINEAGE_CSS
from layouts.theme import FAILURE, NEUTRAL
from sim.errors import SubMasError
from workbench.pages.address import fly_address
from workbench.pages.live_cards import STATE_COLOURS
from workbench.pages.wrapping import wrapping
from workbench.run_index.record import UNREADABLE, RunRecord
from workbench.run_notes import NOTE_LIMIT, RunNotes, parse_tags
from workbench.run_state import ACTIVE, RESUMABLE
from workbench.runs import Run
from workbench.terminal import duration, percent

MOST_FILES = 40
DETAIL_CSS = """
:host { color: var(--panel-on-background-color); font: 13.5px/1.45 var(--bokeh-base-font, sans-serif) }
h2 { font-size: 17px; margin: 0; overflow-wrap: anywhere; line-height: 1.25 }
h3 { font-size: 13.5px; margin: 4px 0 4px; font-weight: 650 }
.head { display: flex; flex-wrap: wrap; gap: 6px 10px; align-items: center }
.state { color: #fff; background: color-mix(in srgb, var(--ink) 82%, #000); border-radius: 6px; padding: 1px 9px;
  font-weight: 650 }
.error { color: color-mix(in srgb, #e5414d 75%, currentColor); font-weight: 600; overflow-wrap: anywhere;
  margin: 4px 0 0 }
dl { display: grid; grid-template-columns: max-content 1fr; gap: 2px 14px; margin: 0 }
dt { opacity: .7 } dd { margin: 0; overflow-wrap: anywhere }
"""
NOTHING = "Click a run to read about it: its figures, where its knowledge came from, your notes."
Act = Callable[[str], None]


class RunsDetail:
    """The panel of one run. `act` hears the name of a button; `write` hears what a person wrote."""

    def __init__(self, act: Act, write: Callable[[RunNotes], None]) -> None:
        self._write = write
        self._stored = ("", RunNotes())
        self._quiet = False
        self._panes = {name: _pane() for name in ("head", "lineage", "facts")}
        self._make_buttons(act)
        self._make_notes()
        self._body = pn.Column(
            self._buttons, self._tags, self._note, self._panes["lineage"], self._panes["facts"],
            sizing_mode="stretch_width", margin=0, styles={"gap": "12px"}, visible=False,
        )  # fmt: skip
        self.layout = pn.Column(
            self._panes["head"], self._body, sizing_mode="stretch_width", margin=0, styles={"gap": "12px"}
        )
        self._panes["head"].object = f"<div>{NOTHING}</div>"

    def _make_buttons(self, act: Act) -> None:
        self.open = pmui.Button(label="Open in Live", icon="show_chart", color="primary", margin=0, sizing_mode=None)
        self.fly = _button("Fly", "flight_takeoff")
        self.pin = _button("Pin as baseline", "push_pin")
        self.pause = _button("Pause", "pause")
        self.resume = _button("Resume", "play_arrow", "primary")
        self.delete = _button("Delete", "delete", "error")
        self.restore = _button("Restore", "restore_from_trash", "primary")
        acting = {name: getattr(self, name) for name in ("pause", "resume", "pin", "delete", "restore")}
        for name, button in acting.items():
            button.on_click(lambda _event, name=name: act(name))
        every = (self.open, self.fly, *acting.values())
        self._buttons = wrapping(*every, gap="8px")

    def _make_notes(self) -> None:
        self._tags = pmui.TextInput(
            label="Tags, separated by commas", size="small", sizing_mode="stretch_width", margin=0,
            placeholder="for example: paper, keep",
        )  # fmt: skip
        self._note = pmui.TextAreaInput(
            label="Note", auto_grow=True, rows=2, max_rows=10, max_length=NOTE_LIMIT, size="small",
            sizing_mode="stretch_width", margin=0, placeholder="What you want to remember about this run",
        )  # fmt: skip
        for widget in (self._tags, self._note):
            widget.param.watch(self._wrote, "value")

    def _wrote(self, _event: object) -> None:
        if not self._quiet:
            self._write(RunNotes(self._note.value or "", parse_tags(self._tags.value or "")))

    def show(self, record: RunRecord | None, run: Run | None, sentence: str = "") -> None:
        """Show this run; None says what to do, or why there is nothing to show."""
        self._body.visible = record is not None and run is not None
        if record is None or run is None:
            self._panes["head"].object = f"<div>{html.escape(sentence) or NOTHING}</div>"
            return
        self._panes["head"].object = head(record)
        self._panes["facts"].object = facts(record, run)
        self._show_buttons(record, run)
        self._show_notes(record)

    def show_lineage(self, content: str) -> None:
        """HTML that `runs_lineage` has made; empty hides it."""
        self._panes["lineage"].object = f"<h3>Lineage</h3>{content}" if content else ""

    def _show_buttons(self, record: RunRecord, run: Run) -> None:
        good, living = not record.problem, not record.trashed
        self.open.visible, self.fly.visible, self.pin.visible = good and living, False, good and living
        self.open.href = f"/live?run={record.id}"
        if good and living and record.has_policy:
            self.fly.href, self.fly.visible = _fly_address(run), True
        asked = good and run.pause_requested()
        self.pause.param.update(visible=living and record.state in ACTIVE, disabled=asked,
                                label="Pausing …" if asked else "Pause")  # fmt: skip
        self.resume.visible = living and record.state in RESUMABLE
        self.delete.visible, self.restore.visible = living, not living
        self.delete.disabled = record.state in ("running", "stalled")

    def _show_notes(self, record: RunRecord) -> None:
        """Only what has changed in the folder: what is being written here is not taken away."""
        stored = (record.folder, RunNotes(record.notes, tuple(record.tag_list)))
        if stored == self._stored:
            return
        self._stored, self._quiet = stored, True
        try:
            self._note.value, self._tags.value = record.notes, ", ".join(record.tag_list)
        finally:
            self._quiet = False


def _fly_address(run: Run) -> str:
    try:
        return fly_address(run)
    except SubMasError:
        return f"/fly?a={run.id}"


def head(record: RunRecord) -> str:
    """Title, state and what is wrong; texts are escaped."""
    ink = STATE_COLOURS.get(record.state, FAILURE if record.state == UNREADABLE else NEUTRAL)
    state = f'<span class="state" style="--ink: {ink}">{html.escape(record.state)}</span>'
    trouble = "".join(f'<p class="error">{html.escape(text)}</p>' for text in (record.problem, record.error) if text)
    where = " in the trash" if record.trashed else ""
    return f'<div class="head"><h2>{html.escape(record.title)}</h2>{state}{where}</div>{trouble}'


def facts(record: RunRecord, run: Run) -> str:
    """What is known of a run, its configuration and its files, as HTML; texts are escaped."""
    pairs: list[tuple[str, str]] = [("Run", record.id)]
    if not record.problem:
        pairs += [
            ("Training", " · ".join((record.task, record.variant, record.profile, f"seed {record.seed}"))),
            ("Success", percent(record.success)),
            ("Mean return", "–" if record.mean_return is None else f"{record.mean_return:.1f}"),
            ("Worked", duration(record.wall_s)),
            *([("On", where)] if (where := _where(run)) else []),
            ("Started", record.when[:19].replace("T", " ")),
            ("Scenario", record.scenario),
            ("Guide", record.guide or "the next easier task's"),
        ]
    parts = [_listed("", [*pairs, ("Folder", str(run.path))])]
    found = files(run.path)
    if found:
        parts.append(_listed("<h3>Policies, checkpoints, evaluations</h3>", found))
    return "".join(parts)


def _where(run: Run) -> str:
    with contextlib.suppress(SubMasError):  # it may have changed under our eyes
        return run.state.where
    return ""


def _listed(heading: str, pairs: list[tuple[str, str]]) -> str:
    rows = "".join(f"<dt>{html.escape(name)}</dt><dd>{html.escape(text)}</dd>" for name, text in pairs)
    return f"{heading}<dl>{rows}</dl>"


def files(folder: Path) -> list[tuple[str, str]]:
    """Files that a run has produced, by their path in its folder, with their size; the first MOST_FILES."""
    if folder.is_symlink() or not folder.is_dir():
        return []
    found = []
    try:
        for name in ("policy.safetensors", "policies", "checkpoints", "evaluations"):
            part = folder / name
            inside = sorted(part.iterdir()) if part.is_dir() and not part.is_symlink() else [part]
            found += [each for each in inside if each.is_file() and not each.name.startswith(".")]
        return [(str(each.relative_to(folder)), _size(each.stat().st_size)) for each in found[:MOST_FILES]]
    except OSError:
        return []


def _size(count: int) -> str:
    return f"{count / 1e6:.1f} MB" if count >= 1_000_000 else f"{count / 1e3:.1f} kB"


def _button(label: str, icon: str, color: str = "default") -> Any:
    return pmui.Button(label=label, icon=icon, color=color, variant="outlined", margin=0, sizing_mode=None)


def _pane() -> pn.pane.HTML:
    return pn.pane.HTML("", stylesheets=[DETAIL_CSS, LINEAGE_CSS], sizing_mode="stretch_width", margin=0)
