"""Laws of a branch: it is its original up to the moment, the original for ever with the same policy, and no longer."""

from __future__ import annotations

from dataclasses import fields

import numpy as np
import pytest

from agents.expert import RandomPolicy
from agents.policy import bind
from sim.geometry import wrap_to_pi
from sim.trajectory import Act, BodyTrack, Trajectory, fly
from sim.world import Fate
from tests.engagements import DRILL, circle, drag, straight, task, to_exit
from workbench.branch import Branch, BranchError, caption, fly_branch, moment_s, turn_towards

ORIGINALS = [fly(task(*masked), act, act.__name__, seed=5, episode=episode)
             for act, masked, episode in ((drag, (), 0), (straight, (), 1), (circle, (2,), 2))]  # fmt: skip
SUBSTEPS = DRILL.rules.substeps


def _same(one: Trajectory, other: Trajectory, times: int, steps: int) -> bool:
    """Whether two flights are equal bit for bit over the first recorded times and decision steps."""
    pairs = [(getattr(getattr(one, side), f.name)[:times], getattr(getattr(other, side), f.name)[:times])
             for side in ("evader", "interceptor") for f in fields(BodyTrack)]  # fmt: skip
    pairs += [(m.position_m[:times], n.position_m[:times]) for m, n in zip(one.missiles, other.missiles, strict=True)]
    pairs += [(getattr(one, name)[:steps], getattr(other, name)[:steps]) for name in ("action_rad", "reward_terms")]
    pairs.append((one.observation[: steps + 1], other.observation[: steps + 1]))
    return all(np.array_equal(a, b, equal_nan=True) for a, b in pairs)


@pytest.mark.parametrize("original", ORIGINALS)
@pytest.mark.parametrize("share", [0.0, 0.37, 0.99])
def test_with_the_same_policy_a_branch_is_its_original(original: Trajectory, share: float) -> None:
    act = {"drag": drag, "straight": straight, "circle": circle}[original.policy]
    again = fly_branch(original, Branch("A", int(share * len(original.action_rad)), (), original.policy), act)
    assert len(again.time_s) == len(original.time_s)
    assert _same(original, again, len(original.time_s), len(original.action_rad))
    happened = tuple(event for event in again.events if event.kind != "branch")
    assert (str(happened), again.outcome, again.killer) == (str(original.events), original.outcome, original.killer)


@pytest.mark.parametrize("original", ORIGINALS)
@pytest.mark.parametrize("other", [drag, to_exit, circle])
@pytest.mark.parametrize("step", [0, 23, 40])
def test_a_branch_differs_only_after_its_moment(original: Trajectory, other: Act, step: int) -> None:
    if step >= len(original.action_rad):
        pytest.skip("the flight is over before")
    branch = fly_branch(original, Branch("A", step, (), "other"), other)
    assert _same(original, branch, step * SUBSTEPS + 1, step)
    turn = float(np.clip(other(original.observation[step : step + 1].astype(np.float32)), -np.pi / 2, np.pi / 2).item())
    if abs(turn - original.action_rad[step]) > 0.1:
        times, steps = (min(len(getattr(f, name)) for f in (original, branch)) for name in ("time_s", "action_rad"))
        assert not _same(original, branch, times, steps - 1)


def test_a_policy_that_draws_flies_on_as_if_it_had_flown_all_along() -> None:
    flown = task()
    original = fly(flown, bind(RandomPolicy(), flown), "random", seed=5)
    step = len(original.action_rad) // 2
    again = fly_branch(original, Branch("B", step, (), "random"), bind(RandomPolicy(), flown))
    assert _same(original, again, len(original.time_s), len(original.action_rad))


def test_a_thinned_original_is_branched_alike() -> None:
    full, thin = (fly(task(), drag, "drag", seed=5, record_every=n) for n in (1, 2))
    branch = Branch("A", 30, (90, 90, 120), "circle")
    one, other = fly_branch(full, branch, circle), fly_branch(thin, branch, circle, record_every=2)
    np.testing.assert_array_equal(one.thin(2).evader.position_m, other.evader.position_m)


def test_headings_by_hand_are_flown_and_then_the_policy_flies() -> None:
    original = ORIGINALS[0]
    branch = fly_branch(original, Branch("A", 20, (180,) * 25, "circle"), circle)
    heading = branch.evader.heading_rad
    assert abs(float(wrap_to_pi(heading[45 * SUBSTEPS] - np.pi))) < 0.05
    np.testing.assert_array_equal(branch.action_rad[45:], 0.5)
    assert np.abs(branch.action_rad).max() <= np.pi / 2


def test_without_a_policy_the_last_heading_is_held() -> None:
    branch = fly_branch(ORIGINALS[0], Branch("A", 20, (90, 45)), None)
    late = branch.evader.heading_rad[32 * SUBSTEPS :]
    np.testing.assert_allclose(late, np.radians(45.0), atol=0.02)


def test_masks_seeds_and_episodes_are_those_of_the_original() -> None:
    original = ORIGINALS[2]
    branch = fly_branch(original, Branch("A", 3, (), "drag"), drag)
    assert (branch.task, branch.seed, branch.episode) == (original.task, original.seed, original.episode)
    assert [m.number for m in branch.missiles] == [1, 3, 4]
    assert all(m.fate in Fate for m in branch.missiles)


@pytest.mark.parametrize(("heading", "psi", "turn"), [
    (90, 0.0, np.pi / 2), (0, np.pi / 4, -np.pi / 4), (200, 0.0, -np.pi / 2),
    (179, np.radians(-179.0), np.radians(-2.0)),
])  # fmt: skip
def test_a_heading_is_reached_the_shorter_way_within_the_limit(heading: int, psi: float, turn: float) -> None:
    assert turn_towards(heading, np.array([0.0, 0.0, psi])) == pytest.approx(turn)


def test_a_flight_that_is_over_cannot_be_left() -> None:
    original = ORIGINALS[0]
    steps = len(original.action_rad)
    with pytest.raises(BranchError, match=f"at step {steps}, it is over; legal are steps 0 to {steps - 1}"):
        fly_branch(original, Branch("A", steps, (), "circle"), circle)


@pytest.mark.parametrize("wrong", [{"step": -1, "policy": "x"}, {"step": 3}, {"step": 3, "headings_deg": (360,)}])
def test_a_branch_that_nobody_can_fly_is_refused(wrong: dict) -> None:
    with pytest.raises(BranchError):
        Branch("A", **wrong)


def test_captions_tell_who_flew() -> None:
    original = ORIGINALS[0]
    assert caption(original, Branch("A", 40, (), "circle")) == "drag, from 40 s circle"
    assert caption(original, Branch("A", 40, (1,), "circle")) == "drag, from 40 s by hand, then circle"
    assert caption(original, Branch("A", 40, (1,))) == "drag, from 40 s by hand, then heading held"
    assert moment_s(original, Branch("A", 40, (1,))) == 40.0
