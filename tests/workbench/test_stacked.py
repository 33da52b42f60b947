"""Runs that learn together are runs like any others: folders, stop, pause, resume, kill; and what cannot be is said."""

from __future__ import annotations

import json
import os
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from agents.checkpoint import load_policy
from agents.config import TrainingConfig
from sim.errors import UsageError
from workbench import launcher, stacked_launch
from workbench.cli import main
from workbench.launcher import drain, resume, stop_now
from workbench.runs import Run, RunStore
from workbench.stack_options import StackOptions
from workbench.stacked_launch import launch_stacked

ENTRY = Path(__file__).with_name("stacked_small_training.py")
RESUMED = Path(__file__).parents[1] / "reliability" / "small_training.py"
PATIENCE_S = 120.0
STACKED = StackOptions(stacked=True)


@pytest.fixture
def store(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[RunStore]:
    monkeypatch.setattr(stacked_launch, "ENTRY", (str(ENTRY),))
    monkeypatch.setattr(launcher, "ENTRY", (str(RESUMED),))
    monkeypatch.setenv("PYTHONPATH", str(Path(__file__).parents[2]))
    yield RunStore(tmp_path / "runs")
    for run in RunStore(tmp_path / "runs").list():
        stop_now(run)
    for child in launcher._children:
        child.wait(PATIENCE_S)


def _until(true: Callable[[], bool]) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not true():
        assert time.monotonic() < deadline, "it has not come to that"
        time.sleep(0.02)


def _ends(run: Run, state: str) -> None:
    _until(lambda: not run.state.active)
    assert run.state.state == state, (run.state.error, run.log_tail())


def _launch(store: RunStore, epochs: int, seeds: int = 2) -> list[Run]:
    configs = [TrainingConfig(missiles=2, curriculum=True, seed=seed, name=f"epochs={epochs}") for seed in range(seeds)]
    return launch_stacked(store, configs, STACKED)


def _epochs(run: Run) -> list[tuple[int, int]]:
    return [(row["stage"], row["epoch"]) for row in run.metrics()]


def test_a_smoke_training_of_two_seeds_and_two_variants_leaves_four_whole_runs(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    words = ["train", "--missiles", "1", "--profile", "smoke", "--seeds", "0,1", "--variant", "submas,td3"]
    assert main([*words, "--stacked", "--json", "--runs", str(tmp_path)]) == 0
    reports = json.loads(capsys.readouterr().out)["runs"]
    assert [(one["seed"], one["variant"]) for one in reports] == [(0, "submas"), (0, "td3"), (1, "submas"), (1, "td3")]
    runs = RunStore(tmp_path).list()
    assert [(run.problem, run.state.state, run.is_alive()) for run in runs] == [("", "finished", False)] * 4
    for run in runs:
        assert run.state.progress == 1.0 and run.config.profile == "smoke"
        assert [row["epoch"] for row in run.metrics()] == [1, 2]
        kinds = [event["kind"] for event in run.events()]
        assert kinds[:2] == ["numerics", "stage_started"] and kinds[-2:] == ["stage_finished", "finished"]
        assert "4 agents stacked on the processor" in run.events()[0]["text"]
        path = run.policy_path()
        assert path is not None
        card = load_policy(path).card
        assert card is not None and card.final
        assert (card.seed, card.variant, card.env_steps) == (run.config.seed, run.config.variant, 4096)
        assert card.command.startswith("workbench train --missiles 1 ")


def test_runs_of_a_stack_end_each_for_itself_and_go_on_each_by_itself(store: RunStore) -> None:
    runs = stopped, paused, ended, killed = _launch(store, 400, seeds=4)
    assert drain(store) == []  # nobody else starts what the stack holds
    _until(lambda: len(killed.metrics()) > 1)
    assert len({run.state.pid for run in runs}) == 1 and all(run.state.state == "running" for run in runs)
    stopped.request_stop()
    paused.request_pause()
    _ends(stopped, "stopped")
    _ends(paused, "paused")
    stop_now(ended)
    _ends(ended, "stopped")
    assert stopped.events()[-2]["kind"] == "stage_finished"  # judged at the end of its epoch
    assert ended.events()[-2]["kind"] != "stage_finished"  # ended where it stood
    seen = len(killed.metrics())
    _until(lambda: len(killed.metrics()) > seen)
    process = killed.state.pid
    assert process is not None
    os.kill(process, signal.SIGKILL)
    _ends(killed, "interrupted")
    before = _epochs(paused)
    resume(store, paused)
    _until(lambda: len(_epochs(paused)) > len(before))
    assert _epochs(paused)[: len(before)] == before
    stop_now(paused)
    _ends(paused, "stopped")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ("--device tpu", "device is 'tpu'; legal are cpu, cuda and cuda:N"),
        ("--device cuda:x", "device is 'cuda:x'; legal are cpu, cuda and cuda:N"),
        ("--simulator host", "--simulator needs --stacked or --device cuda"),
        ("--stacked --engine ray", "--engine ray trains each run by itself; leave --stacked and --device out"),
        ("--stacked --variant submas,ppo --missiles 1", "variant 'ppo' cannot be stacked"),
        ("--variant submas,best", "variant 'best' is unknown"),
    ],
)
def test_what_cannot_be_stacked_is_said_before_a_run_is_made(
    words: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["train", *words.split(), "--runs", str(tmp_path)]) == UsageError.exit_code
    assert said in capsys.readouterr().err
    assert RunStore(tmp_path).list() == []


def test_a_graphics_card_that_is_not_there_is_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    import torch

    monkeypatch.setattr(torch.cuda, "device_count", lambda: 0)
    assert main(["train", "--device", "cuda", "--runs", str(tmp_path)]) == 2
    assert "finds no graphics card here; use cpu, or see docs/gpu.md" in capsys.readouterr().err
    monkeypatch.setattr(torch.cuda, "device_count", lambda: 2)
    assert main(["train", "--device", "cuda:2", "--runs", str(tmp_path)]) == 2
    assert "legal here are cpu and cuda:0 to cuda:1" in capsys.readouterr().err
    assert RunStore(tmp_path).list() == []
