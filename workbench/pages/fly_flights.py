"""The two flights of the Fly page, and what must be said about them."""

from __future__ import annotations

import json
from dataclasses import dataclass

from agents.features import unseen_subtasks
from agents.policy import PolicyError, bind
from layouts.controls import GuideTrace
from layouts.instruments import instrument_series
from layouts.theme import POLICY_A, POLICY_B
from sim.scenario_file import load_scenario
from sim.task import Task
from sim.trajectory import Trajectory, fly
from workbench.guidance import guide_trace
from workbench.pages.fly_settings import FlySettings
from workbench.pages.fly_start import start_notes, start_of
from workbench.policies import resolve_policy
from workbench.runs import RunStore
from workbench.scenarios import trained_elsewhere

RECORD_EVERY = 2
"""Substeps between records: ten a second are more than a screen shows."""


@dataclass(frozen=True)
class Flights:
    """Two flights from one initial state."""

    a: Trajectory
    b: Trajectory
    notes: tuple[str, ...]
    """Sentences about where they start, and about policies that were trained on another scenario."""
    guide_a: GuideTrace | None = None
    guide_b: GuideTrace | None = None
    readouts: str = "[]"
    """What the read-outs over the replay need of both, as JSON: Panel compares values, and text is compared fast."""


class BlindPolicyError(PolicyError):
    """A policy cannot see a missile of the task; with `masked` masked both policies could fly."""

    def __init__(self, sentence: str, masked: frozenset[int]) -> None:
        super().__init__(sentence)
        self.masked = masked


def fly_both(settings: FlySettings, store: RunStore) -> Flights:
    """Fly both policies from the same initial state.

    Raises:
        BlindPolicyError: a policy cannot see a missile of the task.
        SubMasError: a policy does not exist any more or is damaged, or the scenario is; or a shot without a missile.
    """
    task = Task(load_scenario(settings.scenario), settings.masked)
    flown, state = start_of(task, settings)
    policies = {letter: resolve_policy(spec, store) for letter, spec in (("A", settings.a), ("B", settings.b))}
    try:
        bound = [bind(policy, flown) for policy in policies.values()]
    except PolicyError as error:
        known = [policy.layout for policy in policies.values() if policy.layout is not None]
        blind = {missile for layout in known for missile in unseen_subtasks(layout, flown.layout)}
        raise BlindPolicyError(str(error), settings.masked | blind) from error
    a, b = (
        fly(flown, act, spec, settings.seed, settings.episode, RECORD_EVERY, state)
        for act, spec in zip(bound, (settings.a, settings.b), strict=True)
    )
    guides = [guide_trace(flight, policies[letter], flight.policy, store) for letter, flight in (("A", a), ("B", b))]
    rows = zip("AB", (a, b), (POLICY_A, POLICY_B), guides, strict=True)
    readouts = json.dumps([instrument_series(flight, letter, ink, guide) for letter, flight, ink, guide in rows])
    told = [(letter, trained_elsewhere(policy, task)) for letter, policy in policies.items()]
    notes = (*start_notes(settings), *(f"{letter}: {sentence}." for letter, sentence in told if sentence))
    return Flights(a, b, notes, *guides, readouts)
