"""What a person has chosen on the Live page, as it stands in the address: never trusted, never lost."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from layouts.learning_panels import PANELS
from workbench.run_folder import is_run_id

X_AXES: Final = {"steps": "steps", "time": "wall time", "epoch": "epochs"}
"""What curves are drawn over, and how that is called."""
MOST_BESIDE: Final = 7
"""Runs whose curves may lie beside those of the opened one; each has its ink."""
TEXT_LIMIT: Final = 200


@dataclass(frozen=True)
class LiveSettings:
    """One view of the Live page."""

    run: str = ""
    """Id of the opened run; empty opens the newest one under way."""
    beside: tuple[str, ...] = ()
    """Ids of the runs whose curves are drawn as well."""
    x: str = "steps"
    smooth: int = 0
    """Weight of the past in the exponential mean [%], 0..99."""
    without: tuple[str, ...] = ()
    """Panels that are not shown, by their key."""
    hidden: tuple[str, ...] = ()
    """Curves that are taken out of their panel, by name."""

    def toggled(self, run_id: str) -> LiveSettings:
        """With this run's curves drawn as well if they were not, and the other way round."""
        others = tuple(each for each in self.beside if each != run_id)
        if others == self.beside and run_id != self.run:
            others = (*others, run_id)[-MOST_BESIDE:]
        return LiveSettings(self.run, others, self.x, self.smooth, self.without, self.hidden)

    def opening(self, run_id: str) -> LiveSettings:
        """With this run opened."""
        others = tuple(each for each in self.beside if each != run_id)
        return LiveSettings(run_id, others, self.x, self.smooth, self.without, self.hidden)

    def to_query(self) -> dict[str, str]:
        """The values of the address; what is as it always is stands as empty and is left out."""
        return {
            "run": self.run,
            "with": ",".join(self.beside),
            "x": "" if self.x == "steps" else self.x,
            "smooth": str(self.smooth) if self.smooth else "",
            "without": ",".join(self.without),
            "hidden": ",".join(self.hidden),
        }


def read_settings(query: Mapping[str, str]) -> LiveSettings:
    """The view an address asks for; what is not legal in it is left as it always is."""
    run, x, smooth = query.get("run", "")[:TEXT_LIMIT], query.get("x", ""), query.get("smooth", "")
    beside = [each for each in _split(query.get("with", "")) if is_run_id(each) and each != run]
    keys = [panel.key for panel in PANELS]
    names = {curve.name for panel in PANELS for curve in panel.curves}
    without = tuple(each for each in _split(query.get("without", "")) if each in keys)
    return LiveSettings(
        run=run,
        beside=tuple(beside[:MOST_BESIDE]),
        x=x if x in X_AXES else "steps",
        smooth=min(int(smooth), 99) if smooth.isascii() and smooth.isdigit() and len(smooth) < 4 else 0,
        without=without if len(without) < len(keys) else (),
        hidden=tuple(each for each in _split(query.get("hidden", "")) if each in names),
    )


def _split(text: str) -> list[str]:
    return list(dict.fromkeys(part for part in text.split(",")[:50] if part))
