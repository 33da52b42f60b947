"""The lattice of tasks: every mask, by number of missiles left, with the chain of Algorithm 3 (Fig. 5).

Up to four missiles all tasks are large and all links are drawn. Beyond that (64 tasks for six, 256 for eight) the chain
stands above blocks of small nodes, and links are drawn for the chain and for the task that is selected.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import comb
from typing import Any

from bokeh.models import ColumnDataSource, HoverTool, TapTool
from bokeh.plotting import figure

from layouts.lattice_places import CHIP_PITCH, WIDE, Mask, Plan, chain_of, masks_by_level, nested_chain, plan
from layouts.theme import NEUTRAL, POLICY_A, SUCCESS, missile_colour

__all__ = ["Lattice", "Mask", "chain_of", "lattice_figure", "mask_text", "masks_by_level", "nested_chain"]

Columns = dict[str, list[Any]]


def mask_text(mask: Iterable[int]) -> str:
    """A mask as in `--mask`: `"3,4"`; empty for none."""
    return ",".join(str(number) for number in sorted(mask))


@dataclass
class Lattice:
    """The figure with its nodes and links; a tap selects a node, whose `mask` is text as in `--mask`."""

    figure: figure
    nodes: ColumnDataSource
    links: ColumnDataSource
    tag: ColumnDataSource
    """The name of the selected task where nodes are too small for names: one row or none."""
    plan: Plan
    chain: tuple[Mask, ...]
    """The chain that is drawn, easiest task first."""

    def select(self, mask: Mask, chain: Sequence[Mask] | None = None) -> None:
        """Mark this task and the chain; where there is no room for all links, draw those of the task's neighbours."""
        self.chain = self.chain if chain is None else tuple(chain)
        marks = _marks(self.plan, self.chain, mask)
        self.nodes.patch({name: [(slice(None), values)] for name, values in marks.items()})
        self.links.data = dict(_links(self.plan, self.chain, mask))
        self.tag.data = dict(_tag(self.plan, mask))


def lattice_figure(
    missiles: int,
    selected: Mask | None = None,
    success: Mapping[Mask, float] | None = None,
    height: int = 420,
    chain: Sequence[Mask] | None = None,
) -> Lattice:
    """The lattice of a target task.

    Args:
        missiles: number of missiles n of the target task; 2^n nodes are drawn.
        selected: the mask to mark.
        success: success rate 0 to 1 by mask, written under the names of tasks that have one.
        height: height of the figure [px].
        chain: masks of the tasks to train, easiest first; Table 1's chain when left out.
    """
    chain = tuple(nested_chain(missiles) if chain is None else chain)
    layout = plan(missiles)
    fig = figure(
        height=height, sizing_mode="stretch_width", tools="", toolbar_location=None,
        x_range=(-0.6, missiles + 0.6), y_range=(-0.62, 0.62),
    )  # fmt: skip
    fig.grid.visible = fig.yaxis.visible = False
    fig.outline_line_color = None
    fig.xaxis.ticker = list(range(missiles + 1))
    fig.xaxis.axis_label = "missiles to evade"
    if not layout.roomy:
        counts = {level: comb(missiles, level) for level in range(missiles + 1)}
        fig.xaxis.major_label_overrides = {n: f"{n}: {k} task{'s' * (k > 1)}" for n, k in counts.items()}
    links = ColumnDataSource(_links(layout, chain, selected))
    fig.segment("x0", "y0", "x1", "y1", source=links, color="ink", line_width="width", alpha="alpha")
    nodes = ColumnDataSource(_nodes(layout, success or {}) | _marks(layout, chain, selected))
    tag = ColumnDataSource(_tag(layout, selected))
    _draw_nodes(fig, nodes, layout)
    if layout.roomy:
        _draw_missiles(fig, layout)
    fig.text(
        "x", "y", text="text", source=tag, text_color="#ffffff", text_font_size="12px", text_font_style="bold",
        y_offset=-22, text_align="center", text_baseline="middle", level="overlay",
        background_fill_color=SUCCESS, padding=3, border_radius=5,
    )  # fmt: skip
    return Lattice(fig, nodes, links, tag, layout, chain)


def _nodes(layout: Plan, success: Mapping[Mask, float]) -> Columns:
    """What does not change: place, size, mask and names."""
    masks, every = list(layout.places), max(layout.places, key=len)
    spine = nested_chain(len(every))
    kept = [sorted(every - mask) for mask in masks]
    return {
        "x": [layout.places[m][0] for m in masks],
        "y": [layout.places[m][1] for m in masks],
        "width": [layout.sizes[m][0] for m in masks],
        "height": [layout.sizes[m][1] for m in masks],
        "mask": [mask_text(m) for m in masks],
        "name": [_name(numbers, layout, m in spine) for m, numbers in zip(masks, kept, strict=True)],
        "font": ["13px" if m in spine else "10px" for m in masks],
        "caption": [f"{success[m]:.1%}" if m in success else "" for m in masks],
        "task": [_task_text(numbers, len(every)) for numbers in kept],
    }


def _marks(layout: Plan, chain: Sequence[Mask], selected: Mask | None) -> Columns:
    """What follows the selection and the chain: filling, rings and the colours of names."""
    masks, solid = list(layout.places), 0.3 if layout.roomy else 0.9
    return {
        "fill": [POLICY_A if m in chain else NEUTRAL for m in masks],
        "fill_alpha": [solid if m in chain else (0.1 if layout.roomy else 0.16) for m in masks],
        "ring": [SUCCESS if m == selected else (POLICY_A if m in chain else NEUTRAL) for m in masks],
        "ring_width": [3.5 if m == selected else (2.0 if m in chain else 1.0) for m in masks],
        "ink": ["#ffffff" if m in chain else (SUCCESS if m == selected else NEUTRAL) for m in masks],
    }


def _tag(layout: Plan, selected: Mask | None) -> Columns:
    if layout.named or selected is None or selected in nested_chain(len(max(layout.places, key=len))):
        return {"x": [], "y": [], "text": []}
    x, y = layout.places[selected]
    return {"x": [x], "y": [y], "text": [" ".join(map(str, sorted(max(layout.places, key=len) - selected)))]}


def _links(layout: Plan, chain: Sequence[Mask], selected: Mask | None) -> Columns:
    """Segments from easier to harder tasks: of all when there is room, else of the chain and the selected task."""
    bold = set(pairwise(chain))
    if layout.roomy:
        near = [link for harder in layout.places for link in _steps_to(harder, layout)]
    else:
        own = [] if selected is None else [*_steps_to(selected, layout), *_steps_from(selected)]
        near = [*bold, *(link for link in own if link not in bold)]
    inks, edge = (NEUTRAL, WIDE[0] / 2) if layout.roomy else (SUCCESS, 0.0)
    return {
        "x0": [layout.places[easier][0] + edge for easier, _ in near],
        "y0": [layout.places[easier][1] for easier, _ in near],
        "x1": [layout.places[harder][0] - edge for _, harder in near],
        "y1": [layout.places[harder][1] for _, harder in near],
        "ink": [POLICY_A if link in bold else inks for link in near],
        "width": [4.0 if link in bold else (1.0 if layout.roomy else 1.6) for link in near],
        "alpha": [0.9 if link in bold else (0.3 if layout.roomy else 0.6) for link in near],
    }


def _steps_to(harder: Mask, layout: Plan) -> list[tuple[Mask, Mask]]:
    every = max(layout.places, key=len)
    return [(harder | {missile}, harder) for missile in sorted(every - harder)]


def _steps_from(easier: Mask) -> list[tuple[Mask, Mask]]:
    return [(easier, easier - {missile}) for missile in sorted(easier)]


def _name(numbers: Sequence[int], layout: Plan, linked: bool) -> str:
    """The missiles left, as a node has room for them; 1 … n in the chain of a large lattice."""
    if not layout.roomy and linked and len(numbers) > 1:
        return f"1–{len(numbers)}"
    return ("".join(map(str, numbers)) or "–") if layout.named or linked else ""


def _task_text(numbers: Sequence[int], missiles: int) -> str:
    if len(numbers) == missiles:
        return "target task"
    if not numbers:
        return "navigation only (all missiles masked)"
    return ("missile " if len(numbers) == 1 else "missiles ") + ", ".join(map(str, numbers))


def _draw_nodes(fig: figure, source: ColumnDataSource, layout: Plan) -> None:
    nodes = fig.rect(
        "x", "y", source=source, width="width", height="height", height_units="screen",
        width_units="data" if layout.roomy else "screen",
        border_radius=15 if layout.roomy else (7 if layout.named else 4), fill_color="fill", fill_alpha="fill_alpha",
        line_color="ring", line_width="ring_width", nonselection_alpha=1.0, hover_line_color=SUCCESS,
        hover_fill_alpha=1.0,
    )  # fmt: skip
    nodes.nonselection_glyph = None
    nodes.selection_glyph = None
    offset = -25 if layout.roomy else -24
    common = {"source": source, "text_align": "center", "text_baseline": "middle", "level": "overlay"}
    if not layout.roomy:
        fig.text("x", "y", text="name", text_color="ink", text_font_size="font", text_font_style="bold", **common)
    fig.text("x", "y", text="caption", text_color=NEUTRAL, text_font_size="11px", y_offset=offset, **common)
    fig.add_tools(TapTool(renderers=[nodes]), HoverTool(renderers=[nodes], tooltips=[("", "@task"), ("mask", "@mask")]))


def _draw_missiles(fig: figure, layout: Plan) -> None:
    """Every missile of a task in its colour; a dot where one is masked."""
    every = sorted(max(layout.places, key=len))
    middle = (len(every) + 1) / 2
    for missile in every:
        shift = CHIP_PITCH * (missile - middle)
        common = {"x_offset": shift, "text_align": "center", "text_baseline": "middle", "level": "overlay"}
        flown = [place for mask, place in layout.places.items() if missile not in mask]
        fig.text(
            [x for x, _ in flown], [y for _, y in flown], text=[str(missile)] * len(flown), text_color="#ffffff",
            text_font_size="11px", text_font_style="bold", background_fill_color=missile_colour(missile),
            padding=[5, 3], border_radius=8, **common,
        )  # fmt: skip
        masked = [place for mask, place in layout.places.items() if missile in mask]
        fig.text(
            [x for x, _ in masked], [y for _, y in masked], text=["·"] * len(masked), text_color=NEUTRAL,
            text_font_size="15px", **common,
        )  # fmt: skip
