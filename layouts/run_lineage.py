"""Which policy guided which: a line from the first guide over the stages of a run to the runs it guided."""

from __future__ import annotations

import html
from collections.abc import Sequence
from dataclasses import dataclass

from layouts.theme import NEUTRAL

LINEAGE_CSS = """
:host { color: var(--panel-on-background-color); font: 13px/1.35 var(--bokeh-base-font, sans-serif) }
ol { list-style: none; display: flex; flex-wrap: wrap; gap: 6px 22px; margin: 0; padding: 0; align-items: stretch }
li { position: relative; border: 1.5px solid var(--ink); border-radius: 9px; padding: 4px 10px; min-width: 84px;
  background: color-mix(in srgb, var(--ink) 11%, transparent) }
li:not(:last-child)::after { content: "→"; position: absolute; right: -19px; top: 50%;
  transform: translateY(-50%); opacity: .7 }
li.here { border-width: 2.5px }
li b { display: block; font-weight: 650; overflow-wrap: anywhere }
li small { opacity: .8; font-size: 12px }
a { color: inherit }
p { margin: 8px 0 0 }
"""


@dataclass(frozen=True)
class Link:
    """One policy on the way."""

    title: str
    words: str = ""
    href: str = ""
    """Address of the run it comes from; empty for what is no run."""
    ink: str = NEUTRAL
    here: bool = False
    """A stage of the run that is looked at."""


def lineage(before: Sequence[Link], stages: Sequence[Link], after: Sequence[Link]) -> str:
    """HTML of the line of guides `before` the run, its `stages`, and of what it guided `after`; texts are escaped."""
    chain = "".join(_item(link) for link in [*before, *stages])
    guided = ", ".join(_titled(link) for link in after)
    said = f"<p>Its policy guided: {guided}</p>" if after else ""
    return f"<ol>{chain}</ol>{said}"


def _item(link: Link) -> str:
    kind = ' class="here"' if link.here else ""
    return f'<li{kind} style="--ink: {link.ink}"><b>{_titled(link)}</b><small>{html.escape(link.words)}</small></li>'


def _titled(link: Link) -> str:
    title = html.escape(link.title)
    return f'<a href="{html.escape(link.href, quote=True)}">{title}</a>' if link.href else title
