"""Learning curves follow metrics rows, in place."""

from __future__ import annotations

from typing import Any

import numpy as np

from layouts.learning_curves import held_out_columns, learning_curves, stage_columns, training_columns


def _rows(count: int) -> list[dict[str, Any]]:
    return [
        {
            "stage": i // 10,
            "task": f"source-{3 - i // 10}",
            "alpha": 1.0 - i / count,
            "epsilon": 0.8,
            "beta": i / count,
            "train_success_rate": 0.5,
            "train_return_mean": None,
            "success_rate": 0.9 if i % 5 == 0 else None,
            "return_mean": 400.0 if i % 5 == 0 else None,
        }
        for i in range(count)
    ]


def test_epochs_count_through_the_stages() -> None:
    rows = _rows(25)
    assert list(training_columns(rows)["epoch"]) == list(range(1, 26))
    stages = stage_columns(rows)
    assert list(stages["epoch"]) == [0.5, 10.5, 20.5]
    assert list(stages["task"]) == ["source-3", "source-2", "source-1"]


def test_only_evaluated_epochs_are_dots() -> None:
    assert list(held_out_columns(_rows(12))["epoch"]) == [1.0, 6.0, 11.0]


def test_a_missing_number_is_a_gap() -> None:
    assert np.isnan(training_columns(_rows(3))["train_return_mean"]).all()


def test_update_changes_the_sources_in_place() -> None:
    curves = learning_curves()
    source = curves.training
    curves.update(_rows(12))
    assert curves.training is source
    assert len(source.data["epoch"]) == 12


def test_a_long_run_stays_light() -> None:
    assert len(training_columns(_rows(9000))["epoch"]) <= 2500
