"""The clock of the Fly page: play, pause, speed and a rail with the events of both flights."""

from __future__ import annotations

from pathlib import Path
from typing import ClassVar

import param
from panel.custom import JSComponent

from workbench.pages.fly_look import SPEEDS


class FlightClock(JSComponent):
    """Ticks in the browser; `time` follows at the rate at which `shown` acknowledges it."""

    time = param.Number(default=0.0, doc="where the clock is [s]; set by the browser")
    shown = param.Number(default=-1.0, doc="the last time that Python has shown [s]; lets the next one come")
    settled = param.Number(default=0.0, doc="where the clock came to rest [s]; set by the browser")
    jump = param.List(default=[0.0, 0], doc="set to move the clock: where to [s], and a count, to go there again")
    duration = param.Number(default=1.0, doc="length of the longer flight [s]")
    playing = param.Boolean(default=False)
    speed = param.Integer(default=30)
    speeds = param.List(default=list(SPEEDS), item_type=int)
    marks = param.List(default=[], doc="events: dicts of time [s], who (A or B), colour")

    def move(self, time_s: float) -> None:
        """Pause and go to this time [s]."""
        self.jump = [time_s, self.jump[1] + 1]

    _debounce: ClassVar[int] = 0
    """Panel gathers changes for 50 ms before it tells of them; this clock sends the next only after an answer."""
    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]
