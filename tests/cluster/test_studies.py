"""A study in bands is the study in one piece, and trials come back whatever engine trains them."""

from __future__ import annotations

import numpy as np

from agents.envelope import envelope
from agents.envelope_axis import Axis, parse_axis
from sim.scenario_file import load_scenario
from workbench.policies import resolve_policy
from workbench.study_bands import MAPS, fly_band, joined


def pieces(x: Axis, count: int) -> list[Axis]:
    return [Axis(x.name, tuple(part.tolist())) for part in np.array_split(np.array(x.values), count)]


def test_bands_of_shots_make_the_same_map() -> None:
    x, y = parse_axis("launch_range_m=8e3:48e3:7"), parse_axis("aspect_deg=-180:120:6")
    same(x, y, 3, {"held": [], "masked": frozenset(), "episodes": 1, "seed": 0})


def test_bands_of_whole_engagements_make_the_same_map() -> None:
    x, y = parse_axis("launch.range_m=30e3:50e3:3"), parse_axis("missile.burn_s=6:9:2")
    same(x, y, 2, {"held": [], "masked": frozenset({2, 3, 4}), "episodes": 3, "seed": 1})


def same(x: Axis, y: Axis, count: int, how: dict[str, object]) -> None:
    policy, scenario = resolve_policy("submas-source-3"), load_scenario()
    whole = envelope(policy, scenario, x, y, **how)  # type: ignore[arg-type]
    parts = joined([fly_band(policy, scenario, band, y, how) for band in pieces(x, count)], x)
    for name in MAPS:
        np.testing.assert_array_equal(getattr(parts, name), getattr(whole, name), err_msg=name)
    assert parts.to_json() == whole.to_json()
