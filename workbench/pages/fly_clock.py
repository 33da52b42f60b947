"""The clock of the Fly page: play, pause, speed and a rail with the events of both flights."""

from __future__ import annotations

from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

SPEEDS = (1, 10, 30, 60)
"""Seconds of flight per second of watching that a person may choose."""


class FlightClock(JSComponent):
    """Ticks in the browser; `time` follows at the rate at which `shown` acknowledges it."""

    time = param.Number(default=0.0, doc="where the clock is [s]; set by the browser")
    shown = param.Number(default=-1.0, doc="the last time that Python has shown [s]; lets the next one come")
    settled = param.Number(default=0.0, doc="where the clock came to rest [s]; set by the browser")
    jump = param.Number(default=-1.0, doc="set to move the clock [s] and pause")
    redraw = param.Integer(default=0, doc="count up after new figures, so that their cursors are found")
    duration = param.Number(default=1.0, doc="length of the longer flight [s]")
    playing = param.Boolean(default=False)
    speed = param.Integer(default=30)
    speeds = param.List(default=list(SPEEDS), item_type=int)
    marks = param.List(default=[], doc="events: dicts of time [s], who (A or B), colour")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[Any]] = [
        """
.clock { display: flex; align-items: center; gap: 12px; height: 48px; font: 500 14px var(--bokeh-base-font, sans-serif);
  color: var(--panel-on-background-color); font-variant-numeric: tabular-nums; user-select: none }
button { font: inherit; color: inherit; background: none; border: 0; cursor: pointer; padding: 0 }
.play { width: 42px; height: 42px; border-radius: 50%; background: var(--panel-primary-color); color: #fff; flex: none;
  display: grid; place-items: center; transition: filter .15s }
.play:hover { filter: brightness(1.12) }
button:focus-visible, input:focus-visible { outline: 2px solid var(--panel-primary-color); outline-offset: 2px }
.now { min-width: 46px; text-align: right; font-size: 17px }
.end { min-width: 40px; opacity: .65 }
.track { position: relative; flex: 1; height: 34px; display: flex; align-items: center }
.marks { position: absolute; left: 8px; right: 8px; top: 0; bottom: 0; pointer-events: none }
.mark { position: absolute; width: 3px; height: 8px; border-radius: 1.5px; transform: translateX(-50%) }
.mark.above { top: 1px } .mark.below { bottom: 1px }
.rail { -webkit-appearance: none; appearance: none; width: 100%; height: 20px; margin: 0; background: none; cursor: pointer;
  position: relative }
.rail::-webkit-slider-runnable-track { height: 4px; border-radius: 2px; background: linear-gradient(var(--panel-primary-color) 0 0)
  0/var(--share) 100% no-repeat, color-mix(in srgb, currentColor 24%, transparent) }
.rail::-moz-range-track { height: 4px; border-radius: 2px; background: linear-gradient(var(--panel-primary-color) 0 0)
  0/var(--share) 100% no-repeat, color-mix(in srgb, currentColor 24%, transparent) }
.rail::-webkit-slider-thumb { -webkit-appearance: none; width: 16px; height: 16px; border-radius: 50%; margin-top: -6px;
  background: var(--panel-primary-color); border: 0 }
.rail::-moz-range-thumb { width: 16px; height: 16px; border-radius: 50%; background: var(--panel-primary-color); border: 0 }
.speeds { display: flex; border: 1px solid color-mix(in srgb, currentColor 24%, transparent); border-radius: 6px; overflow: hidden }
.speeds button { padding: 0 10px; height: 30px; font-size: 13px }
.speeds button:hover { background: color-mix(in srgb, currentColor 10%, transparent) }
.speeds button.on { background: color-mix(in srgb, var(--panel-primary-color) 24%, transparent); font-weight: 700 }
"""
    ]
