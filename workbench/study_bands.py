"""An envelope in bands of its first axis, each flown by a call of an engine: the same map, from many machines."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any, Final

import numpy as np

from agents.envelope import Envelope, Progress, envelope
from agents.envelope_axis import Axis
from agents.policy import Policy
from sim.scenario import Scenario
from workbench.engine import Engine

BANDS_EACH: Final = 4
"""Bands per place to work, so that nobody waits long for the slowest."""
MAPS: Final = ("survived", "exited", "closest_m", "time_s")


def envelope_in_bands(
    engine: Engine,
    policy: Policy,
    scenario: Scenario,
    x: Axis,
    y: Axis,
    how: Mapping[str, Any],
    progress: Progress | None = None,
) -> Envelope:
    """What `agents.envelope.envelope` maps, with `how` as its other arguments; the result does not depend on the bands.

    Raises:
        AxisError, ScenarioError, MaskError, PolicyError: as `envelope` does.
    """
    count = min(len(x.values), BANDS_EACH * engine.at_once())
    bands = [Axis(x.name, tuple(values.tolist())) for values in np.array_split(np.array(x.values), count)]
    calls = [(policy, scenario, band, y, dict(how)) for band in bands]
    flights, decided = len(x.values) * len(y.values) * how.get("episodes", 1), 0
    flown: dict[int, Envelope] = {}
    for number, band in engine.each(fly_band, calls):
        flown[number] = band
        decided += band.survived.size * band.episodes
        if progress is not None:
            progress(decided, flights)
    return joined([flown[number] for number in range(count)], x)


def fly_band(policy: Policy, scenario: Scenario, x: Axis, y: Axis, how: Mapping[str, Any]) -> Envelope:
    """One band, on one thread."""
    return envelope(policy, scenario, x, y, **how)


def joined(bands: Sequence[Envelope], x: Axis) -> Envelope:
    """One map of bands that lie side by side along the axis `x`."""
    maps = {name: np.concatenate([getattr(band, name) for band in bands]) for name in MAPS}
    return dataclasses.replace(bands[0], x=x, missiles=max((band.missiles for band in bands), key=len), **maps)
