"""The azimuth curves of an animation (Fig. 12): faint as they will be, bright as far as they are, a cursor."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from layouts.animation_camera import Panel, Points
from layouts.azimuth import azimuth_columns
from layouts.theme import missile_colour, rgb
from sim.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TICKS_DEG = (-180, -90, 0, 90, 180)
TICK_STEPS_S = (1, 2, 5, 10, 20, 50, 100, 200, 500)
TICK_ROOM_PX = 90
QUIET, SOFT = "#9aa7ba", "#293446"


@dataclass(frozen=True)
class AzimuthPlot:
    """A plot in a panel of the picture: azimuth [deg] over a window of time [s]."""

    flight: Trajectory
    panel: Panel
    window_s: tuple[float, float]

    def x(self, time_s: float | NDArray[np.float64]) -> NDArray[np.float64]:
        """Time on the panel [pixels]."""
        low, high = self.window_s
        return self.panel.left + self.panel.width * (np.asarray(time_s) - low) / (high - low)

    def y(self, azimuth_deg: float | NDArray[np.float64]) -> NDArray[np.float64]:
        """Azimuth on the panel [pixels]."""
        return self.panel.bottom + self.panel.height * (np.asarray(azimuth_deg) + 180.0) / 360.0

    def curves(self) -> dict[int, tuple[NDArray[np.float64], Points]]:
        """Of every launched missile the times [N] and the places [N, 2] of its curve, NaN where it breaks."""
        columns = azimuth_columns(self.flight)
        time_s = columns["time_s"]
        made = {}
        for missile in self.flight.missiles:
            azimuth = columns[f"missile_{missile.number}_deg"]
            flown = np.flatnonzero(np.isfinite(azimuth))
            if flown.size:
                part = slice(flown[0], flown[-1] + 1)
                made[missile.number] = time_s[part], np.stack([self.x(time_s[part]), self.y(azimuth[part])], axis=1)
        return made

    def draw_frame(self, axes: Axes, title: str) -> None:
        """What does not move: scales, lines at ±90°, title, the whole curves, faint."""
        right = self.panel.left + self.panel.width
        for tick in TICKS_DEG:
            beam = abs(tick) == 90
            style = {"color": QUIET if beam else SOFT, "linewidth": 0.8, "linestyle": (0, (3, 3)) if beam else "-"}
            axes.plot([self.panel.left, right], [self.y(tick)] * 2, **style)
            axes.text(self.panel.left - 7, float(self.y(tick)), f"{tick}".replace("-", "−"), fontsize=7.5, color=QUIET,
                      ha="right", va="center")  # fmt: skip
        for time_s in self._ticks():
            axes.text(float(self.x(time_s)), self.panel.bottom - 8, f"{time_s:.0f} s", fontsize=7.5, color=QUIET,
                      ha="center", va="top")  # fmt: skip
        axes.text(self.panel.left, self.panel.bottom + self.panel.height + 9, title, fontsize=8.5, color=QUIET)
        for number, (_time, places) in self.curves().items():
            axes.plot(*places.T, color=missile_colour(number), alpha=0.3, linewidth=1.3)

    def moving(self, time_s: float) -> tuple[list[Points], list[tuple[float, ...]], Points, list[tuple[float, ...]]]:
        """Curves so far [N, 2] with their colours, and a dot [M, 2] where a missile is seen now, with its colour."""
        lines, line_colours, dots, dot_colours = [], [], [], []
        for number, (times, places) in self._known.items():
            ink = tuple(value / 255 for value in rgb(missile_colour(number)))
            now = int(np.searchsorted(times, time_s, side="right"))
            if now:
                lines.append(places[:now])
                line_colours.append((*ink, 1.0))
            if now and time_s <= times[-1] and np.isfinite(places[now - 1]).all():
                dots.append(places[now - 1])
                dot_colours.append((*ink, 1.0))
        return lines, line_colours, np.array(dots).reshape(-1, 2), dot_colours

    def cursor(self, time_s: float) -> Points:
        """The line of the clock [2, 2], held at the ends of the window."""
        x = float(self.x(min(max(time_s, self.window_s[0]), self.window_s[1])))
        return np.array([(x, self.panel.bottom - 3.0), (x, self.panel.bottom + self.panel.height + 3.0)])

    def __post_init__(self) -> None:
        object.__setattr__(self, "_known", self.curves())

    def _ticks(self) -> NDArray[np.float64]:
        low, high = self.window_s
        wanted = max(self.panel.width / TICK_ROOM_PX, 2.0)
        step = next((step for step in TICK_STEPS_S if (high - low) / step <= wanted), TICK_STEPS_S[-1])
        return np.arange(np.ceil(low / step) * step, high, step)
