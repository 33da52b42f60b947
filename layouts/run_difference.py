"""Configurations of runs side by side, what differs in front; every text is escaped."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence

from layouts.theme import POLICY_B

MISSING = "–"
DIFFERENCE_CSS = f"""
:host {{ color: var(--panel-on-background-color); font: 13px/1.4 var(--bokeh-base-font, sans-serif) }}
.scroll {{ overflow-x: auto; max-height: 420px; overflow-y: auto; scrollbar-width: thin }}
table {{ border-collapse: collapse; min-width: 100% }}
th, td {{ text-align: left; padding: 4px 14px 4px 0; vertical-align: top; overflow-wrap: anywhere; min-width: 90px }}
thead th {{ border-bottom: 1px solid color-mix(in srgb, currentColor 30%, transparent); font-weight: 650 }}
tbody th {{ font-weight: 400; opacity: .75; white-space: nowrap; overflow-wrap: normal }}
tr.differs th {{ opacity: 1; font-weight: 600 }}
tr.differs td {{ background: color-mix(in srgb, {POLICY_B} 16%, transparent); padding-left: 8px }}
i {{ display: inline-block; width: 18px; border-top: 3px solid var(--ink); vertical-align: middle; margin-right: 7px }}
p {{ margin: 0 }}
"""


def difference_table(
    titles: Sequence[tuple[str, str]], fields: Mapping[str, Sequence[str]], every_field: bool = False
) -> str:
    """An HTML table with a column for each run and a row for each field.

    Args:
        titles: title and ink of each run.
        fields: the value of every run by the name of the field; MISSING where a run has none.
        every_field: also the fields in which all agree, behind the others.
    """
    different = {name: values for name, values in fields.items() if len(set(values)) > 1}
    alike = {name: values for name, values in fields.items() if name not in different}
    rows = [_row(name, values, "differs") for name, values in different.items()]
    if every_field:
        rows += [_row(name, values, "") for name, values in alike.items()]
    head = "".join(f'<th scope="col"><i style="--ink: {ink}"></i>{html.escape(title)}</th>' for title, ink in titles)
    said = "" if different else "<p>These runs were configured alike.</p>"
    table = f'<table><thead><tr><th scope="col">Field</th>{head}</tr></thead><tbody>{"".join(rows)}</tbody></table>'
    return f'{said}<div class="scroll">{table}</div>'


def _row(name: str, values: Sequence[str], kind: str) -> str:
    cells = "".join(f"<td>{html.escape(value)}</td>" for value in values)
    return f'<tr class="{kind}"><th scope="row">{html.escape(name)}</th>{cells}</tr>'
