"""What trainings cost: speeds measured in earlier runs or by a probe, runs that wait for a core, and what is usual."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from agents.config import TrainingConfig
from workbench import estimate as estimating
from workbench import speed_probe
from workbench.estimate import TYPICAL_EPOCH_S, Speed, estimate, estimate_set, queue_s
from workbench.policies import shipped_cards
from workbench.run_files import append_line
from workbench.run_state import RunState
from workbench.runs import RunStore


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> RunStore:
    monkeypatch.setattr(speed_probe, "cache_folder", lambda: tmp_path / "cache")
    monkeypatch.setattr(estimating, "cpu_count", lambda: 2)
    return RunStore(tmp_path / "runs")


def test_the_estimate_takes_the_speed_of_earlier_runs(store: RunStore) -> None:
    config = TrainingConfig(profile="smoke", curriculum=True)
    epochs = config.hyperparameters.epochs
    typical = estimate(config, 1, store.list())
    assert typical.at_most_s == 4 * epochs * TYPICAL_EPOCH_S["smoke"]
    run = store.create(config)
    append_line(run.path / "metrics.jsonl", {"epoch": 2, "wall_s": 10.0})
    measured = estimate(config, 3, store.list())
    # Three seeds on two cores are two rounds of four stages at five seconds an epoch.
    assert measured.at_most_s == 2 * 4 * epochs * 5.0
    assert measured.measured_runs == 1


def test_a_damaged_row_is_not_a_speed(store: RunStore) -> None:
    config = TrainingConfig(profile="smoke")
    for text in ("{\n", "[1]\n", '{"epoch": 0, "wall_s": 1}\n', ""):
        (store.create(config).path / "metrics.jsonl").write_text(text)
    assert estimate(config, 1, store.list()).measured_runs == 0


def test_a_run_starts_when_a_core_is_free() -> None:
    assert queue_s([5.0, 1.0, 1.0, 1.0], 2) == 5.0
    assert queue_s([1.0, 1.0, 1.0, 5.0], 2) == 6.0


def test_a_set_counts_every_variant_with_its_own_speed_and_stages(store: RunStore) -> None:
    chain, alone = TrainingConfig(curriculum=True), TrainingConfig(variant="sac", missiles=2)
    cost = estimate_set([chain, alone], [], {"fast": Speed(1.0, "probe")})
    # 4 stages of 100 epochs at 1 s beside one stage of 2 × 100 epochs, at the typical speed: nobody probed SAC.
    assert cost.at_most_s == max(400.0, 200 * TYPICAL_EPOCH_S["fast"])
    assert cost.stages == 4 and cost.at_once == 2
    assert {kind: speed.source for kind, speed in (cost.speeds or {}).items()} == {
        ("fast", "td3"): "probe", ("fast", "sac"): "typical",
    }  # fmt: skip
    assert cost.likely_s is None


def test_what_is_usual_is_what_earlier_runs_took(store: RunStore) -> None:
    config = TrainingConfig(curriculum=True, order="1,2,3,4")
    assert estimate(config, 1, []).likely_s is None  # nothing shipped was trained in this order
    for seed, wall_s in enumerate((100.0, 300.0, 200.0)):
        store.create(TrainingConfig(curriculum=True, order="1,2,3,4", seed=seed)).write_state(
            RunState("finished", wall_s=wall_s)
        )
    store.create(TrainingConfig(curriculum=True)).write_state(RunState("finished", wall_s=9.0))
    assert estimate(config, 2, store.list()).likely_s == 200.0
    # Table 1's chain: with the epochs of the shipped policies, at the speed that was measured.
    assert estimate_set([TrainingConfig(curriculum=True)], [], {"fast": Speed(2.0, "probe")}).likely_s == 2.0 * sum(
        card.epoch for card in shipped_cards().values()
    )


def test_a_probe_is_remembered_and_a_damaged_memory_forgotten(store: RunStore) -> None:
    speed_probe.remember("fast", Speed(4.5, "probe", when="today"))
    assert speed_probe.remembered() == {"fast": Speed(4.5, "probe", when="today")}
    path = speed_probe.cache_folder() / speed_probe.FILE
    for text in (
        "{",
        '{"fast": 3}',
        '{"fast": {"epoch_s": -1.0, "when": "x"}}',
        '{"fast": {"epoch_s": "1", "when": ""}}',
    ):
        path.write_text(text)
        assert speed_probe.remembered() == {}


def test_a_probe_measures_in_a_process_of_its_own_and_is_remembered(store: RunStore) -> None:
    speed = asyncio.run(speed_probe.probe("smoke"))
    assert speed.source == "probe" and 0.0 < speed.epoch_s < 600.0
    assert speed_probe.remembered() == {"smoke": speed}


def test_a_probe_that_fails_says_why(store: RunStore) -> None:
    with pytest.raises(speed_probe.ProbeError, match="usage: python -m"):
        asyncio.run(speed_probe.probe("quick"))


def test_a_probe_of_nothing_is_a_usage_error(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(speed_probe.sys, "argv", ["speed_probe", "quick"])
    assert speed_probe.main() == 2
    assert "paper|fast|smoke" in capsys.readouterr().err
