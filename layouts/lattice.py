"""The lattice of tasks: every mask, by number of missiles left, with the chain of Algorithm 3 (Fig. 5)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from itertools import combinations, pairwise

from bokeh.models import ColumnDataSource, HoverTool, TapTool
from bokeh.plotting import figure

from layouts.theme import NEUTRAL, POLICY_A, SUCCESS

Mask = frozenset[int]

NODE_SIZE = 46


def masks_by_level(missiles: int) -> list[list[Mask]]:
    """All 2^n masks; entry k holds those that leave k missiles, in the order of the numbers that are left."""
    every = range(1, missiles + 1)
    return [
        [frozenset(every) - frozenset(kept) for kept in combinations(every, count)] for count in range(missiles + 1)
    ]


def nested_chain(missiles: int) -> list[Mask]:
    """Algorithm 3's chain of Table 1, from the easiest task (all masked) to the target (none masked)."""
    return [frozenset(range(count + 1, missiles + 1)) for count in range(missiles + 1)]


def mask_text(mask: Iterable[int]) -> str:
    """A mask as in `--mask`: `"3,4"`; empty for none."""
    return ",".join(str(number) for number in sorted(mask))


def lattice_figure(
    missiles: int = 4,
    chain: list[Mask] | None = None,
    selected: Mask | None = None,
    success: Mapping[Mask, float] | None = None,
    height: int = 420,
) -> tuple[figure, ColumnDataSource]:
    """The lattice and the source of its nodes; a tap selects one, its `mask` column is text as in `--mask`.

    Args:
        missiles: number of missiles n of the target task; 2^n nodes are drawn.
        chain: masks from the easiest task to the target; the default is the nested chain of Table 1.
        selected: the mask to highlight.
        success: success rate 0 to 1 by mask, written under the node's name where known.
        height: height of the figure [px].
    """
    levels = masks_by_level(missiles)
    chain = nested_chain(missiles) if chain is None else chain
    fig = figure(
        height=height,
        sizing_mode="stretch_width",
        tools="",
        toolbar_location=None,
        x_range=(-0.6, missiles + 0.6),
        y_range=(-0.62, 0.62),
    )
    fig.grid.visible = fig.yaxis.visible = False
    fig.outline_line_color = None
    fig.xaxis.ticker = list(range(missiles + 1))
    fig.xaxis.axis_label = "missiles to evade"
    places = {mask: place for level, masks in enumerate(levels) for mask, place in _column(level, masks)}
    _draw_edges(fig, places, chain)
    source = ColumnDataSource(lattice_columns(places, chain, selected, success or {}))
    _draw_nodes(fig, source)
    return fig, source


def lattice_columns(
    places: Mapping[Mask, tuple[float, float]],
    chain: list[Mask],
    selected: Mask | None,
    success: Mapping[Mask, float],
) -> dict[str, list[object]]:
    """Columns of the nodes: place, mask, the numbers left, caption, and how each is drawn."""
    masks, every = list(places), max(places, key=len)
    kept = [sorted(every - mask) for mask in masks]
    return {
        "x": [places[m][0] for m in masks],
        "y": [places[m][1] for m in masks],
        "mask": [mask_text(m) for m in masks],
        "name": ["".join(map(str, numbers)) or "–" for numbers in kept],
        "caption": [f"{success[m]:.1%}" if m in success else "" for m in masks],
        "task": [_task_text(numbers, len(every)) for numbers in kept],
        "fill": [POLICY_A if m in chain else NEUTRAL for m in masks],
        "fill_alpha": [0.9 if m in chain else 0.16 for m in masks],
        "ring": [SUCCESS if m == selected else (POLICY_A if m in chain else NEUTRAL) for m in masks],
        "ring_width": [5.0 if m == selected else 1.5 for m in masks],
        "ink": ["#ffffff" if m in chain else NEUTRAL for m in masks],
    }


def _column(level: int, masks: list[Mask]) -> list[tuple[Mask, tuple[float, float]]]:
    gap = 1.0 / max(len(masks), 4)
    top = gap * (len(masks) - 1) / 2
    return [(mask, (float(level), top - gap * row)) for row, mask in enumerate(masks)]


def _task_text(numbers: list[int], missiles: int) -> str:
    if len(numbers) == missiles:
        return "target task"
    if not numbers:
        return "navigation only (all missiles masked)"
    return ("missile " if len(numbers) == 1 else "missiles ") + ", ".join(map(str, numbers))


def _draw_edges(fig: figure, places: Mapping[Mask, tuple[float, float]], chain: list[Mask]) -> None:
    links = set(pairwise(chain))
    for harder, (x_to, y_to) in places.items():
        for easier, (x_from, y_from) in places.items():
            if len(easier) == len(harder) + 1 and harder < easier:
                bold = (easier, harder) in links
                fig.line(
                    [x_from, x_to],
                    [y_from, y_to],
                    line_width=4.0 if bold else 1.0,
                    color=POLICY_A if bold else NEUTRAL,
                    alpha=0.9 if bold else 0.3,
                )


def _draw_nodes(fig: figure, source: ColumnDataSource) -> None:
    nodes = fig.scatter(
        "x",
        "y",
        source=source,
        size=NODE_SIZE,
        fill_color="fill",
        fill_alpha="fill_alpha",
        line_color="ring",
        line_width="ring_width",
        nonselection_alpha=1.0,
        hover_line_color=SUCCESS,
        hover_fill_alpha=1.0,
    )
    nodes.nonselection_glyph = None
    nodes.selection_glyph = None
    common = {"source": source, "text_align": "center", "text_baseline": "middle", "level": "overlay"}
    fig.text("x", "y", text="name", text_color="ink", text_font_size="13px", text_font_style="bold", **common)
    fig.text("x", "y", text="caption", text_color=NEUTRAL, text_font_size="11px", y_offset=-33, **common)
    fig.add_tools(TapTool(renderers=[nodes]), HoverTool(renderers=[nodes], tooltips=[("", "@task"), ("mask", "@mask")]))
