"""The envelope: what any map of launch range and aspect must look like, and that a cell is the flight it stands for."""

from __future__ import annotations

import dataclasses
import json
import math

import numpy as np
import pytest

from agents.envelope import Envelope, envelope
from agents.envelope_axis import Axis, AxisError, parse_axis, parse_held
from agents.evaluation import evaluate
from agents.expert import DraggingExpert, NavigationExpert, RandomPolicy
from agents.policy import Policy, PolicyError, bind
from agents.shot import shot_states, shot_task
from sim.errors import MaskError, ScenarioError
from sim.task import Task
from sim.world import Fate, Outcome, World
from tests.engagements import DRILL, changed
from workbench.policies import resolve_policy

ROUND = parse_axis("aspect_deg=-180:160:18")
RANGES = parse_axis("launch_range_m=2e3:40e3:12")


def shots(policy: Policy, x: Axis = RANGES, y: Axis = ROUND, **more: object) -> Envelope:
    return envelope(policy, DRILL, x, y, **more)  # type: ignore[arg-type]


@pytest.fixture(scope="module")
def dragging() -> Envelope:
    return shots(DraggingExpert())


@pytest.fixture(scope="module")
def straight() -> Envelope:
    return shots(NavigationExpert())


# What holds of every map


@pytest.mark.parametrize("policy", [NavigationExpert(), DraggingExpert(), RandomPolicy()], ids=lambda p: p.name)
def test_everything_survives_what_cannot_fly_so_far(policy: Policy) -> None:
    # 120 s at less than 1.5 km/s, and the evader goes no faster than 0.3 km/s.
    far = shots(policy, parse_axis("launch_range_m=220e3:400e3:3"))
    assert (far.survived == 1.0).all()
    assert far.closest_m.min() > 1e3


@pytest.mark.parametrize("policy", [NavigationExpert(), DraggingExpert()], ids=lambda p: p.name)
def test_nothing_escapes_at_short_range_from_nose_and_tail(policy: Policy) -> None:
    near = shots(policy, parse_axis("launch_range_m=6e3:9e3:4"), parse_axis("aspect_deg=-180:0:2"))
    assert (near.survived == 0.0).all()
    assert near.closest_m.max() <= DRILL.missile.fuse_m
    assert near.time_s.max() < 30.0


def test_a_missile_reaches_farther_against_a_nose_than_after_a_tail(straight: Envelope) -> None:
    last = {row["aspect_deg"]: row["last_hit_m"] for row in straight.boundaries()}
    assert last[0.0] is not None and last[-180.0] is not None
    assert last[0.0] > 1.5 * last[-180.0]


def test_maps_of_a_policy_without_handedness_are_mirror_images(dragging: Envelope, straight: Envelope) -> None:
    # Column k is -180° + 20° k; -180° and 0° have no partner. Rounding may move single cells across the boundary.
    mirror = -np.arange(18) % 18
    for study in (dragging, straight):
        assert (study.survived != study.survived[:, mirror]).sum() <= 2
        assert 0.1 < study.survived.mean() < 0.9  # it is not all one colour


def test_a_policy_that_always_turns_left_has_no_mirror_image() -> None:
    # The negative control of the test above.
    class Left:
        name, layout = "left", None

        def act(self, observation: np.ndarray, layout: object) -> np.ndarray:
            return np.full((len(observation), 1), 0.5, np.float32)

    survived = shots(Left()).survived
    assert (survived != survived[:, -np.arange(18) % 18]).sum() > 5


def test_half_a_turn_to_either_side_is_the_same_side() -> None:
    both = shots(DraggingExpert(), RANGES, parse_axis("aspect_deg=-180:180:2"))
    np.testing.assert_array_equal(both.survived[:, 0], both.survived[:, 1])


def test_degrees_and_radians_name_the_same_sides(dragging: Envelope) -> None:
    radians = shots(DraggingExpert(), RANGES, Axis("aspect_rad", tuple(math.radians(v) for v in ROUND.values)))
    np.testing.assert_array_equal(radians.survived, dragging.survived)
    np.testing.assert_array_equal(radians.closest_m, dragging.closest_m)


def test_axes_may_change_places(dragging: Envelope) -> None:
    swapped = shots(DraggingExpert(), ROUND, RANGES)
    np.testing.assert_array_equal(swapped.survived.T, dragging.survived)
    assert swapped.boundaries() == dragging.boundaries()


# The same bytes, however it is flown


@pytest.mark.parametrize(("threads", "lanes"), [(2, 1024), (1, 50), (3, 3 * 128)])
def test_threads_and_lanes_change_no_byte(threads: int, lanes: int) -> None:
    # More than 128 lanes a thread, else a single one is used.
    x = parse_axis("launch_range_m=5e3:35e3:22")
    one, other = (shots(DraggingExpert(), x, **how) for how in ({"threads": 1}, {"threads": threads, "lanes": lanes}))
    assert json.dumps(one.to_json()) == json.dumps(other.to_json())


def test_a_learned_policy_draws_the_same_map_twice_on_any_threads() -> None:
    policy = resolve_policy("submas-target")
    one, other = (shots(policy, parse_axis("launch_range_m=10e3:30e3:15"), threads=threads) for threads in (1, 2))
    assert one.to_json() == other.to_json()


# A cell is the flight it stands for


@pytest.mark.parametrize(("i", "j"), [(0, 9), (3, 0), (5, 4), (6, 11), (11, 17)])
def test_a_cell_equals_the_flight_flown_by_hand(dragging: Envelope, i: int, j: int) -> None:
    task = shot_task(DRILL)
    act, world = bind(DraggingExpert(), task), World(task, 1)
    row = _by_hand(RANGES.values[i], math.radians(ROUND.values[j]))
    observation, seen, steps = world.reset(episodes=[0], states=row), [], 0
    world.trace()
    while world.outcome[0] == Outcome.FLYING and world.fate[0, 0] != Fate.EVADED:
        observation = world.step(act(observation)).observation
        seen.append(np.linalg.norm(world.traced(0)[:, 14:17] - world.traced(0)[:, 0:3], axis=1))
        steps += 1
    assert dragging.survived[i, j] == (world.outcome[0] != Outcome.SHOT_DOWN)
    assert dragging.time_s[i, j] == steps * task.scenario.rules.step_s
    # Between two recorded instants, 50 ms apart, the missile flies at most some 100 m.
    assert dragging.closest_m[i, j] == pytest.approx(np.concatenate(seen).min(), abs=60.0)


def _by_hand(range_m: float, aspect_rad: float) -> np.ndarray:
    start, more = DRILL.start, shot_states(shot_task(DRILL).scenario, np.ones(1), np.zeros(1), 0, np.zeros(1, int))
    evader = [0.0, 0.0, start.altitude_m, 0.0, start.evader_speed_m_s]
    x, y = range_m * math.cos(aspect_rad), range_m * math.sin(aspect_rad)
    shooter = [x, y, start.altitude_m, math.atan2(-y, -x), start.interceptor_speed_m_s]
    return np.concatenate([[*evader, *shooter], more[0, 10:]])[None]


def test_a_shot_ends_only_by_the_missile() -> None:
    # Flown over the edge of a narrow field, and longer than an engagement may last.
    rules, sizes = {"max_steps": 5, "outside_steps": 0}, {"width_m": 10e3}
    small = changed(battlefield=sizes, rules=rules, start={"y_spread_m": 5e3})
    ranges, aspects = parse_axis("launch_range_m=20e3:30e3:3"), parse_axis("aspect_deg=0:90:2")
    left, usual = (envelope(DraggingExpert(), scenario, ranges, aspects) for scenario in (small, DRILL))
    np.testing.assert_array_equal(left.survived, usual.survived)
    np.testing.assert_array_equal(left.time_s, usual.time_s)


def test_cells_of_two_scenario_numbers_are_evaluations_of_that_scenario() -> None:
    x, y = parse_axis("launch.range_m=20e3:40e3:2"), parse_axis("missile.burn_s=4:10:2")
    study = envelope(DraggingExpert(), DRILL, x, y, masked={3, 4}, episodes=12, seed=5)
    assert (study.kind, study.missiles) == ("engagement", (1, 2))
    for i, range_m in enumerate(x.values):
        for j, burn_s in enumerate(y.values):
            cell = changed(launch={"range_m": range_m}, missile={"burn_s": burn_s})
            told = evaluate(DraggingExpert(), Task(cell, frozenset({3, 4})), 12, 5)
            assert study.exited[i, j] == told.success_rate
            assert study.survived[i, j] == pytest.approx(1.0 - told.outcomes["shot_down"] / 12)
            assert study.time_s[i, j] == pytest.approx(told.mean_length_s)


def test_no_missile_is_never_close() -> None:
    x, y = parse_axis("launch.missiles=1:4:2"), parse_axis("launch.range_m=1e3:2e3:2")
    study = envelope(NavigationExpert(), changed(launch={"range_min_m": 5e3}), x, y, episodes=2)
    assert (study.survived == 1.0).all() and np.isnan(study.closest_m).all()
    assert (x.values, study.missiles) == ((1.0, 4.0), (1, 2, 3, 4))


def test_a_number_of_the_scenario_goes_with_an_aspect() -> None:
    x, held = parse_axis("missile.burn_s=1:12:4"), [parse_held("launch_range_m=15e3")]
    study = shots(NavigationExpert(), x, ROUND, held=held)
    assert study.held == {"launch_range_m": 15e3}
    # The longer the motor burns, the more sides it reaches.
    assert (np.diff(study.survived.mean(axis=1)) <= 0.0).all()
    assert study.survived[0].mean() > study.survived[-1].mean()


def test_what_is_not_given_of_a_shot_is_nose_on_at_the_scenarios_range() -> None:
    study = shots(NavigationExpert(), parse_axis("missile.burn_s=4:8:2"), parse_axis("start.altitude_m=3e3:9e3:2"))
    assert study.kind == "engagement"
    study = shots(NavigationExpert(), parse_axis("missile.burn_s=4:8:2"), RANGES)
    assert study.held == {"aspect_deg": 0.0}
    study = shots(NavigationExpert(), parse_axis("missile.burn_s=4:8:2"), ROUND)
    assert study.held == {"launch_range_m": DRILL.launch.range_m}


# Its figures


def test_boundaries_along_the_range() -> None:
    made = shots(NavigationExpert(), parse_axis("launch_range_m=1e3:6e3:6"), parse_axis("aspect_deg=0:30:4"))
    columns = ([0, 1, 0, 0, 1, 0], [1, 1, 1, 1, 1, 1], [0, 0, 0, 0, 0, 0], [1, 0.5, 0.5, 0, 0.5, 1])
    made = dataclasses.replace(made, survived=np.array(columns, float).T)
    limits = [tuple(row.values())[1:] for row in made.boundaries()]
    assert limits == [(3e3, 4e3, 6e3), (None, None, None), (1e3, 6e3, 6e3), (4e3, 4e3, 5e3)]


def test_rows_and_json_hold_the_same_numbers(dragging: Envelope) -> None:
    told, rows = dragging.to_json(), list(dragging.rows())
    assert len(rows) == 12 * 18
    assert list(rows[0]) == ["launch_range_m", "aspect_deg", "survived", "closest_m", "time_s"]
    for name in ("survived", "closest_m", "time_s"):
        assert [row[name] for row in rows] == np.array(told[name]).ravel().tolist()
    assert (told["digest"], told["scenario"], told["kind"]) == (DRILL.digest, "drill", "shot")
    assert told["y"] == {"name": "aspect_deg", "unit": "deg", "values": list(ROUND.values)}


def test_progress_counts_every_flight() -> None:
    told: list[tuple[int, int]] = []
    x, y = parse_axis("launch_range_m=5e3:9e3:2"), parse_axis("missile.burn_s=4:8:3")
    shots(NavigationExpert(), x, y, episodes=2, progress=lambda done, total: told.append((done, total)))
    assert told[-1] == (12, 12)
    assert told == sorted(told) and {total for _, total in told} == {12}


# What is refused


def test_numbers_that_contradict_each_other_are_named_before_anything_flies() -> None:
    with pytest.raises(ScenarioError, match=r"propellant_kg is not below missile.mass_kg \(with missile.propellant_kg"):
        shots(NavigationExpert(), parse_axis("missile.propellant_kg=50:200:4"), parse_axis("missile.burn_s=4:8:2"))


def test_one_quantity_twice_is_refused() -> None:
    with pytest.raises(AxisError, match="aspect is given twice"):
        shots(NavigationExpert(), ROUND, parse_axis("aspect_rad=-3:3:3"))
    with pytest.raises(AxisError, match="launch_range_m is given twice"):
        shots(NavigationExpert(), held=[parse_held("launch_range_m=5e3")])


def test_a_study_without_end_is_refused() -> None:
    with pytest.raises(AxisError, match="flights; legal are 1 to"):
        shots(NavigationExpert(), episodes=10**8)


def test_a_mask_without_a_missile_is_refused() -> None:
    with pytest.raises(MaskError, match="every missile is masked"):
        shots(NavigationExpert(), masked={1, 2, 3, 4})


def test_a_policy_that_does_not_know_the_missile_says_so() -> None:
    with pytest.raises(PolicyError, match=r"cannot see missile 2 of this task"):
        shots(resolve_policy("submas-source-3"), masked={1})
