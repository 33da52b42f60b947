"""Algorithms of Fig. 8 and 9 as chips; a click hides one in all charts."""

from __future__ import annotations

from typing import Any, ClassVar

import param
from panel.custom import JSComponent


# Not "…Legend": Panel's theme takes whatever is called so for one of Bokeh's, and sets what it has not.
class AlgorithmChips(JSComponent):
    """Chips in the inks of their curves."""

    entries = param.List(default=[], item_type=dict, doc="name, label and ink")
    hidden = param.List(default=[], item_type=str, doc="names of those that are hidden")

    _esm = """
export function render({model}) {
  const root = document.createElement("div")
  root.setAttribute("role", "group")
  root.setAttribute("aria-label", "Algorithms: click to hide or show")
  function draw() {
    const focused = [...root.children].indexOf(root.getRootNode().activeElement)
    root.replaceChildren(...model.entries.map((entry) => {
      const chip = document.createElement("button"), off = model.hidden.includes(entry.name)
      chip.type = "button"
      chip.textContent = entry.label
      chip.style.setProperty("--ink", entry.ink)
      chip.setAttribute("aria-pressed", String(!off))
      const others = model.hidden.filter((name) => name !== entry.name)
      chip.onclick = () => { model.hidden = off ? others : [...others, entry.name] }
      return chip
    }))
    if (focused >= 0) { root.children[focused].focus() }
  }
  model.on(["entries", "hidden"], draw)
  draw()
  return root
}
"""
    _stylesheets: ClassVar[list[Any]] = [
        """
:host { font: 13px var(--bokeh-base-font, sans-serif) }
div { display: flex; gap: 8px; flex-wrap: wrap }
button { font: 600 13px var(--bokeh-base-font, sans-serif); color: var(--panel-on-background-color); cursor: pointer;
  border-radius: 8px; padding: 3px 11px; border: 2px solid var(--ink);
  background: color-mix(in srgb, var(--ink) 18%, transparent) }
button[aria-pressed=false] { border-style: dashed; background: none; opacity: .55; text-decoration: line-through }
button:focus-visible { outline: 2px solid var(--panel-primary-color); outline-offset: 1px }
"""
    ]
