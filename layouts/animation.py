"""An engagement as moving pictures, drawn without a browser: 3-D view, azimuth curves, clock and outcome.

Equal flights give equal pictures. All measures are pixels of a 1280 x 720 picture; others are that one, scaled.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from layouts.animation_camera import Camera, Points
from layouts.animation_curves import QUIET, SOFT
from layouts.animation_scene import Lines, draw_ends, field_corners, field_lines, path_lines, sight_lines, solids
from layouts.animation_stage import HEIGHT, WIDTH, Stage, stages_of
from layouts.animation_time import frame_times
from layouts.captions import clock_text, distance_text, name_text, outcome_text
from layouts.picture_text import picture_text
from layouts.theme import DARK, FAILURE, SUCCESS, Rgb, missile_colour
from sim.trajectory import Trajectory

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

HOLD_S = 2.0
"""The last picture stays so long, so that the outcome can be read."""

BRIGHT = "#e6ecf5"
NAME_LENGTH = {1: 84, 2: 36, 3: 34}
NAME_POINTS = {1: 13.0, 2: 13.0, 3: 9.5}
"""Characters of a name and their size, by how many flights share the picture."""

Picture = NDArray[np.uint8]


def pictures(flights: Sequence[Trajectory], seconds: float, per_s: int, height: int) -> Iterator[Picture]:
    """The frames [height, width, 3] of an animation of up to three flights, `frame_count` of them.

    Most of them show the time in which missiles fly, and none runs slower than life.

    Args:
        flights: one flight, or up to three from the same initial state, side by side.
        seconds: longest duration of the animation, with the time in which the last picture is held.
        per_s: pictures per second.
        height: of a picture [pixels]; the width is 16/9 of it.
    """
    count = frame_count(flights, seconds, per_s)
    held = min(round(HOLD_S * per_s), count - 2)
    times = frame_times(flights, count - held)
    stages = stages_of(flights, times, per_s)
    film = Film(stages, height)
    for frame, time_s in enumerate(times):
        pace = (times[frame] - times[frame - 1]) * per_s if frame else (times[1] - times[0]) * per_s
        shown = film.draw(frame, float(time_s), float(pace))
        for _copy in range(1 + (held if frame == len(times) - 1 else 0)):
            yield shown


def frame_count(flights: Sequence[Trajectory], seconds: float, per_s: int) -> int:
    """How many pictures an animation has."""
    flown_s = max(flight.duration_s for flight in flights)
    return max(4, round(min(seconds, flown_s + HOLD_S) * per_s))


class Film:
    """The sheet all pictures are drawn on: what stands still is drawn once, the rest anew for every picture."""

    def __init__(self, stages: Sequence[Stage], height: int) -> None:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.collections import LineCollection, PolyCollection
        from matplotlib.figure import Figure

        self._stages = stages
        self._figure: Figure = Figure(figsize=(WIDTH / 100, HEIGHT / 100), dpi=100 * height / HEIGHT)
        self._canvas = FigureCanvasAgg(self._figure)
        self._axes: Axes = self._figure.add_axes((0, 0, 1, 1))
        self._axes.set(xlim=(0, WIDTH), ylim=(0, HEIGHT))
        self._axes.set_axis_off()
        self._figure.set_facecolor(_share(DARK.background))
        for stage in stages:
            _draw_header(self._axes, stage, len(stages))
            stage.plot.draw_frame(self._axes, "missile azimuth [deg]")
        for stage in stages[1:]:
            self._axes.plot([stage.panel.left] * 2, [14, HEIGHT - 74], color=SOFT, linewidth=1)
        self._canvas.draw()
        self._still = self._canvas.copy_from_bbox(self._figure.bbox)
        self._lines = self._axes.add_collection(LineCollection([], capstyle="round", joinstyle="round"), autolim=False)
        self._faces = self._axes.add_collection(PolyCollection([], linewidths=0.4), autolim=False)

    def draw(self, frame: int, time_s: float, pace: float) -> Picture:
        """The picture [height, width, 3] of a moment; `pace` is how many times faster than life it runs."""
        self._canvas.restore_region(self._still)
        for stage in self._stages:
            self._draw_scene(stage, stage.cameras[frame], time_s)
            self._draw_curves(stage, time_s)
            self._write_state(stage, time_s)
        self._write_clock(time_s, pace)
        return np.asarray(self._canvas.buffer_rgba())[..., :3].copy()

    def _draw_scene(self, stage: Stage, view: Camera, time_s: float) -> None:
        from matplotlib.patches import Rectangle

        panel, place = stage.panel, stage.flight.task.scenario.battlefield
        frame = Rectangle((panel.left, panel.bottom), panel.width, panel.height, transform=self._axes.transData)
        self._fill([view.outline(field_corners(place))], np.array([_share(DARK.field)]), frame)
        lines = field_lines(view, place)
        lines += [line for body in stage.bodies for line in path_lines(view, body, time_s)]
        lines += sight_lines(view, stage.bodies, time_s)
        self._stroke(lines, frame)
        ends = draw_ends(self._axes, view, stage.flight, stage.bodies, time_s)
        for artist in ends:
            artist.set_clip_path(frame)
            self._axes.draw_artist(artist)
            artist.remove()
        triangles, colours = solids(view, stage.bodies, time_s)
        self._fill(triangles, colours, frame)
        self._name_bodies(stage, view, time_s)

    def _stroke(self, lines: Lines, frame: Any) -> None:
        self._lines.set_segments([points for points, _, _ in lines])
        self._lines.set_color([colour for _, colour, _ in lines])
        self._lines.set_linewidth([0.72 * width for _, _, width in lines])
        self._lines.set_clip_box(None)
        self._lines.set_clip_path(frame)
        self._axes.draw_artist(self._lines)

    def _fill(self, faces: list[Points], colours: NDArray[np.float64], frame: Any) -> None:
        if faces:
            self._faces.set_verts(faces)
            self._faces.set_facecolor(colours)
            self._faces.set_edgecolor(colours)
            self._faces.set_clip_path(frame)
            self._axes.draw_artist(self._faces)

    def _name_bodies(self, stage: Stage, view: Camera, time_s: float) -> None:
        panel = stage.panel
        for body in stage.bodies:
            if not body.flies(time_s):
                continue
            x, y = view.screen(body.path.position(time_s))
            name = {"evader": stage.letter, "interceptor": "interceptor"}.get(body.name, body.name)
            inside = 0 < x - panel.left < panel.width - 90 and 0 < y - panel.bottom < panel.height - 30
            if name and inside:
                shift = (16, -26) if body.name == "interceptor" else (12, 12)
                self._write(x + shift[0], y + shift[1], name, _share(body.ink), 9.0, weight="bold")

    def _draw_curves(self, stage: Stage, time_s: float) -> None:
        lines, colours, dots, dot_colours = stage.plot.moving(time_s)
        drawn: Lines = [(points, colour, 2.2) for points, colour in zip(lines, colours, strict=True)]
        self._stroke([*drawn, (stage.plot.cursor(time_s), (0.9, 0.93, 0.96, 1.0), 1.6)], None)
        if len(dots):
            artist = self._axes.scatter(*dots.T, s=18, c=dot_colours, linewidths=0)
            self._axes.draw_artist(artist)
            artist.remove()

    def _write_state(self, stage: Stage, time_s: float) -> None:
        """The missiles in flight with their distance, and the outcome once it is there."""
        flight, panel = stage.flight, stage.panel
        over = time_s >= flight.duration_s - 1e-9
        words = outcome_text(flight) if over else _flying_text(flight, time_s)
        ink = (SUCCESS if flight.success else FAILURE) if over else QUIET
        self._write(panel.left + 22, HEIGHT - 49, words, ink, 11.0, weight="bold" if over else "normal")
        row = panel.bottom + 12
        index = int(np.searchsorted(flight.time_s, time_s).clip(0, len(flight.time_s) - 1))
        for missile in reversed(flight.missiles):
            distance = float(missile.range_m[index])
            if np.isfinite(distance) and not over:
                colour = missile_colour(missile.number)
                self._write(panel.left + 22, row, f"missile {missile.number}", colour, 9.0, weight="bold")
                self._write(panel.left + 100, row, distance_text(distance), BRIGHT, 9.0)
                row += 17

    def _write_clock(self, time_s: float, pace: float) -> None:
        middle = WIDTH - 70
        self._write(middle, HEIGHT - 40, clock_text(time_s), BRIGHT, 21.0, ha="center", weight="bold")
        if pace > 0:
            self._write(middle, HEIGHT - 62, f"{pace:.0f} × faster", QUIET, 8.0, ha="center")

    def _write(self, x: float, y: float, words: str, ink: Any, size: float, **style: Any) -> None:
        artist = self._axes.text(x, y, words, color=ink, fontsize=size, parse_math=False, **style)
        self._axes.draw_artist(artist)
        artist.remove()


def _flying_text(flight: Trajectory, time_s: float) -> str:
    """A branch is its original until it leaves it."""
    left = flight.departure
    return "flying" if left is None or time_s >= left.time_s else f"flying as {left.of} did"


def _draw_header(axes: Axes, stage: Stage, count: int) -> None:
    from matplotlib.patches import Rectangle

    left = stage.panel.left
    axes.add_patch(Rectangle((left + 10, HEIGHT - 56), 4, 44, color=stage.colour, linewidth=0))
    name = name_text(stage.flight, beside=count > 1)
    limit = NAME_LENGTH[count]
    name = name if len(name) <= limit else f"… {name[2 - limit :]}"
    words, families = picture_text(f"{stage.letter} · {name}" if stage.letter else name)
    axes.text(
        left + 22, HEIGHT - 29, words, fontsize=NAME_POINTS[count], color=BRIGHT, weight="bold", parse_math=False,
        family=families,
    )  # fmt: skip


def _share(ink: Rgb) -> tuple[float, float, float]:
    return ink[0] / 255, ink[1] / 255, ink[2] / 255
