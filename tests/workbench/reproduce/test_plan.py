"""Plans: what every item needs, on episodes that nothing has met before."""

from __future__ import annotations

import pytest
import tyro

from agents.config import TrainingConfig
from agents.stage import FINAL_SEEDS, HELD_OUT_SEEDS, TRAINING_SEEDS
from sim.task import Task, task_for
from workbench.commands.reproduce import Args, plans_of
from workbench.reproduce import plan as planning
from workbench.reproduce.matching import training_key
from workbench.reproduce.plan import CHAIN, make_plan, training_of
from workbench.reproduce.protocol import REPORT_SEED, SELECTION_SEED, TRAINED_FOR
from workbench.reproduce.seed_counts import SeedCounts

SMALL = SeedCounts.each(3)


def test_table_4_needs_five_chains_and_three_trainings_from_scratch_for_each_seed() -> None:
    plan = make_plan("table4", "fast", SMALL, 1000)
    first = plan.trainings[: len(plan.trainings) // 3]
    assert {config.variant: config.curriculum for config in first} == {
        "submas": True, "wo-pd": True, "wo-pr": True, "dec-pd": True, "dec-pr": True,
        "td3": False, "ppo": False, "sac": False,
    }  # fmt: skip
    # Seed by seed: whoever looks after a while finds something of every algorithm.
    assert [config.seed for config in plan.trainings] == sorted(config.seed for config in plan.trainings)
    assert {config.missiles for config in plan.trainings} == {4}
    assert {wanted.task for wanted in plan.wanted} == {"target"}
    assert len(plan.wanted) == 2 * len(plan.trainings)  # one number to report, one to choose by


def test_fig_8_needs_four_tasks_of_five_algorithms() -> None:
    plan = make_plan("fig8", "fast", SMALL, 1000)
    assert len(plan.trainings) == 5 * 3
    assert {(w.variant, w.task) for w in plan.wanted} == {
        (variant, f"{task}")
        for variant in ("submas", "wo-pd", "wo-pr", "dec-pd", "dec-pr")
        for task in ("source-3", "source-2", "source-1", "target")
    }
    assert {wanted.purpose for wanted in plan.wanted} == {"report"}


def test_table_4_trains_nothing_that_the_figures_do_not_need() -> None:
    table, ablations, baselines = (
        {training_key(config) for config in make_plan(item, "fast", SMALL, 1000).trainings}
        for item in ("table4", "fig8", "fig9")
    )
    assert table == ablations | baselines


def test_fig_13_needs_five_tasks_and_two_policies_and_no_training() -> None:
    plan = make_plan("fig13", "fast", SMALL, 1000)
    assert not plan.trainings
    own = {wanted.task: wanted.policy for wanted in plan.wanted if wanted.variant == "submas"}
    assert own == {"source-4": "expert-navigation", **{task: f"submas-{task}" for task in CHAIN[1:]}}
    assert sum(wanted.policy == "expert-dragging" for wanted in plan.wanted) == 5
    assert not make_plan("fig12", "fast", SMALL, 1000).wanted


@pytest.mark.parametrize("task", CHAIN)
def test_masks_make_the_tasks_of_table_1(task: str) -> None:
    (wanted, *_) = [wanted for wanted in make_plan("fig13", "fast", SMALL, 1).wanted if wanted.task == task]
    assert Task(task_for().scenario, frozenset(wanted.mask)).name == task


@pytest.mark.parametrize("seed", [0, 1, 2**31 - 1])
@pytest.mark.parametrize("missiles", [1, 64])
def test_reported_episodes_are_met_nowhere_else(seed: int, missiles: int) -> None:
    # `Stage.seed` counts from TRAINING_SEEDS; the other two kinds of evaluation are shifted by whole powers of two.
    drawn = seed * 1_000 + missiles
    used = {start + drawn for start in (TRAINING_SEEDS, HELD_OUT_SEEDS, FINAL_SEEDS)}
    highest = FINAL_SEEDS + (2**31 - 1) * 1_000 + 64
    assert max(used) <= highest < SELECTION_SEED < REPORT_SEED < 2**63
    assert not used & {SELECTION_SEED, REPORT_SEED}


def test_what_cannot_be_trained_is_left_out_and_said(monkeypatch: pytest.MonkeyPatch) -> None:
    known = {name: variant for name, variant in planning.VARIANTS.items() if name not in ("sac", "ppo")}
    monkeypatch.setattr(planning, "VARIANTS", known)
    plan = make_plan("fig9", "fast", SMALL, 1000)
    assert {config.variant for config in plan.trainings} == {"submas", "td3"}
    assert plan.left_out == (
        "PPO is not run: this version cannot train it",
        "SAC is not run: this version cannot train it",
    )


@pytest.mark.parametrize(
    ("item", "episodes", "command"),
    [
        ("table4", 1000, "workbench reproduce table4 --profile fast --seeds 3"),
        ("fig9", 50, "workbench reproduce fig9 --profile fast --seeds 3 --episodes 50"),
        ("fig13", 1000, "workbench reproduce fig13"),
    ],
)
def test_a_plan_knows_its_command(item: str, episodes: int, command: str) -> None:
    assert make_plan(item, "fast", SMALL, episodes).command == command  # type: ignore[arg-type]


def test_equal_trainings_are_one() -> None:
    chain, scratch = training_of("submas", "fast", 0), training_of("td3", "fast", 0)

    def changed(config: TrainingConfig, **values: object) -> TrainingConfig:
        return TrainingConfig.from_json({**config.to_json(), **values})

    assert training_key(chain) == training_key(changed(chain, name="mine"))
    assert training_key(chain) != training_key(changed(chain, seed=1))
    assert training_key(chain) != training_key(changed(chain, guide="expert-dragging"))
    # Nothing is learned from the guide of a training from scratch.
    assert training_key(scratch) == training_key(changed(scratch, guide="expert-navigation"))


UNEQUAL = SeedCounts(ablations=2, submas=3, baselines=1)


def test_algorithms_may_have_different_numbers_of_seeds() -> None:
    plan = make_plan("table4", "fast", UNEQUAL, 1000)
    counts = {variant: sum(config.variant == variant for config in plan.trainings) for variant in TRAINED_FOR["table4"]}
    ablations = dict.fromkeys(("wo-pd", "wo-pr", "dec-pd", "dec-pr"), 2)
    assert counts == {"submas": 3, **ablations, "td3": 1, "ppo": 1, "sac": 1}
    assert [config.seed for config in plan.trainings] == sorted(config.seed for config in plan.trainings)
    assert {(w.variant, w.seed) for w in plan.wanted} == {(c.variant, c.seed) for c in plan.trainings}


@pytest.mark.parametrize(
    ("counts", "options"),
    [
        (SeedCounts.each(5), "--seeds 5"),
        (UNEQUAL, "--seeds 2 --seeds-submas 3 --seeds-baselines 1"),
        (SeedCounts(5, 10, 5), "--seeds 5 --seeds-submas 10"),
    ],
)
def test_the_command_says_how_many_seeds_of_which(counts: SeedCounts, options: str) -> None:
    assert make_plan("table4", "fast", counts, 1000).command == f"workbench reproduce table4 --profile fast {options}"
    args = tyro.cli(Args, args=["table4", *options.split()])
    assert [plan.seeds for plan in plans_of(args)] == [counts]
