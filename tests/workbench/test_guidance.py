"""The guide along a recorded flight: where its knowledge held is told from the flight itself, not from observations."""

from __future__ import annotations

import numpy as np
import pytest

from agents.config import TrainingConfig
from agents.policy import NetworkPolicy, bind
from sim.scenario_file import load_scenario
from sim.task import Task
from sim.trajectory import Trajectory, fly
from workbench.guidance import guide_trace
from workbench.policies import resolve_policy
from workbench.runs import RunStore


@pytest.fixture(scope="module")
def store(tmp_path_factory: pytest.TempPathFactory) -> RunStore:
    return RunStore(tmp_path_factory.mktemp("runs"))


def _flown(spec: str, masked: frozenset[int] = frozenset()) -> Trajectory:
    task = Task(load_scenario(), masked)
    return fly(task, bind(resolve_policy(spec), task), spec, seed=2)


def test_transfer_is_prevented_exactly_while_the_fresh_missile_flies(store: RunStore) -> None:
    flight = _flown("submas-target")
    trace = guide_trace(flight, resolve_policy("submas-target"), "submas-target", store)
    assert trace is not None
    assert (trace.guide, trace.fresh) == ("submas-source-1", (4,))
    fresh = flight.missiles[-1]
    seen = (flight.step_time_s >= fresh.launch_s - 1e-6) & (flight.step_time_s < fresh.end_s - 1e-6)
    assert seen.any()
    assert np.array_equal(trace.allowed, ~seen)


def test_before_the_fresh_missile_the_guide_flies_as_it_would_alone(store: RunStore) -> None:
    flight = _flown("submas-target")
    trace = guide_trace(flight, resolve_policy("submas-target"), "submas-target", store)
    assert trace is not None
    guide = resolve_policy("submas-source-1")
    alone = guide.act(flight.observation[:, :-2].astype(np.float32), flight.task.mask([4]).layout)
    assert trace.action_rad == pytest.approx(alone[:, 0], abs=1e-6)


def test_the_first_stage_was_guided_by_navigation(store: RunStore) -> None:
    flight = _flown("submas-source-3", frozenset({2, 3, 4}))
    trace = guide_trace(flight, resolve_policy("submas-source-3"), "submas-source-3", store)
    assert trace is not None
    assert (trace.guide, trace.fresh) == ("expert-navigation", (1,))
    towards_exit = np.clip(flight.observation[:, flight.task.layout.names.index("phi_exit")], -np.pi / 2, np.pi / 2)
    assert trace.action_rad == pytest.approx(towards_exit, abs=1e-6)


def test_on_a_task_without_the_fresh_missile_transfer_is_always_allowed(store: RunStore) -> None:
    trace = guide_trace(
        _flown("submas-target", frozenset({4})), resolve_policy("submas-target"), "submas-target", store
    )
    assert trace is not None
    assert trace.allowed.all()


def test_rules_have_no_guide(store: RunStore) -> None:
    assert guide_trace(_flown("expert-dragging"), resolve_policy("expert-dragging"), "expert-dragging", store) is None


def test_who_learned_from_scratch_or_lost_the_guide_has_none(store: RunStore) -> None:
    flight, policy = _flown("submas-target"), resolve_policy("submas-target")
    assert isinstance(policy, NetworkPolicy)
    assert policy.card is not None
    scratch = store.create(TrainingConfig(profile="smoke", guide="/nowhere/gone.safetensors"))
    assert guide_trace(flight, policy, scratch.id, store) is None
    object.__setattr__(policy.card, "variant", "td3")
    assert guide_trace(flight, policy, "submas-target", store) is None
