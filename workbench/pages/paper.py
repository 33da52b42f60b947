"""The Paper page: Tables 1 to 4 and Fig. 8 to 13, ours beside the paper's, every number with its runs."""

from __future__ import annotations

import asyncio
import html
from collections.abc import Mapping
from functools import partial
from typing import Any
from urllib.parse import parse_qsl

import panel as pn
import panel_material_ui as pmui
from bokeh.models import ColumnDataSource

from layouts.paper_curve_charts import show_only
from layouts.paper_inks import ink
from workbench.context import AppContext
from workbench.pages.address import read_query, write_query
from workbench.pages.paper_chips import AlgorithmChips
from workbench.pages.paper_contents import PaperContents
from workbench.pages.paper_files import file_of
from workbench.pages.paper_results import Results, chosen_source, own_source, read_results, signatures, sources
from workbench.pages.paper_run import RunPanel
from workbench.pages.paper_sections import NAMES, contents
from workbench.pages.paper_sheet import PaperSheet, command, heading
from workbench.pages.paper_view import (
    DOWNLOADS,
    Prepared,
    charts,
    column,
    empty_words,
    head,
    map_pane,
    panel,
    prepare,
)
from workbench.pages.waiting import waiting
from workbench.pages.wrapping import wrapping
from workbench.reproduce.protocol import LABELS, TRAINED_FOR

TICK_MS = 1000
FIRST = "overview"


def page(context: AppContext) -> pn.viewable.Viewable:
    """The Paper page of one session."""
    return PaperPage(context).layout


class PaperPage:
    """The section and the results that one session looks at."""

    def __init__(self, context: AppContext) -> None:
        query = read_query()
        self._store = context.store
        self._source, problem = chosen_source(query.get("results", ""), self._store)
        self._results = Results(self._source)
        self._seen: object = None
        self._asked = 0
        self._going = False
        self._wanted = {"number": query.get("number", ""), "hide": query.get("hide", "")}
        name = query.get("section", FIRST)
        if name not in NAMES:
            problem += f" There is no section {name[:40]!r}; this is the scorecard."
        self._contents = PaperContents(section=name if name in NAMES else FIRST, margin=0, sizing_mode="stretch_width")
        self._numbers = PaperSheet(margin=0)
        self._run = RunPanel(self._store, self._began)
        self._alert = pmui.Alert(object="", visible=False, severity="warning", margin=0, sizing_mode="stretch_width")
        self._complain(problem)
        self.layout = self._arrange()
        self._contents.param.watch(self._turn, "section")
        self._contents.param.watch(self._went, "address")
        self._picker.param.watch(self._pick, "value")
        pn.state.onload(self._load)
        callback = pn.state.add_periodic_callback(self._tick, TICK_MS)
        pn.state.on_session_destroyed(lambda _session: callback.stop())

    def _arrange(self) -> pn.viewable.Viewable:
        self._picker = pmui.Select(
            label="Results", options=self._options(), value=self._source.key, size="small", margin=0,
            sizing_mode="stretch_width",
        )  # fmt: skip
        rail = pmui.Column(
            self._picker, self._contents, width=214, margin=0, sx={"gap": "12px"},
            styles={"flex": "0 0 auto", "position": "sticky", "top": "12px", "align-self": "flex-start"},
        )  # fmt: skip
        self._main = pn.Column(
            waiting("Reading the results …"),
            sizing_mode="stretch_width",
            margin=0,
            styles={"gap": "12px", "min-width": "0"},
        )
        body = pn.Column(self._alert, self._main, sizing_mode="stretch_width", margin=0, styles={"gap": "12px"})
        return pn.Column(
            pn.Row(rail, body, sizing_mode="stretch_width", margin=0, styles={"gap": "16px"}), self._run.dialog,
            sizing_mode="stretch_width", margin=(12, 18),
        )  # fmt: skip

    def _options(self) -> dict[str, str]:
        return {one.label: one.key for one in [*sources(self._store), self._source]}

    # What is shown follows the section, the folder of results, and the files in it.

    def _turn(self, event: Any) -> None:
        if not self._going:
            self._wanted = {"number": "", "hide": ""}
            write_query(section="" if event.new == FIRST else event.new, number="", hide="")
            pn.state.execute(self._show, schedule=True)

    def _went(self, event: Any) -> None:
        """Follow the browser back or forth; nothing is written, or it would be a new way and the other one lost."""
        if pn.state.location is not None:
            pn.state.location.search = event.new
        query = dict(parse_qsl(event.new.removeprefix("?")))
        name = query.get("section", FIRST)
        self._wanted = {"number": query.get("number", ""), "hide": query.get("hide", "")}
        self._going = True
        self._contents.section = name if name in NAMES else FIRST
        self._going = False
        if query.get("results", "") in self._picker.options.values():
            self._picker.value = query["results"]
        pn.state.execute(self._show, schedule=True)

    def _pick(self, event: Any) -> None:
        if event.new != self._source.key:
            self._source, problem = chosen_source(str(event.new), self._store)
            self._complain(problem)
            write_query(results=self._source.key)
            pn.state.execute(self._load, schedule=True)

    def _began(self, profile: str) -> None:
        """A reproduction was begun: its results are what a person wants to see."""
        self._source = own_source(self._store, profile)
        self._picker.param.update(options=self._options(), value=self._source.key)
        write_query(results=self._source.key)
        pn.state.execute(self._load, schedule=True)

    def _tick(self) -> None:
        if NAMES[self._contents.section].item is not None:
            self._run.look()
        if self._seen is not None and signatures(self._source) != self._seen:
            pn.state.execute(self._load, schedule=True)

    async def _load(self) -> None:
        self._seen = signatures(self._source)
        results = await asyncio.to_thread(read_results, self._source)
        if results.source == self._source:  # else another one was chosen in the meantime
            self._results = results
            self._contents.items = contents(results)
            if results.problems:
                self._complain(" ".join(results.problems))
            await self._show()

    async def _show(self) -> None:
        self._asked += 1
        asked, name = self._asked, self._contents.section
        runs = await asyncio.to_thread(lambda: {run.id for run in self._store.list()})
        prepared = await asyncio.to_thread(prepare, name, self._results, runs)
        if asked == self._asked:
            self._main.objects = self._panels(prepared)

    def _panels(self, prepared: Prepared) -> list[Any]:
        section, item = prepared.section, prepared.section.item
        self._numbers = PaperSheet(
            heard=self._heard, blocks=list(prepared.scores), records=prepared.records,
            chosen=[key for key in self._wanted["number"].split(",") if key in prepared.records],
            margin=0, sizing_mode="stretch_width",
        )  # fmt: skip
        self._numbers.param.watch(self._chose, "chosen")
        if item is None:
            return [head(section), panel(self._numbers)]
        self._run.show(item, self._source.profile)
        if section.name in ("fig10", "fig11"):
            shown = map_pane(prepared.maps) if prepared.maps else self._sheet(empty_words(item, None))
            return [head(section), panel(shown), panel(self._numbers), self._made_by()]
        points = panel(self._sheet(prepared.points))
        made_by = column("1 1 340px", self._made_by())
        beside = wrapping(column("1 1 560px", points), made_by, gap="12px", align="stretch")
        return [head(section), self._figure(prepared), beside, panel(self._numbers)]

    def _sheet(self, blocks: Any) -> PaperSheet:
        return PaperSheet(heard=self._heard, blocks=list(blocks), margin=0, sizing_mode="stretch_width")

    def _figure(self, prepared: Prepared) -> pmui.Paper:
        item = prepared.section.item
        assert item is not None
        result = self._results.sets.get(item)
        if prepared.drawn is None:
            return panel(self._sheet(empty_words(item, result)))
        parts = [*self._legend(prepared), *charts(prepared)]
        for source in prepared.drawn.dots:
            source.selected.on_change("indices", partial(self._tapped, source))
        if result is not None:
            self._files = self._sheet([{"kind": "downloads", "files": [list(one) for one in DOWNLOADS[item]]}])
            parts.append(self._files)
        return panel(*parts)

    def _legend(self, prepared: Prepared) -> list[AlgorithmChips]:
        item = prepared.section.item
        if item not in ("fig8", "fig9") or prepared.drawn is None:
            return []
        figures = [chart for pair in prepared.drawn.pairs for chart in pair]
        entries = [{"name": v, "label": LABELS[v], "ink": ink(v)} for v in TRAINED_FOR[item]]
        hidden = [name for name in self._wanted["hide"].split(",") if name in TRAINED_FOR[item]]
        legend = AlgorithmChips(entries=entries, hidden=hidden, margin=0, sizing_mode="stretch_width")
        show_only(figures, hidden)

        def hide(event: Any) -> None:
            show_only(figures, event.new)
            self._wanted["hide"] = ",".join(event.new)
            write_query(hide=self._wanted["hide"])

        legend.param.watch(hide, "hidden")
        return [legend]

    def _made_by(self) -> pmui.Paper:
        item = NAMES[self._contents.section].item
        result = self._results.sets.get(item) if item else None
        blocks = [heading("Made by", self._source.label), command(result.command)] if result else []
        return panel(self._sheet([*blocks, heading("Run it here", "in the background")]), self._run.layout)

    # What a person does in it.

    def _tapped(self, source: ColumnDataSource, _attribute: str, _old: object, indices: list[int]) -> None:
        if indices:
            self._numbers.chosen = [str(source.data["key"][indices[0]])]
            source.selected.indices = []

    def _chose(self, event: Any) -> None:
        self._wanted["number"] = ",".join(event.new)
        write_query(number=self._wanted["number"])

    def _heard(self, message: Mapping[str, str]) -> None:
        if message.get("section") in NAMES:
            self._contents.section = message["section"]
        if "download" in message:
            pn.state.execute(partial(self._download, message["download"]), schedule=True)

    async def _download(self, kind: str) -> None:
        sheet, item = self._files, NAMES[self._contents.section].item
        result = self._results.sets.get(item) if item else None
        made = await asyncio.to_thread(file_of, result, kind) if result else None
        if made is None:
            sheet.saved_nothing()
        else:
            sheet.hand_over(*made)

    def _complain(self, sentence: str) -> None:
        self._alert.object = html.escape(sentence.strip())
        self._alert.visible = bool(sentence.strip())
