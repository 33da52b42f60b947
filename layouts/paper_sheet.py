"""What the pictures of the paper's figures have in common: the sheet, its inks, the file it becomes."""

from __future__ import annotations

import io
from typing import Literal

import matplotlib
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image
from PIL.PngImagePlugin import PngInfo

INK, FAINT, GRID = "#1f2733", "#5b6470", "#d5dbe4"
DPI = 120
SALT = "paper"


def sheet(title: str, caption: str, size_in: tuple[float, float]) -> Figure:
    """An empty white sheet with a title above and a caption below."""
    # Not pyplot: it would keep every figure, and look for a screen.
    figure = Figure(figsize=size_in, facecolor="white")
    FigureCanvasAgg(figure)
    width, height = size_in
    figure.text(0.2 / width, 1.0 - 0.18 / height, title, fontsize=13, fontweight="bold", color=INK, va="top")
    figure.text(0.2 / width, 0.12 / height, caption, fontsize=8.5, color=FAINT, va="bottom", linespacing=1.5)
    return figure


def name(axes: Axes, text: str) -> None:
    """A panel's name, above it to the left."""
    axes.set_title(text, loc="left", fontsize=10.5, color=INK)


def plain(axes: Axes, size: float = 8.5) -> None:
    """Faint grid, no frame, small figures of this size [points], names of the axes a little larger."""
    axes.grid(color=GRID, linewidth=0.6)
    axes.set_axisbelow(True)
    axes.tick_params(colors=INK, labelsize=size, length=0)
    for side, spine in axes.spines.items():
        spine.set_visible(side in ("left", "bottom"))
        spine.set_color(GRID)
    for label in (axes.xaxis.label, axes.yaxis.label):
        label.set(color=INK, fontsize=size + 0.5)


def picture(figure: Figure, kind: Literal["png", "svg"], source: str = "") -> bytes:
    """The figure as the content of a file; equal figures give equal bytes.

    Args:
        figure: what was drawn.
        kind: `png` or `svg`.
        source: kept in the file: what the picture was drawn from.
    """
    content = io.BytesIO()
    metadata = {"Date": None} if kind == "svg" else {"Software": None}
    with matplotlib.rc_context({"svg.hashsalt": SALT}):
        figure.savefig(content, format=kind, dpi=DPI, metadata=metadata | {"Description": source})
    return content.getvalue() if kind == "svg" else _of_few_colours(content, source)


def _of_few_colours(content: io.BytesIO, source: str) -> bytes:
    """The same picture in 256 colours: many thin, half transparent lines make a large file otherwise."""
    told = PngInfo()
    told.add_text("Description", source)
    small = io.BytesIO()
    whole = Image.open(content).convert("RGB")
    whole.quantize(256, dither=Image.Dither.NONE).save(small, "png", optimize=True, pnginfo=told)
    return small.getvalue()
