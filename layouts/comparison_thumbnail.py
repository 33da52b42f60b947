"""An engagement from above as a small picture (SVG): battlefield, gate, tracks and where missiles ended."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from layouts.theme import GATE, INTERCEPTOR, NEUTRAL, missile_colour
from sim.scenario import Battlefield

Path = Sequence[Sequence[float]]
"""Points (x, y) [km]."""
MARGIN_KM = 4.0
STROKE = 1.7
"""Width of a track on a picture as wide as `WIDTH` pixels."""
WIDTH = 220.0


@dataclass(frozen=True)
class Tracks:
    """What flew where, seen from above."""

    evader: Path
    interceptor: Path
    missiles: Mapping[int, Path]
    hits: frozenset[int] = frozenset()
    """Missiles that hit."""


def thumbnail(field: Battlefield, tracks: Tracks, ink: str, words: str) -> str:
    """The picture as SVG text, as wide as its container; y up.

    Args:
        field: the battlefield.
        tracks: what flew there.
        ink: of the evader.
        words: what it shows, for those who cannot see it; escaped already.
    """
    half_x, half_y = field.length_m / 2e3, field.width_m / 2e3
    left, width = -half_x - MARGIN_KM, 2.0 * (half_x + MARGIN_KM)
    bottom, height = -half_y - MARGIN_KM, 2.0 * (half_y + MARGIN_KM)
    unit = width / WIDTH
    low, high = ((field.exit_y_m + side * field.exit_half_width_m) / 1e3 for side in (-1, 1))
    ends = [(path, missile_colour(number)) for number, path in tracks.missiles.items() if number in tracks.hits]
    parts = [
        f'<rect x="{-half_x:g}" y="{-half_y:g}" width="{2 * half_x:g}" height="{2 * half_y:g}" fill="{NEUTRAL}" '
        f'fill-opacity=".1" stroke="{NEUTRAL}" stroke-width="{unit:.3g}"/>',
        f'<path d="M{half_x:g} {-high:g}V{-low:g}" stroke="{GATE}" stroke-width="{4 * unit:.3g}"/>',
        _line(tracks.interceptor, INTERCEPTOR, unit, 0.8),
        *(_line(path, missile_colour(number), unit) for number, path in tracks.missiles.items()),
        _line(tracks.evader, ink, 1.3 * unit),
        _dot(tracks.evader, ink, unit),
        _dot(tracks.interceptor, INTERCEPTOR, unit),
        *(_cross(path, colour, unit) for path, colour in ends),
    ]  # fmt: skip
    box = f"{left:g} {bottom:g} {width:g} {height:g}"
    return f'<svg viewBox="{box}" role="img" aria-label="{words}">{"".join(parts)}</svg>'


def _line(path: Path, ink: str, unit: float, opacity: float = 1.0) -> str:
    points = " ".join(f"{x:.2f},{-y:.2f}" for x, y in path)
    return (
        f'<polyline points="{points}" fill="none" stroke="{ink}" stroke-width="{STROKE * unit:.3g}" '
        f'stroke-linejoin="round" stroke-opacity="{opacity:g}"/>'
    )


def _dot(path: Path, ink: str, unit: float) -> str:
    x, y = path[0]
    return f'<circle cx="{x:.2f}" cy="{-y:.2f}" r="{3 * unit:.3g}" fill="{ink}"/>'


def _cross(path: Path, ink: str, unit: float) -> str:
    x, y, arm = path[-1][0], -path[-1][1], 4.5 * unit
    strokes = f"M{x - arm:.2f} {y - arm:.2f}l{2 * arm:.2f} {2 * arm:.2f}m0 {-2 * arm:.2f}l{-2 * arm:.2f} {2 * arm:.2f}"
    return f'<path d="{strokes}" stroke="{ink}" stroke-width="{2.2 * unit:.3g}" fill="none"/>'
