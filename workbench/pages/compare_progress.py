"""The button that flies, the one that ends it, and how far it has come with the time that is left."""

from __future__ import annotations

import html
import time
from collections.abc import Callable, Collection, Iterable

import panel as pn
import panel_material_ui as pmui

from workbench.comparison.queue import ComparisonQueue
from workbench.comparison.work import Work
from workbench.pages.compare_words import COMPARE_CSS
from workbench.terminal import duration

SURE = 0.03
"""Share that must be done before the time that is left can be told."""


class CompareProgress:
    """A batch of work: begun when something is asked for, over when nothing of it is on its way."""

    def __init__(self, queue: ComparisonQueue, fly: Callable[[], None], cancel: Callable[[], None]) -> None:
        self._queue = queue
        self._batch: dict[Work, None] = {}
        self._told: set[Work] = set()
        self._began_s, self._share_then = 0.0, 0.0
        self.fly = pmui.Button(label="Fly", icon="flight_takeoff", color="primary", margin=0, sizing_mode=None)
        self.cancel = pmui.Button(
            label="Cancel", icon="close", variant="outlined", margin=0, sizing_mode=None, visible=False
        )
        self.fly.on_click(lambda _event: fly())
        self.cancel.on_click(lambda _event: cancel())
        self._bar = pmui.LinearProgress(
            variant="determinate", value=0, height=6, margin=0, sizing_mode="stretch_width", visible=False
        )
        self._words = pn.pane.HTML("", stylesheets=[COMPARE_CSS], margin=0, sizing_mode="stretch_width")
        told = pn.Column(
            self._words, self._bar, margin=0, sizing_mode="stretch_width",
            styles={"flex": "1 1 300px", "gap": "4px", "min-width": "0"},
        )  # fmt: skip
        self.items: list[pn.viewable.Viewable] = [self.fly, self.cancel, told]

    @property
    def pending(self) -> list[Work]:
        """Work of the batch that waits or is flown."""
        return [work for work in self._batch if self._queue.state(work) in ("waiting", "flying")]

    def add(self, works: Iterable[Work]) -> None:
        """Watch this work too."""
        if not self.pending:
            self._batch.clear()
        new = list(works)
        self._batch.update(dict.fromkeys(new))
        self._told.difference_update(new)
        self._began_s, self._share_then = time.monotonic(), self._share()

    def forget(self) -> None:
        """Watch nothing any more."""
        self._batch.clear()

    def ended(self) -> list[Work]:
        """Work of the batch that has ended since the last call, well or badly."""
        over = [work for work in self._batch if self._queue.state(work) in ("", "failed") and work not in self._told]
        self._told.update(over)
        return over

    def show(self, unflown: Collection[Work], idle: str) -> None:
        """Bring bar, words and buttons up to date.

        Args:
            unflown: what the grid lacks.
            idle: HTML that is told while nothing is flown.
        """
        pending = self.pending
        self._bar.visible = self.cancel.visible = bool(pending)
        waiting = [work for work in unflown if work not in pending]
        number = len({work.name for work in waiting})
        self.fly.param.update(
            label=f"Fly {number} × {next(iter(waiting)).episodes}" if number else "Nothing left to fly",
            disabled=not number,
        )
        if not pending:
            self._words.object = idle
            return
        share = self._share()
        self._bar.value = round(100.0 * share)
        left = ""
        if share - self._share_then > SURE:
            seconds = (time.monotonic() - self._began_s) * (1.0 - share) / (share - self._share_then)
            left = f", about {duration(seconds)} left"
        now = html.escape(next((work.policy for work in pending if self._queue.state(work) == "flying"), "starting"))
        self._words.object = f"{100.0 * share:.0f} %{left} · {len(pending)} of {len(self._batch)} to go · {now}"

    def _share(self) -> float:
        """What is done of the batch, by weight."""
        total = sum(work.weight for work in self._batch)
        left = 0.0
        for work in self._batch:
            standing = self._queue.standing(work)
            if standing is not None and standing.state != "failed":
                left += work.weight * (1.0 - standing.share)
        return 1.0 - left / total if total else 0.0
