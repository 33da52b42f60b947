"""Trainings start exactly once, within the limit, outlive who launched them, and end as they are asked to."""

from __future__ import annotations

import asyncio
import dataclasses
import os
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import pytest

from agents.config import TrainingConfig
from workbench import launcher
from workbench.launcher import drain, launch, stop_now, tend
from workbench.runs import Run, RunStore

Config = Callable[..., TrainingConfig]
Wait = Callable[[Run, str], None]


def test_a_launched_run_finishes_and_says_so(store: RunStore, config: Config, wait: Wait) -> None:
    run = launch(store, config("epochs=4"))
    wait(run, "finished")
    assert [row["epoch"] for row in run.metrics()] == [1, 2, 3, 4]
    assert [event["kind"] for event in run.events()] == ["stage_started", "finished"]
    state = run.state
    assert (state.progress, state.best_success_rate, state.eta_s) == (1.0, 1.0, None)
    assert 0.0 < state.wall_s < 60.0
    _until_dead(run)
    assert not run.is_alive()


def test_a_run_counts_as_running_from_the_moment_it_is_launched(store: RunStore, config: Config) -> None:
    # The process needs a moment to come up; the lock it inherits says "alive" all along.
    run = launch(store, config("epochs=50 epoch_s=0.1"))
    assert run.state.state == "running"
    assert run.is_alive()


def test_the_rest_waits_and_is_started_by_the_training_that_ends(
    store: RunStore, config: Config, wait: Wait, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(launcher, "cpu_count", lambda: 1)
    first, second = launch(store, config("epochs=30 epoch_s=0.01")), launch(store, config("epochs=1"))
    assert second.state.state == "queued"
    # Nobody calls drain here: the first process does when it ends.
    wait(second, "finished")
    assert first.state.state == "finished"


def test_queued_runs_start_in_the_order_they_were_asked_for(store: RunStore, config: Config) -> None:
    queued = [store.create(config("epochs=100 epoch_s=0.1", seed=seed)).id for seed in range(4)]
    started = [[run.id for run in drain(store, limit=limit)] for limit in (1, 3, 4)]
    assert started == [queued[:1], queued[1:3], queued[3:]]


def test_racing_launchers_start_every_run_once(store: RunStore, config: Config, wait: Wait) -> None:
    # R11: whoever comes first wins; readers that probe the locks meanwhile must not make a launcher give up.
    runs = [store.create(config("epochs=3", seed=seed)) for seed in range(6)]
    with ThreadPoolExecutor(8) as pool:
        stores = [RunStore(store.root) for _ in range(8)]
        asks = [pool.submit(drain, each, 100) for each in stores for _ in range(5)]
        probes = [pool.submit(lambda: [run.is_alive() for run in runs for _ in range(200)]) for _ in range(4)]
        started = Counter(run.id for ask in asks for run in ask.result())
        [probe.result() for probe in probes]
    assert started == {run.id: 1 for run in runs}
    for run in runs:
        wait(run, "finished")
        assert len(run.metrics()) == 3


def test_the_limit_on_running_trainings_holds(store: RunStore, config: Config) -> None:
    for seed in range(5):
        store.create(config("epochs=100 epoch_s=0.1", seed=seed))
    assert len(drain(store, limit=2)) == 2
    assert drain(store, limit=2) == []
    assert Counter(run.state.state for run in store.list()) == {"running": 2, "queued": 3}


def test_the_limit_holds_however_many_launch_at_once(store: RunStore, config: Config) -> None:
    # R11: each of them counts what runs before any has started its own.
    for seed in range(6):
        store.create(config("epochs=100 epoch_s=0.1", seed=seed))
    together = threading.Barrier(8)

    def ask(_: int) -> int:
        own = RunStore(store.root)
        together.wait()
        return len(drain(own, limit=2))

    with ThreadPoolExecutor(8) as pool:
        assert sum(pool.map(ask, range(8))) == 2
    assert Counter(run.state.state for run in store.list()) == {"running": 2, "queued": 4}


def test_a_killed_training_is_interrupted_and_never_started_again(store: RunStore, config: Config, wait: Wait) -> None:
    run = launch(store, config("epochs=9 die_at=3"))
    wait(run, "interrupted")
    assert len(run.metrics()) == 2
    assert drain(store) == []


def test_the_server_starts_what_a_dead_training_left_in_the_queue(
    store: RunStore, config: Config, wait: Wait, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(launcher, "cpu_count", lambda: 1)
    dying, next_one = launch(store, config("die_at=1")), launch(store, config("epochs=1"))
    wait(dying, "interrupted")
    assert next_one.state.state == "queued"
    with pytest.raises(TimeoutError):
        asyncio.run(asyncio.wait_for(tend(store, every_s=0.05), timeout=0.3))
    wait(next_one, "finished")


def test_a_reused_pid_does_not_bring_a_run_back_to_life(store: RunStore, config: Config, wait: Wait) -> None:
    # R9: the pid in state.json now belongs to this very test process.
    run = launch(store, config("die_at=1"))
    wait(run, "interrupted")
    run.write_state(dataclasses.replace(run.state, state="running", pid=os.getpid()))
    assert run.state.state == "interrupted"


@pytest.mark.parametrize("signalled", [True, False], ids=["SIGTERM", "stop file"])
def test_the_first_ask_to_stop_ends_the_epoch(signalled: bool, store: RunStore, config: Config, wait: Wait) -> None:
    run = launch(store, config("epochs=1000 epoch_s=0.05"))
    _until_learning(run)
    if signalled:
        os.kill(run.state.pid or 0, signal.SIGTERM)
    else:
        run.request_stop()
    wait(run, "stopped")
    assert 0 < len(run.metrics()) < 1000
    assert run.state.progress < 1.0
    assert _exit_code() == 0


def test_the_second_ask_ends_it_in_the_middle_of_an_epoch(store: RunStore, config: Config, wait: Wait) -> None:
    run = launch(store, config("epochs=2 epoch_s=60"))
    deadline = time.monotonic() + 20
    while not run.events() and time.monotonic() < deadline:
        time.sleep(0.01)
    stop_now(run)
    wait(run, "stopped")
    assert run.metrics() == []
    assert _exit_code() == 130


def test_a_queued_run_is_stopped_before_it_starts(store: RunStore, config: Config) -> None:
    run = store.create(config())
    run.request_stop()
    assert run.state.state == "stopped"
    assert drain(store) == []


def test_a_broken_learner_is_a_failed_run_with_its_reason(store: RunStore, config: Config, wait: Wait) -> None:
    run = launch(store, config("fail_at=2"))
    wait(run, "failed")
    assert run.state.error == "ValueError: the learner is broken"
    assert "Traceback" in run.log_tail()


def test_divergence_is_reported_and_never_plotted_as_zero(store: RunStore, config: Config, wait: Wait) -> None:
    # R14: the row is kept, strict JSON, with null where the number was not finite.
    run = launch(store, config("epochs=9 nan_at=2"))
    wait(run, "failed")
    assert run.state.error == "learning diverged: non-finite critic_loss at epoch 2 of target"
    assert [row["critic_loss"] for row in run.metrics()] == [1.0, None]
    assert "NaN" not in (run.path / "metrics.jsonl").read_text()


def test_a_run_is_not_trained_twice(store: RunStore, config: Config, wait: Wait) -> None:
    run = launch(store, config("epochs=100 epoch_s=0.1"))
    assert _train_by_hand(run) == (1, f"workbench: run {run.id} is already being trained by another process\n")
    run.request_stop()
    wait(run, "stopped")
    _until_dead(run)
    assert _train_by_hand(run) == (1, f"workbench: run {run.id} is not waiting to be trained: it is stopped\n")


def test_a_metrics_file_that_cannot_be_written_fails_the_run(store: RunStore, config: Config, wait: Wait) -> None:
    # R8: a save that did not happen is an error. A folder in the file's place works also for the superuser.
    run = store.create(config())
    (run.path / "metrics.jsonl").mkdir()
    drain(store)
    wait(run, "failed")
    assert run.state.error == "metrics.jsonl cannot be read: Is a directory"


def _exit_code() -> int:
    (child,) = launcher._children
    return child.wait(timeout=30)


def _until_learning(run: Run) -> None:
    deadline = time.monotonic() + 20
    while not run.metrics() and time.monotonic() < deadline:
        time.sleep(0.01)


def _until_dead(run: Run) -> None:
    deadline = time.monotonic() + 20
    while run.is_alive() and time.monotonic() < deadline:
        time.sleep(0.01)


def _train_by_hand(run: Run) -> tuple[int, str]:
    ended = subprocess.run(
        [sys.executable, *launcher.ENTRY, str(run.path)],
        env=launcher.environment(),
        capture_output=True,
        text=True,
        check=False,
    )
    return ended.returncode, ended.stderr
