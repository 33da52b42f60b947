"""What stands in the place of contents that are still being read."""

from __future__ import annotations

import html

import panel as pn

CSS = """
.waiting { display: grid; gap: 14px; padding: 18px 0; color: var(--panel-on-background-color);
  font: 14px var(--bokeh-base-font, sans-serif) }
.waiting i { height: 92px; border-radius: 8px; background: currentColor; opacity: .07;
  animation: breathe 1.6s infinite }
.waiting i:nth-child(3) { animation-delay: .2s } .waiting i:nth-child(4) { animation-delay: .4s }
@keyframes breathe { 50% { opacity: .03 } }
@media (prefers-reduced-motion: reduce) { .waiting i { animation: none } }
"""


def waiting(sentence: str) -> pn.pane.HTML:
    """A sentence over three grey places; nothing moves for those who ask for that."""
    block = f'<div class="waiting" role="status"><span>{html.escape(sentence)}</span><i></i><i></i><i></i></div>'
    return pn.pane.HTML(block, stylesheets=[CSS], margin=0, sizing_mode="stretch_width")
