"""Benchmarks of stacks say what they promise; how fast anything is, no test asks."""

from __future__ import annotations

import dataclasses
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
import torch

from agents.config import TrainingConfig
from agents.hyperparameters import SMOKE, ConfigError
from tests.reliability.fake_training import metrics_row
from workbench import follow, stacked_launch
from workbench.bench import learner as bench_learner
from workbench.bench import stacked as bench_stacked
from workbench.bench.curriculum import curriculum_result
from workbench.bench.learner import LearnerBench, LearnerCase
from workbench.bench.stacked import StackedBench, StackedCase
from workbench.cli import main
from workbench.run_files import append_line, write_json
from workbench.run_state import RunState
from workbench.runs import Run, RunStore
from workbench.stack_options import StackOptions

SMALL = dataclasses.replace(SMOKE, hidden=(8, 8), lanes=16, batch_size=8, return_steps=3)
CASE = StackedCase(2, "cuda:0", 256, 900.0, 300.0, 3.0, 1.5, 2.5)


@pytest.mark.parametrize(
    "device",
    [
        "cpu",
        pytest.param(
            "cuda:0",
            marks=[pytest.mark.gpu, pytest.mark.skipif(not torch.cuda.is_available(), reason="no CUDA device here")],
        ),
    ],
)
def test_stacks_are_measured_beside_one_seed_by_itself(device: str) -> None:
    heard: list[tuple[int, int]] = []
    threads = torch.get_num_threads()
    measured = bench_stacked.bench_stacked(
        device, (1, 3), SMALL, rounds=1, slice_s=0.0, stored=1_000, progress=lambda *told: heard.append(told)
    )
    assert heard == [(1, 2), (2, 2)] and torch.get_num_threads() == threads
    assert [(case.agents, case.device, case.batch) for case in measured.stacked] == [(1, device, 8), (3, device, 8)]
    for case in measured.stacked:
        assert min(case.agent_updates_per_s, case.one_seed_updates_per_s, case.collect_ms, case.collect_host_ms) > 0
        assert case.ratio == pytest.approx(case.agent_updates_per_s / case.one_seed_updates_per_s)
    assert measured.recorded is (device != "cpu")


def test_full_replays_hold_ends_of_episodes_and_finite_numbers() -> None:
    training = bench_stacked.full_stack(2, "cpu", SMALL)
    before = training.stack.learner.actor.values.clone()
    training.block(())
    learner = training.stack.learner
    assert torch.isfinite(learner.critics.values).all() and not torch.equal(learner.actor.values, before)
    assert learner.updates.tolist() == [SMALL.updates_per_lane_step] * 2
    assert 0.0 < float(training.stack.replay.rows[..., -training.stack.replay.features - 1].mean()) < 0.01


def test_the_device_adds_a_table_and_names_to_the_json(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    alone = LearnerBench([LearnerCase(128, "cpu", 1.0, 1.0, 1.0, 1.0, 1.0)], 5.0, "default")
    monkeypatch.setattr(bench_learner, "bench_learner", lambda progress: alone)
    asked: list[str] = []

    def measured(device: str, progress: Any) -> StackedBench:
        asked.append(device)
        return StackedBench([CASE], "a card", True)

    monkeypatch.setattr(bench_stacked, "bench_stacked", measured)
    assert main(["bench", "learner", "--json"]) == 0
    assert "stacked" not in json.loads(capsys.readouterr().out) and asked == []
    assert main(["bench", "learner", "--device", "cuda:0", "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    assert said["stacked"] == [dataclasses.asdict(CASE)] and said["recorded"] is True and asked == ["cuda:0"]
    assert main(["bench", "learner", "--device", "cuda:0"]) == 0
    shown = capsys.readouterr().out
    assert "agents stacked on a card" in shown and "3.00" in shown


def test_a_device_that_is_not_there_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ConfigError, match="legal are cpu, cuda"):
        bench_stacked.bench_stacked("abacus")
    assert main(["bench", "learner", "--device", "abacus"]) == 2
    assert "device is 'abacus'" in capsys.readouterr().err
    assert main(["bench", "sim", "--curriculum"]) == 2
    assert main(["bench", "learner", "--curriculum", "--seeds", "0"]) == 2
    assert "--seeds from 1 to 100" in capsys.readouterr().err


def _ended(store: RunStore, config: TrainingConfig, state: str, success_rate: float) -> Run:
    run = store.create(config)
    for stage in (0, 1):
        for epoch in (1, 2):
            append_line(run.path / "metrics.jsonl", {**metrics_row(epoch, 2), "stage": stage, "stages": 2})
    write_json(run.path / "policy.json", {"evaluation": {"success_rate": success_rate}})
    run.write_state(dataclasses.replace(RunState(state), wall_s=60.0 + 10.0 * config.seed))
    return run


def test_the_result_of_a_curriculum_counts_time_updates_and_judged_success(tmp_path: Path) -> None:
    store = RunStore(tmp_path)
    rates = {0: 0.9, 1: 0.8, 2: 0.1}
    runs = [
        _ended(store, TrainingConfig(curriculum=True, seed=seed), "stopped" if seed == 2 else "finished", rate)
        for seed, rate in rates.items()
    ]
    result = curriculum_result(runs, StackOptions("cuda:0", stacked=True))
    assert (result["device"], result["seeds"], result["wall_s"]) == ("cuda:0", 3, 80.0)
    # Updates begin at 0 with every stage: 20 in each of two stages of three seeds.
    assert result["updates"] == 120 and result["agent_updates_per_s"] == pytest.approx(1.5)
    assert [one["success_rate"] for one in result["runs"]] == [0.9, 0.8, None]
    assert result["success_rate_mean"] == pytest.approx(0.85) and result["success_rate_least"] == 0.8
    assert [stage["epochs"] for stage in result["runs"][0]["stages"]] == [2, 2]


def test_one_command_trains_the_seeds_together_and_writes_the_result(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    asked: list[TrainingConfig] = []

    def launch(store: RunStore, configs: Sequence[TrainingConfig], options: StackOptions) -> list[Run]:
        assert (options.device, options.together) == ("cpu", True)
        asked.extend(configs)
        return [_ended(store, config, "finished", 0.5) for config in configs]

    monkeypatch.setattr(stacked_launch, "launch_stacked", launch)
    monkeypatch.setattr(follow, "follow", lambda engine, runs: False)
    out, words = tmp_path / "result.json", ["bench", "learner", "--device", "cpu", "--curriculum", "--seeds", "3"]
    words += ["--profile", "smoke", "--runs", str(tmp_path / "runs"), "--out", str(out)]
    assert main(words) == 0
    assert "3 seeds together on cpu: " in capsys.readouterr().out
    assert [(config.seed, config.curriculum, config.profile) for config in asked] == [
        (seed, True, "smoke") for seed in range(3)
    ]
    result = json.loads(out.read_text())
    assert len(result["runs"]) == 3 and result["profile"] == "smoke" and "torch" in result["versions"]
    assert main([*words, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["seeds"] == 3
    assert main([*words[:-1], str(tmp_path / "nowhere" / "result.json")]) == 1
