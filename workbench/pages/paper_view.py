"""One section of the Paper page: what is prepared beside the server's loop, and the panels it becomes."""

from __future__ import annotations

import html
from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from typing import Any

import panel as pn
import panel_material_ui as pmui

from workbench.pages.paper_figures import MAP_CSS, Drawn, drawn, maps
from workbench.pages.paper_results import Results
from workbench.pages.paper_scores import notes_block, points_block, score_blocks
from workbench.pages.paper_sections import NAMES, Section, overview_blocks
from workbench.pages.paper_settings import table1_blocks, table2_blocks, table3_blocks
from workbench.pages.paper_sheet import Block, PaperSheet, command, heading, words
from workbench.pages.paper_sources import Record, records
from workbench.pages.wrapping import wrapping
from workbench.reproduce.protocol import Item
from workbench.reproduce.result_set import ResultSet

CODE_BLOCKS = {"table1": table1_blocks, "table2": table2_blocks, "table3": table3_blocks}
REPLAYED = {"fig10": "submas", "fig11": "expert"}
HEAD_CSS = """
:host { color: var(--panel-on-background-color); font: 14px/1.45 var(--bokeh-base-font, sans-serif) }
h2 { font-size: 21px; font-weight: 700; margin: 0; line-height: 1.25 }
h2 small { font-weight: 400; opacity: .75; font-size: 16px; margin-left: 8px }
p { margin: 2px 0 0; opacity: .82 }
"""
DOWNLOADS: dict[str, tuple[tuple[str, str], ...]] = {
    "table4": (("csv", "Numbers, CSV"), ("json", "Result set, JSON")),
    "fig8": (("png", "PNG"), ("svg", "SVG"), ("csv", "Numbers, CSV"), ("curves", "Curves, CSV"), ("json", "JSON")),
    "fig9": (("png", "PNG"), ("svg", "SVG"), ("csv", "Numbers, CSV"), ("curves", "Curves, CSV"), ("json", "JSON")),
    "fig12": (("png", "PNG"), ("svg", "SVG"), ("csv", "Curves, CSV"), ("json", "JSON")),
    "fig13": (("png", "PNG"), ("svg", "SVG"), ("csv", "Numbers, CSV"), ("json", "JSON")),
}


@dataclass(frozen=True)
class Prepared:
    """All there is to show of a section, as data and charts without a page."""

    section: Section
    drawn: Drawn | None = None
    maps: str = ""
    """Small maps as HTML."""
    points: Sequence[Block] = ()
    scores: Sequence[Block] = ()
    records: dict[str, Record] = field(default_factory=dict)


def prepare(name: str, results: Results, runs: Collection[str]) -> Prepared:
    """Compute what a section shows; may take a second, so not for the server's loop. `runs`: ids in the folder."""
    section = NAMES[name]
    if name in CODE_BLOCKS:
        return Prepared(section, scores=CODE_BLOCKS[name]())
    if section.item is None:
        return Prepared(section, scores=overview_blocks(results))
    item, result = section.item, results.sets.get(section.item)
    if name in REPLAYED:
        return Prepared(section, maps=_maps(name, result), scores=_replay_words(name))
    points = [heading("Point by point", "what the paper says, and what comes out here"), points_block(item, result)]
    points += [notes_block(item, result)] if result else []
    scores = score_blocks(item, result)
    found = records(result, runs) if result else {}
    return Prepared(section, drawn(item, result), points=points, scores=scores, records=found)


def _maps(name: str, result: ResultSet | None) -> str:
    replay = next((one for one in result.replays if one.variant == REPLAYED[name]), None) if result else None
    return maps(replay) if replay else ""


def _replay_words(name: str) -> list[Block]:
    says = {
        "fig10": "The paper (§4.4): the evader first takes a superior position instead of heading for the exit, keeps "
        "its heading almost vertical to the line of sight while missiles fly, turns towards a missile that is near, "
        "and navigates to the exit once all are evaded.",
        "fig11": "The paper (§4.4): the expert turns ±90° off the closest missile and ignores the others; its track is "
        "steeper and more violent than that of SubMas-RL.",
    }
    note = "The first seed of the Fly page with which both policies evade every missile and arrive; replayed there "
    note += "in 3-D, both on one clock. Blue: SubMas-RL; orange: the expert; red: the interceptor; dot: its place."
    return [words(says[name]), words(note, "quiet")]


def head(section: Section) -> pn.pane.HTML:
    """Title of a section."""
    about = f"<small>{html.escape(section.about)}</small>"
    text = f"<h2>{html.escape(section.title)}{about}</h2><p>{html.escape(section.paper)}</p>"
    return pn.pane.HTML(text, stylesheets=[HEAD_CSS], margin=0, sizing_mode="stretch_width")


def empty_words(item: Item, result: ResultSet | None) -> list[Block]:
    """What to do where there is nothing to draw."""
    line = result.command if result else f"workbench reproduce {item}"
    text = "Nothing to draw yet. Press “Run this” below: it works in the background, and the section fills as it goes. "
    return [words(text + "Or on a terminal:"), command(line)]


def charts(prepared: Prepared) -> list[Any]:
    """Pairs of charts; on a very wide page two pairs stand side by side."""
    assert prepared.drawn is not None
    pairs = []
    for pair in prepared.drawn.pairs:
        panes = [
            pn.pane.Bokeh(chart, sizing_mode="stretch_width", margin=0, styles={"min-width": "0"}) for chart in pair
        ]
        row = pn.Row(*panes, margin=0, sizing_mode="stretch_width", styles={"gap": "10px"})
        pairs.append(pn.Column(row, margin=0, styles={"flex": "1 1 940px", "min-width": "0"}))
    box = wrapping(*pairs, gap="10px")
    caption = PaperSheet(blocks=[words(prepared.drawn.caption, "quiet")], margin=0, sizing_mode="stretch_width")
    return [box, caption]


def map_pane(text: str) -> pn.pane.HTML:
    """The small maps of Fig. 10 and 11."""
    return pn.pane.HTML(text, stylesheets=[MAP_CSS], margin=0, sizing_mode="stretch_width")


def panel(*parts: Any) -> pmui.Paper:
    """A card of the page."""
    return pmui.Paper(*parts, elevation=1, margin=0, sizing_mode="stretch_width", sx={"p": "14px 16px", "gap": "12px"})


def column(flex: str, card: pmui.Paper) -> pmui.Column:
    """A card that shares a row."""
    return pmui.Column(card, margin=0, styles={"flex": flex, "min-width": "0"})
