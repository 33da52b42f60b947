"""What every figure offers to save in its toolbar: PNG, SVG, and its numbers as CSV; all made in the browser."""

from __future__ import annotations

import base64

from bokeh.models import ColumnDataSource, CustomAction, CustomJS, SaveTool
from bokeh.plotting import figure


def _icon(strokes: str) -> str:
    """A sheet of paper with these strokes on it."""
    shape = (
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 24 24'><path fill='none' stroke='#7d8794' "
        f"stroke-width='1.7' d='M6 3h8l4 4v14H6z M14 3v5h4 {strokes}'/></svg>"
    )
    return "data:image/svg+xml;base64," + base64.b64encode(shape.encode()).decode()


CSV_ICON = _icon("M9 12h6 M9 15h6 M9 18h6")
SVG_ICON = _icon("M9 18c0-8 6 0 6-7")

_SAVE = """
const save = (content, ending) => {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = name + ending; link.click(); setTimeout(() => URL.revokeObjectURL(link.href), 1000);
};
"""

_CSV_CODE = (
    _SAVE
    + """
const names = sources.flatMap((s) => Object.keys(s.data));
const rows = Math.max(...sources.map((s) => s.get_length() ?? 0));
const quoted = (v) => /[",\\n\\r]/.test(v) ? `"${v.replaceAll('"', '""')}"` : v;
// A text that a spreadsheet would work out gets an apostrophe; numbers stay numbers.
const plain = (v) => typeof v === "string" && /^[=+\\-@\\t\\r\\n＝＋－＠]/.test(v) ? "'" + v : String(v);
const cell = (v) => v === undefined || v === null || Number.isNaN(v) ? "" : quoted(plain(v));
const lines = [names.map(cell).join(",")];
for (let i = 0; i < rows; i++)
  lines.push(sources.flatMap((s) => Object.values(s.data).map((c) => cell(c[i]))).join(","));
save(new Blob([lines.join("\\n") + "\\n"], {type: "text/csv"}), ".csv");
"""
)

# The figure is painted once more, by strokes instead of pixels; what is on the screen stays as it is.
_SVG_CODE = (
    _SAVE
    + """
const view = Bokeh.index.find_one(figure);
view?.export("svg").to_blob().then((drawing) => save(drawing, ".svg"));
"""
)


def add_downloads(fig: figure, name: str, *sources: ColumnDataSource) -> None:
    """Save buttons in the toolbar: `name`.png, `name`.svg, and the sources side by side as `name`.csv."""
    savers = [tool for tool in fig.tools if isinstance(tool, SaveTool)]
    if not savers:
        savers = [SaveTool()]
        fig.add_tools(*savers)
    for tool in savers:
        tool.update(filename=name, description="Download PNG")
    drawing = CustomJS(args={"figure": fig, "name": name}, code=_SVG_CODE)
    numbers = CustomJS(args={"sources": list(sources), "name": name}, code=_CSV_CODE)
    fig.add_tools(
        CustomAction(icon=SVG_ICON, description="Download SVG", callback=drawing),
        CustomAction(icon=CSV_ICON, description="Download CSV", callback=numbers),
    )
