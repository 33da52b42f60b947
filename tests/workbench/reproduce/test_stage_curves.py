"""Stages from metrics rows, curves that are thinned, seeds brought to common times."""

from __future__ import annotations

import numpy as np
import pytest

from tests.workbench.reproduce.samples import made
from workbench.reproduce.result_set import Curve
from workbench.reproduce.seed_curves import at_steps, common_steps, summary
from workbench.reproduce.stage_curves import MOST_POINTS, StageRecord, points_per_curve, stage_records, thinned


def row(task: str, epoch: int, success: float | None, mean_return: float | None = 1.0) -> dict[str, object]:
    return {
        "task": task, "epoch": epoch, "env_steps": 1000 * epoch, "wall_s": 2.5 * epoch, "cpu_s": 2.0 * epoch,
        "success_rate": success, "return_mean": mean_return if success is not None else None,
    }  # fmt: skip


def test_stages_end_with_their_last_row_and_keep_what_was_held_out() -> None:
    rows = [row("source-3", 1, None), row("source-3", 2, 0.51, 10.0), row("source-3", 3, None), row("target", 1, 0.25)]
    stages = stage_records(rows)
    assert list(stages) == ["source-3", "target"]
    assert stages["source-3"] == StageRecord(3, 3000, 7.5, 6.0, (2000,), (0.51,), (10.0,))
    assert stages["target"].epochs == 1


def test_a_run_without_rows_has_no_stages() -> None:
    assert stage_records([]) == {}


def long_stage(points: int) -> StageRecord:
    steps = tuple(range(1, points + 1))
    return StageRecord(points, points, 1.0, 1.0, steps, tuple(step / points for step in steps), (0.0,) * points)


@pytest.mark.parametrize("points", [2, 7, 100])
def test_a_thinned_curve_keeps_its_ends_and_its_pairs(points: int) -> None:
    whole, thin = long_stage(300), thinned(long_stage(300), points)
    assert len(thin.steps) == points
    assert (thin.steps[0], thin.steps[-1]) == (1, 300)
    assert all(share == step / 300 for step, share in zip(thin.steps, thin.success_rate, strict=True))
    assert (thin.epochs, thin.env_steps) == (whole.epochs, whole.env_steps)


def test_a_short_curve_stays_as_it_is() -> None:
    assert thinned(long_stage(30), 30) == long_stage(30)


def test_points_are_shared_out() -> None:
    assert points_per_curve([]) == points_per_curve([300] * 32) == MOST_POINTS
    assert points_per_curve([300] * 200) == 16
    # Stages that were passed early leave their room to the others.
    assert points_per_curve([300] * 20 + [10] * 180) == 70
    assert points_per_curve([300] * 10**4) == 2


def curve(steps: tuple[int, ...], values: tuple[float, ...]) -> Curve:
    return Curve(variant="submas", task="target", seed=0, env_steps=steps, success_rate=values, mean_return=values)


def test_between_evaluations_the_latest_counts_and_behind_the_end_the_last() -> None:
    seed = curve((10, 20, 40), (0.1, 0.2, 0.4))
    assert at_steps(seed, "success_rate", np.array([5.0, 10.0, 19.0, 20.0, 39.0, 40.0, 99.0])).tolist() == [
        0.1, 0.1, 0.1, 0.2, 0.2, 0.4, 0.4,
    ]  # fmt: skip


def test_a_seed_that_has_passed_does_not_leave_the_mean() -> None:
    # Three seeds pass early at 100 %, one struggles on: without the early ones the mean would fall at the end.
    early, late = curve((10,), (1.0,)), curve((10, 20, 30), (0.0, 0.1, 0.2))
    steps, interval = summary([early, early, early, late], "success_rate")
    assert steps.tolist() == common_steps([late]).tolist() == [10.0, 20.0, 30.0]
    assert interval.value.tolist() == [1.0, 1.0, 1.0]


def test_a_sample_has_a_summary_for_every_algorithm() -> None:
    result = made("fig9", success=lambda variant, *_: 0.9 if variant == "submas" else 0.0)
    curves = [one for one in result.curves if one.variant == "submas"]
    _, interval = summary(curves, "success_rate")
    assert interval.value.tolist() == pytest.approx([0.9] * 3)
