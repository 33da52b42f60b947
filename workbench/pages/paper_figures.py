"""Figures of the Paper page, drawn from result sets: charts to point at, and small maps of Fig. 10 and 11."""

from __future__ import annotations

import html
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from bokeh.models import ColumnDataSource
from bokeh.plotting import figure

from layouts.paper_azimuth_charts import azimuth_chart
from layouts.paper_bar_charts import bar_charts
from layouts.paper_curve_charts import curve_charts, return_range
from layouts.paper_dot_charts import DotRow, dot_chart
from layouts.paper_map import MapTrack, map_picture
from layouts.theme import INTERCEPTOR, POLICY_A, POLICY_B, missile_colour
from workbench.pages.address import search
from workbench.pages.paper_sources import number_key
from workbench.reproduce import table4
from workbench.reproduce.drawings import azimuth_panels, curve_panels, policy_bars_of
from workbench.reproduce.paper_numbers import EXPERT_ON_TARGET, TABLE_4, WITHOUT_REUSE_ON_SOURCE_3
from workbench.reproduce.plan import CHAIN
from workbench.reproduce.protocol import LABELS, TASK_LABELS, Item
from workbench.reproduce.result_set import Replay, ResultSet


@dataclass(frozen=True)
class Drawn:
    """The charts of an item, and what can be tapped in them."""

    pairs: Sequence[tuple[figure, ...]] = ()
    """Charts that stand side by side."""
    dots: Sequence[ColumnDataSource] = field(default=())
    """Sources whose rows carry the `key` of a record."""
    caption: str = ""


def drawn(item: Item, result: ResultSet | None) -> Drawn | None:
    """The charts of an item; None while there is nothing to draw. Table 4 shows the paper's numbers in any case."""
    if item == "table4":
        return _table4(result)
    if result is None:
        return None
    if item == "fig12" and result.flights:
        return Drawn([tuple(azimuth_chart(panel) for panel in azimuth_panels(result))], caption=_fig12(result))
    if item == "fig13" and result.numbers:
        bars, dots = policy_bars_of(result)
        tasks = [TASK_LABELS[task] for task in CHAIN]
        return Drawn([bar_charts(tasks, bars, dots, {len(CHAIN) - 1: EXPERT_ON_TARGET})], caption=_fig13(result))
    return _curves(result) if item in ("fig8", "fig9") and result.curves else None


def _curves(result: ResultSet) -> Drawn:
    panels = curve_panels(result)
    returns = return_range(panels)
    references: list[dict[str, float]] = [{} for _ in panels]
    references[-1] = {variant: success for variant, (_, success) in TABLE_4.items()}
    if result.item == "fig8":
        references[0] = {"wo-pr": WITHOUT_REUSE_ON_SOURCE_3}
    pairs = [curve_charts(panel, marks, returns) for panel, marks in zip(panels, references, strict=True)]
    words = (
        "Held-out evaluations while training: interquartile mean over seeds and its 95 % bootstrap interval; thin, "
        "every seed, with a dot where its stage ended (its last value counts on). Triangles at the right: success "
        "rates that the paper tells in words or in Table 4; its curves are averages over ten seeds with standard "
        f"deviations, as pictures only. Profile {result.profile}."
    )
    return Drawn(pairs, caption=words)


def _table4(result: ResultSet | None) -> Drawn:
    found = {row.variant: row for row in table4.rows(result)} if result else {}
    rows = [_dot_rows(variant, found.get(variant)) for variant in TABLE_4]
    returns = dot_chart("episode return", [row for row, _ in rows], (-440.0, 540.0))
    success = dot_chart("success rate [%]", [row for _, row in rows], (-4.0, 104.0))
    words = (
        "Dots: our seeds, each 1000 fresh episodes of the target task; ringed, the best by mean return, as the paper "
        "chooses it. Diamond and line: interquartile mean over the seeds and its 95 % bootstrap interval. Grey mark: "
        "the paper's best of ten seeds. A click on a dot tells where it comes from."
    )
    return Drawn([(returns[0], success[0])], (returns[1], success[1]), words)


def _dot_rows(variant: str, row: table4.Row | None) -> tuple[DotRow, DotRow]:
    """The row of one algorithm in returns and in success."""
    numbers = row.numbers if row else ()
    names = [f"{LABELS[variant]}, seed {number.seed}" for number in numbers]
    keys = [number_key(number) for number in numbers]
    best = list(numbers).index(row.best) if row else None
    rows = []
    for index, (attribute, scale) in enumerate((("mean_return", 1.0), ("success_rate", 100.0))):
        interval = (row.returns, row.success)[index] if row else None
        middle, low, high = (scale * float(part) for part in interval) if interval else (None, np.nan, np.nan)
        values = [scale * getattr(number, attribute) for number in numbers]
        paper = scale * TABLE_4[variant][index]
        rows.append(DotRow(variant, LABELS[variant], values, names, keys, best, middle, low, high, paper))
    return rows[0], rows[1]


def _fig12(result: ResultSet) -> str:
    first = result.flights[0]
    beams = " and ".join(f"{f.beam_share:.0%} ({f.policy})".replace("%", " %") for f in result.flights)
    return (
        "The same engagement, the first in which both evade every missile and arrive (scenario "
        f"{result.scenario}, episode {first.episode} of the reported ones). Left positive; dotted, ±90°. The closest "
        f"missile is within 15° of ±90° for {beams} of the time in which one flies."
    )


def _fig13(result: ResultSet) -> str:
    return (
        "Blue: SubMas-RL, each task's own policy; green: the dragging expert; diamonds: SubMas-RL's policy of the "
        f"target task, on all tasks. {result.episodes} episodes each, from the same initial states; lines: Wilson 95 % "
        "intervals. In source task 4, which has no missile, SubMas-RL is the navigation expert (§4.1). The triangle is "
        "the paper's 62.1 % of the expert; its other bars are a picture only, but for the 94.8 % of SubMas-RL."
    )


MAP_CSS = """
:host { color: var(--panel-on-background-color); font: 13.5px/1.4 var(--bokeh-base-font, sans-serif) }
.maps { display: grid; grid-template-columns: repeat(auto-fit, minmax(330px, 1fr)); gap: 14px }
figure { margin: 0; display: flex; flex-direction: column; gap: 6px }
svg { width: 100%; border-radius: 8px; background: color-mix(in srgb, currentColor 5%, transparent) }
.field { stroke: currentColor; stroke-opacity: .35; stroke-width: .5 }
figcaption { opacity: .9 }
a { color: var(--panel-primary-color); font-weight: 600 }
"""


def maps(replay: Replay) -> str:
    """Both panels of Fig. 10 or 11 as HTML: the moment of most missiles, and the arrival; each leads to Fly."""
    other = "expert-dragging" if replay.variant == "submas" else "submas-target"
    flying = sum(1 for m in replay.missiles if _flies(m.end_s, replay.time_s[m.first], replay.moment_s))
    panels = [
        ("(a)", replay.moment_s, f"{flying} missile{'s' * (flying != 1)} in flight"),
        ("(b)", replay.duration_s, "reaches the exit" if replay.outcome == "exit" else replay.outcome),
    ]
    figures = []
    for letter, time_s, words in panels:
        address = "/fly" + search({"a": replay.policy, "b": other, "seed": str(replay.seed), "t": f"{time_s:g}"})
        title = f"{letter} {LABELS[replay.variant]} after {time_s:.0f} s: {words}"
        figures.append(
            f"<figure>{map_picture(html.escape(title), replay.field_km, replay.exit_km, _tracks(replay, time_s))}"
            f'<figcaption>{html.escape(title)} · <a href="{html.escape(address)}">Fly it in 3-D</a></figcaption>'
            "</figure>"
        )
    return f'<div class="maps">{"".join(figures)}</div>'


def _flies(end_s: float | None, launch_s: float, time_s: float) -> bool:
    return launch_s <= time_s and (end_s is None or time_s <= end_s)


def _tracks(replay: Replay, time_s: float) -> list[MapTrack]:
    """All bodies until this time [s]."""
    count = max(sum(each <= time_s for each in replay.time_s), 1)
    evader = POLICY_A if replay.variant == "submas" else POLICY_B
    tracks = [MapTrack("interceptor", INTERCEPTOR, replay.interceptor_km[:count])]
    for missile in replay.missiles:
        points = missile.track_km[: max(count - missile.first, 0)]
        if points:
            ended = missile.end_s is not None and missile.end_s < time_s
            tracks.append(MapTrack(f"missile {missile.number}", missile_colour(missile.number), points, ended))
    return [*tracks, MapTrack("evader", evader, replay.evader_km[:count])]
