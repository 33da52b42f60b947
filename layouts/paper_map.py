"""Small maps of an engagement (Fig. 10 and 11), as SVG: tracks so far, missiles, exit."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from layouts.theme import GATE, ink_dash

Point = tuple[float, float]
MARGIN_KM = 6.0


@dataclass(frozen=True)
class MapTrack:
    """The way of one body until the moment of the picture."""

    label: str
    colour: str
    points_km: Sequence[Point]
    ended: bool = False
    """Whether it is no longer there: drawn fainter, with an open end."""


def map_picture(
    title: str, field_km: Point, exit_km: Point, tracks: Sequence[MapTrack], stroke_km: float = 0.55
) -> str:
    """The battlefield from above as an SVG element that fills its width.

    Args:
        title: what a screen reader says.
        field_km: length and width of the battlefield, the origin in its middle.
        exit_km: middle of the exit on the right edge, and half its width.
        tracks: drawn in this order.
        stroke_km: width of a track.
    """
    half_x, half_y = field_km[0] / 2.0, field_km[1] / 2.0
    box = (-half_x - MARGIN_KM, -half_y - MARGIN_KM, 2 * (half_x + MARGIN_KM), 2 * (half_y + MARGIN_KM))
    gate = exit_km[0] - exit_km[1], exit_km[0] + exit_km[1]
    parts = [
        f'<rect x="{-half_x}" y="{-half_y}" width="{2 * half_x}" height="{2 * half_y}" class="field"/>',
        f'<path d="M{half_x} {-gate[0]:.2f}V{-gate[1]:.2f}" stroke="{GATE}" stroke-width="2.4"/>',
        *(_track(track, stroke_km) for track in tracks),
    ]
    view = " ".join(f"{value:.1f}" for value in box)
    return f'<svg viewBox="{view}" role="img" aria-label="{title}" fill="none">{"".join(parts)}</svg>'


def _track(track: MapTrack, stroke_km: float) -> str:
    # The page's y axis points down.
    points = " ".join(f"{x:.2f},{-y:.2f}" for x, y in track.points_km)
    dash = ' stroke-dasharray="2 1.4"' if ink_dash(track.colour) == "dashed" else ""
    opacity = 0.55 if track.ended else 1.0
    x, y = track.points_km[-1]
    fill = "none" if track.ended else track.colour
    return (
        f'<g stroke="{track.colour}" stroke-width="{stroke_km}" opacity="{opacity}"><title>{track.label}</title>'
        f'<polyline points="{points}" stroke-linejoin="round"{dash}/>'
        f'<circle cx="{x:.2f}" cy="{-y:.2f}" r="1.5" fill="{fill}"/></g>'
    )
