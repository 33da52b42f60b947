"""Table 2: the paper's profile, number by number."""

from __future__ import annotations

import pytest

from agents.config import PROFILES


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("hidden", (256, 256)),
        ("replay_size", 10**6),
        ("epochs", 300),
        ("steps_per_epoch", 10**4),
        ("learning_rate", 3e-4),
        ("batch_size", 128),
        ("epsilon_start", 0.8),
        ("epsilon_clip", 0.01),
        ("alpha_clip", 0.01),
    ],
)
def test_the_paper_profile_is_table_2(name: str, value: object) -> None:
    assert getattr(PROFILES["paper"], name) == value


def test_what_the_paper_leaves_to_spinning_up_is_spinning_up() -> None:
    paper = PROFILES["paper"]
    assert (paper.gamma, paper.polyak, paper.policy_delay, paper.update_after) == (0.99, 0.005, 2, 1000)
    assert (paper.action_noise, paper.target_noise, paper.target_noise_clip) == (0.1, 0.2, 0.5)
    assert paper.updates_per_lane_step == paper.lanes  # one update per transition
    assert paper.steps_per_epoch % paper.lanes == 0
    assert paper.segment_steps == 1 and not paper.two_returns and not paper.layer_norm


@pytest.mark.parametrize("name", ["fast", "smoke"])
def test_shorter_profiles_scale_the_clips_so_that_the_guide_can_fade(name: str) -> None:
    profile = PROFILES[name]
    assert profile.alpha_clip * profile.epochs >= 1.0
    assert profile.epsilon_clip * profile.epochs >= profile.epsilon_start
