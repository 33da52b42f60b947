"""Where flights of the Fly page start: exactly the engagement that an evaluation or an envelope counted."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from agents.envelope import envelope
from agents.envelope_axis import Axis
from agents.evaluation import evaluate
from sim.errors import MaskError
from sim.scenario_file import load_scenario, scenario_names
from sim.task import task_for
from sim.world import Outcome
from workbench.pages.fly_flights import fly_both
from workbench.pages.fly_settings import FlySettings, default_settings, keep_start, read_settings
from workbench.pages.fly_start import Shot
from workbench.policies import resolve_policy
from workbench.runs import RunStore

POLICIES = ["submas-target", "expert-navigation", "expert-dragging"]
PAIR = FlySettings("expert-navigation", "expert-dragging")
RANGES_M, ASPECTS_DEG = (6e3, 30e3), (-60.0, 180.0)


def _read(**query: str) -> tuple[FlySettings, list[str]]:
    return read_settings(query, POLICIES, scenario_names(), default_settings(POLICIES))


def test_an_episode_of_an_evaluation_is_flown_as_it_was_counted(tmp_path: Path) -> None:
    task, seed = task_for("default", "2,3,4"), 2**46
    counted = evaluate(resolve_policy("expert-dragging"), task, 40, seed).results
    assert counted is not None
    episode = int(counted.episode[counted.steps.argmin()])
    settings = replace(PAIR, masked=task.masked, seed=seed, episode=episode)
    flight = fly_both(settings, RunStore(tmp_path)).b
    assert (int(flight.outcome), len(flight.action_rad)) == (counted.outcome[episode], counted.steps[episode])
    assert flight.missiles[0].closest_m == pytest.approx(float(counted.closest_m[episode]), abs=0.01)


def test_a_shot_is_flown_as_the_envelope_counted_it(tmp_path: Path) -> None:
    scenario, policy = load_scenario("default"), resolve_policy("expert-dragging")
    counted = envelope(policy, scenario, Axis("launch_range_m", RANGES_M), Axis("aspect_deg", ASPECTS_DEG))
    assert 0.0 < counted.survived.mean() < 1.0
    for i, range_m in enumerate(RANGES_M):
        for j, aspect_deg in enumerate(ASPECTS_DEG):
            flown = fly_both(replace(PAIR, shot=Shot(range_m, aspect_deg)), RunStore(tmp_path))
            assert (flown.b.outcome is not Outcome.SHOT_DOWN) == bool(counted.survived[i, j])
            assert flown.b.missiles[0].closest_m == pytest.approx(counted.closest_m[i, j], abs=0.01)
            assert "fired at once" in flown.notes[0]


def test_a_shot_needs_a_missile(tmp_path: Path) -> None:
    with pytest.raises(MaskError, match="every missile is masked"):
        fly_both(replace(PAIR, masked=frozenset({1, 2, 3, 4}), shot=Shot(2e4, 0.0)), RunStore(tmp_path))


def test_what_is_written_is_read_again() -> None:
    settings = FlySettings("expert-navigation", "submas-target", seed=2**46, episode=412, shot=Shot(22e3, -40.0))
    assert _read(**settings.to_query()) == (settings, [])


@pytest.mark.parametrize("text", ["22000", "1,2,3", "near,0", "nan,0", "22000,181", "50,0", "<b>"])
def test_a_wrong_shot_is_one_sentence(text: str) -> None:
    settings, problems = _read(shot=text)
    assert settings.shot is None and len(problems) == 1 and "metres and degrees" in problems[0]


@pytest.mark.parametrize("text", ["-1", "1.5", "1000000", "²"])
def test_a_wrong_episode_is_one_sentence(text: str) -> None:
    settings, problems = _read(episode=text)
    assert settings.episode == 0 and len(problems) == 1 and "Episode" in problems[0]


def test_another_seed_leaves_the_episode_and_the_shot() -> None:
    before = replace(PAIR, seed=7, episode=3, shot=Shot(2e4, 0.0))
    assert keep_start(replace(PAIR, seed=7), before) == before
    assert keep_start(replace(PAIR, seed=8), before) == replace(PAIR, seed=8)
