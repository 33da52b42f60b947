"""HTML of the Compare page: legend, paired table, small pictures. Whatever a person named is escaped."""

from __future__ import annotations

import html
from collections.abc import Mapping, Sequence
from pathlib import Path

from layouts.comparison_inks import cause_ink, cause_words
from layouts.comparison_thumbnail import Tracks, thumbnail
from layouts.theme import FAILURE, NEUTRAL, SUCCESS
from sim.scenario import Battlefield
from workbench.comparison.gallery import Strip
from workbench.comparison.pairs import PairedFigures
from workbench.terminal import duration

COMPARE_CSS = Path(__file__).with_name("compare.css").read_text("utf-8")
SMALLEST_P = 1e-4
PAIR_COLUMNS = {
    "task": "",
    "won by": "",
    "both": "engagements that both won",
    "only 1st": "engagements that only the first won",
    "only 2nd": "engagements that only the second won",
    "none": "engagements that none of them won",
    "success": "success rate of the first less that of the second, in points, with its paired bootstrap 95 % interval",
    "return": "mean return of the first less that of the second, with its paired bootstrap 95 % interval",
    "p": "exact McNemar test: how likely so one-sided a split is, were both as likely to win where only one did",
}
"""Columns of the paired table, and what they hold."""


def legend(labels: Mapping[str, str], inks: Mapping[str, str], elsewhere: bool, causes: Sequence[str]) -> str:
    """Swatches of the policies, of hatched bars where there are any, and of the causes of failure that occur."""
    items = [_swatch(html.escape(label), inks[spec]) for spec, label in labels.items()]
    if elsewhere:
        items.append(_swatch("flies another task or scenario than it was trained for", NEUTRAL, "quiet", "hatched"))
    found = [
        _swatch(cause_words(cause), cause_ink(cause), "quiet", "hatched" * (cause == "shot_down")) for cause in causes
    ]
    lost = f'<span class="lost">{"".join(found)}</span>' if found else ""
    return f'<div class="legend">{"".join(items)}{lost}</div>'


def _swatch(words: str, ink: str, kind: str = "", more: str = "") -> str:
    return f'<span class="{kind}" style="--ink: {ink}"><i class="swatch {more}"></i>{words}</span>'


def pairs_table(
    names: tuple[str, str], inks: tuple[str, str], tasks: Sequence[str], pairs: Mapping[str, PairedFigures], close: str
) -> str:
    """Engagements won by both, one or none of A and B, and the differences A − B, a row per task.

    Args:
        names: A and B in words.
        inks: of A and of B.
        tasks: names of all tasks.
        pairs: by name of the task; those that are not there have not been flown by both.
        close: the task that is looked at closely.
    """
    a, b = (html.escape(name) for name in names)
    columns = "".join(f'<th title="{words}">{name}</th>' for name, words in PAIR_COLUMNS.items())
    head = f"<h2>{a} <small>against</small> {b} <small>on the same initial states</small></h2><table><tr>{columns}</tr>"
    rows = "".join(_pair_row(task, pairs.get(task), inks, task == close) for task in tasks)
    return f"{head}{rows}</table>"


def _pair_row(task: str, figures: PairedFigures | None, inks: tuple[str, str], close: bool) -> str:
    begin = f"<tr{' class=close' if close else ''}><td>{html.escape(task)}</td>"
    if figures is None:
        width = len(PAIR_COLUMNS) - 1
        return f'{begin}<td class="none" colspan="{width}"><small>not flown by both here yet</small></td></tr>'
    parts = ((figures.both, SUCCESS), (figures.only_a, inks[0]), (figures.only_b, inks[1]), (figures.neither, FAILURE))
    split = "".join(f'<i style="flex: {count}; background: {ink}"></i>' for count, ink in parts)
    counts = "".join(f"<td>{count}</td>" for count, _ in parts)
    success = _difference([100.0 * value for value in figures.success_difference])
    p = f"{figures.p_value:.2g}" if figures.p_value >= SMALLEST_P else f"&lt; {SMALLEST_P:g}"
    return (
        f'{begin}<td class="wide"><span class="split">{split}</span></td>{counts}<td>{success}</td>'
        f"<td>{_difference(figures.return_difference)}</td><td>{p}</td></tr>"
    )


def _difference(values: Sequence[float]) -> str:
    value, low, high = values
    return f"{value:+.1f} <small>{low:+.1f} to {high:+.1f}</small>".replace("-", "−")


def gallery(
    strips: Sequence[Strip], tracks: Mapping[int, Mapping], field: Battlefield, ink: str, addresses: Mapping[int, str],
    episodes: int,
) -> str:  # fmt: skip
    """Small pictures by kind, each a link to the Fly page.

    Args:
        strips: what to show.
        tracks: of every engagement that is shown, by episode, as `workbench.comparison.flights.tracks` makes them.
        field: the battlefield.
        ink: of the evader.
        addresses: of the Fly page, by episode.
        episodes: how many engagements there are in all.
    """
    return "".join(
        f'<div class="strip" data-kind="{strip.kind}"><h2>{html.escape(strip.title)} <small>{strip.count} of {episodes}'
        f'</small></h2><div class="shots" style="--ink: {ink}">'
        + "".join(_shot(tracks[episode], field, ink, addresses[episode]) for episode in strip.episodes)
        + "</div></div>"
        for strip in strips
    )


def _shot(track: Mapping, field: Battlefield, ink: str, address: str) -> str:
    miss = f"{track['closest_m']:,.0f} m" if track["closest_m"] is not None else "no missile"
    words = f"Episode {track['episode']}, closest approach {miss}, {duration(track['time_s'])} long: fly it"
    drawn = Tracks(
        track["evader"], track["interceptor"], {int(n): m["path"] for n, m in track["missiles"].items()},
        frozenset(int(n) for n, m in track["missiles"].items() if m["hit"]),
    )  # fmt: skip
    return (
        f'<a class="shot" href="{html.escape(address)}" title="{words}">{thumbnail(field, drawn, ink, words)}'
        f"<span><b>{miss}</b><em>{duration(track['time_s'])}</em><em>episode {track['episode']}</em></span></a>"
    )
