"""What a person does with runs: delete, bring back, tag, write about. Files change in threads, questions come first."""

from __future__ import annotations

import asyncio
import html
from collections.abc import Awaitable, Callable, Sequence
from functools import partial
from typing import Any

import panel as pn
import panel_material_ui as pmui

from sim.errors import SubMasError, shorten
from workbench.launcher import resume
from workbench.run_index.index import RunIndex
from workbench.run_index.record import RunRecord
from workbench.run_notes import RunNotes, parse_tags, read_notes, write_notes
from workbench.runs import RunStore

MOST_NAMED = 6


class RunsActions:
    """The dialogs and what they do; `done` is awaited with the ids of the runs that have moved."""

    def __init__(self, store: RunStore, index: RunIndex, done: Callable[[Sequence[str]], Awaitable[None]]) -> None:
        self._store = store
        self._index = index
        self._done = done
        self._records: list[RunRecord] = []
        self._deleted: list[str] = []
        self._question = pn.pane.HTML("", margin=0)
        self._delete = self._dialog("Delete", self._question, "Move to the trash", "error", self._confirm)
        self._tags = pmui.TextInput(label="Tags, separated by commas", margin=0, sizing_mode="stretch_width")
        self._tag = self._dialog("Tag runs", self._tags, "Add these tags", "primary", self._add_tags)
        self._words = pn.pane.HTML("", margin=0, sizing_mode="stretch_width")
        self._undo = pmui.Button(label="Undo", variant="text", margin=0, sizing_mode=None, size="small")
        self._undo.on_click(self._bring_back)
        self.notice = pmui.Row(self._words, self._undo, visible=False, margin=0, sizing_mode="stretch_width",
                               sx={"alignItems": "center", "gap": "8px"})  # fmt: skip
        self.dialogs = [self._delete, self._tag]

    def _dialog(self, title: str, content: Any, words: str, color: Any, act: Callable[[], Awaitable[None]]) -> Any:
        yes = pmui.Button(label=words, color=color, margin=0, sizing_mode=None)
        no = pmui.Button(label="Cancel", variant="text", margin=0, sizing_mode=None)
        dialog = pmui.Dialog(content, pmui.Row(yes, no, margin=(16, 0, 0, 0)), title=title, open=False)

        async def agreed(_event: object) -> None:
            dialog.open = False
            await act()

        yes.on_click(agreed)
        no.on_click(lambda _event: setattr(dialog, "open", False))
        return dialog

    def ask(self, what: str, records: Sequence[RunRecord]) -> None:
        """Do what a button says with these runs, or ask first."""
        if what == "tag":
            self.ask_tags(records)
        elif what == "delete":
            self.ask_delete(records)
        elif what == "restore":
            pn.state.execute(partial(self.restore, [record.id for record in records]))
        elif what in ("pause", "resume") and records:
            pn.state.execute(partial(self.send, what, records[0].id))

    def ask_delete(self, records: Sequence[RunRecord]) -> None:
        """Ask whether these runs shall go to the trash."""
        self._records = list(records)
        names = [html.escape(shorten(record.title, 60)) for record in records[:MOST_NAMED]]
        more = f" and {len(records) - MOST_NAMED} more" if len(records) > MOST_NAMED else ""
        moved = "are" if len(records) > 1 else "is"
        self._question.object = (
            f"{', '.join(names)}{more} {moved} moved to the trash of the runs folder, and can be brought back."
        )
        self._delete.open = bool(records)

    def ask_tags(self, records: Sequence[RunRecord]) -> None:
        """Ask for tags to add to these runs."""
        self._records, self._tags.value = list(records), ""
        self._tag.open = bool(records)

    async def _confirm(self) -> None:
        ids = [record.id for record in self._records]
        moved, problems = await asyncio.to_thread(_each, self._store.delete, ids)
        self._deleted = moved
        self._tell(f"{_runs(len(moved))} moved to the trash.", problems, undo=bool(moved))
        await self._done(moved)

    async def _bring_back(self, _event: object) -> None:
        await self.restore(self._deleted)

    async def restore(self, ids: Sequence[str]) -> None:
        """Bring these runs back from the trash."""
        moved, problems = await asyncio.to_thread(_each, self._store.restore, ids)
        self._deleted = []
        self._tell(f"{_runs(len(moved))} brought back from the trash.", problems)
        await self._done([])

    async def send(self, wish: str, run_id: str) -> None:
        """Pause a run at the end of its epoch, or let it go on.

        Raises:
            SubMasError: it does not stand so that it could.
        """
        run = self._store.get(run_id)
        if wish == "pause":
            await asyncio.to_thread(run.request_pause)
        else:
            await asyncio.to_thread(resume, self._store, run)
        await self._done([])

    async def _add_tags(self) -> None:
        tags = parse_tags(self._tags.value or "")

        def add(record: RunRecord) -> None:
            folder = self._index.root / record.folder
            write_notes(folder, read_notes(folder).with_tags(tags))

        written, problems = await asyncio.to_thread(_each, add, self._records)
        self._tell(f"{_runs(len(written))} tagged.", problems)
        await self._done([])

    async def write(self, record: RunRecord, notes: RunNotes) -> None:
        """Keep what was written about a run in its folder.

        Raises:
            RunFileError: it cannot be written.
        """
        await asyncio.to_thread(write_notes, self._index.root / record.folder, notes)
        await self._done([])

    def _tell(self, sentence: str, problems: Sequence[str], undo: bool = False) -> None:
        self._words.object = html.escape(" ".join([sentence, *(f"{problem}." for problem in problems[:3])]))
        self._undo.visible = undo
        self.notice.visible = True


def _each(act: Callable[[Any], object], items: Sequence[Any]) -> tuple[list[Any], list[str]]:
    """Do it for each; those it was done for, and the sentences of those it was not."""
    done, problems = [], []
    for item in items:
        try:
            act(item)
            done.append(item)
        except SubMasError as error:
            problems.append(str(error))
    return done, problems


def _runs(count: int) -> str:
    return f"{count} run{'s' * (count != 1)}"
