"""Which engagements of an evaluation are worth looking at: the closest calls, and some of every kind of failure."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from agents.episodes import EpisodeResults
from agents.evaluation import Evaluation
from agents.task import BoolArray, FloatArray
from sim.world import Outcome
from workbench.comparison.pairs import episodes_won_alone

SHOWN = 6
"""Pictures of each kind."""


@dataclass(frozen=True)
class Strip:
    """One kind of engagement."""

    kind: str
    """`closest`, `shot_down_1` …, `left_field`, `timeout`, `not_finite`, `won_alone`, `lost_alone`."""
    title: str
    count: int
    """How many there are."""
    episodes: tuple[int, ...]
    """Those that are shown."""


def strips(evaluation: Evaluation, other: Evaluation | None = None, other_name: str = "") -> list[Strip]:
    """Kinds of engagements that occurred: the closest of the closest calls, of every other kind the first.

    Args:
        evaluation: of the policy that is looked at.
        other: of another policy on the same engagements, to find those that only one of them won.
        other_name: what that one is called.
    """
    results = evaluation.results
    assert results is not None, "a gallery needs every engagement"
    met = np.isfinite(results.closest_m)
    calls = _strip(results, "closest", "Closest calls among the won", results.success & met, results.closest_m)
    found = [calls]
    if other is not None:
        alone, lost = episodes_won_alone(evaluation, other), episodes_won_alone(other, evaluation)
        found.append(_strip(results, "won_alone", f"Won where {other_name} lost", np.isin(results.episode, alone)))
        found.append(_strip(results, "lost_alone", f"Lost where {other_name} won", np.isin(results.episode, lost)))
    shot = results.outcome == Outcome.SHOT_DOWN
    found += [
        _strip(results, f"shot_down_{number}", f"Shot down by missile {number}", shot & (results.killer == number))
        for number in evaluation.missiles
    ]
    ways = {Outcome.LEFT_FIELD: "Left the field", Outcome.TIMEOUT: "Out of time", Outcome.NOT_FINITE: "Void"}
    found += [_strip(results, way.name.lower(), title, results.outcome == way) for way, title in ways.items()]
    return [strip for strip in found if strip.count]


def _strip(
    results: EpisodeResults, kind: str, title: str, members: BoolArray, order_by: FloatArray | None = None
) -> Strip:
    """The smallest values first; without any, the first by number: a fair sample."""
    order = np.arange(len(members)) if order_by is None else np.argsort(order_by, kind="stable")
    chosen = [int(results.episode[i]) for i in order if members[i]][:SHOWN]
    return Strip(kind, title, int(members.sum()), tuple(chosen))
