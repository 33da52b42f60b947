"""An evaluation counts what single flights show, however many lanes it flies in."""

from __future__ import annotations

import numpy as np
import pytest

from agents.evaluation import evaluate
from agents.expert import DraggingExpert, NavigationExpert
from agents.policy import bind
from sim.trajectory import fly
from tests.engagements import task

EPISODES = 24


@pytest.mark.parametrize("policy", [DraggingExpert(), NavigationExpert()], ids=lambda policy: policy.name)
def test_every_episode_is_the_flight_of_the_same_number(policy: DraggingExpert | NavigationExpert) -> None:
    results = evaluate(policy, task(4), EPISODES, seed=33, lanes=7).results
    assert results is not None
    for episode in range(EPISODES):
        flight = fly(task(4), bind(policy, task(4)), policy.name, seed=33, episode=episode)
        assert results.episode_return[episode] == pytest.approx(flight.episode_return, abs=0.01)
        assert results.outcome[episode] == flight.outcome
        assert results.killer[episode] == flight.killer
        assert results.steps[episode] == len(flight.action_rad)


def test_the_number_of_lanes_changes_no_figure() -> None:
    flown = [evaluate(DraggingExpert(), task(), EPISODES, seed=33, lanes=lanes).results for lanes in (1, 5, 24)]
    for other in flown[1:]:
        np.testing.assert_array_equal(flown[0].outcome, other.outcome)
        np.testing.assert_array_equal(flown[0].episode_return, other.episode_return)
        np.testing.assert_array_equal(flown[0].steps, other.steps)
