"""Pausing, resuming, dying and hanging: every run is in a named state, and whatever is resumed is started once."""

from __future__ import annotations

import dataclasses
import json
import os
import signal
import time
from collections import Counter
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from datetime import datetime, timedelta

import pytest

from agents.config import TrainingConfig
from tests.reliability.in_process import train
from workbench import cli, launcher, pulse, run_folder
from workbench.engine import LocalEngine
from workbench.follow import follow
from workbench.launcher import launch, resume, stop_now
from workbench.run_files import RunFileError
from workbench.run_state import RunState
from workbench.runs import Run, RunBusyError, RunStore

Config = Callable[..., TrainingConfig]
Wait = Callable[[Run, str], None]


def epochs(run: Run) -> list[int]:
    return [row["epoch"] for row in run.metrics()]


def until_epoch(run: Run, epoch: int) -> None:
    deadline = time.monotonic() + 30
    while len(run.metrics()) < epoch:
        assert time.monotonic() < deadline and run.state.active, run.log_tail()
        time.sleep(0.01)


def until_gone(run: Run) -> None:
    deadline = time.monotonic() + 30
    while run.is_alive():
        assert time.monotonic() < deadline, run.log_tail()
        time.sleep(0.01)


def test_a_paused_run_goes_on_where_it_was(store: RunStore, config: Config, wait: Wait) -> None:
    run = launch(store, config("epochs=30 epoch_s=0.05"))
    until_epoch(run, 2)
    run.request_pause()
    wait(run, "paused")
    done = len(epochs(run))
    assert 2 <= done < 30 and run.state.progress == pytest.approx(done / 30)
    wall_s = run.state.wall_s
    resume(store, run)
    wait(run, "finished")
    assert epochs(run) == list(range(1, 31))
    assert [event["kind"] for event in run.events()] == ["stage_started", "resumed", "finished"]
    assert run.state.resumes == 1 and run.state.wall_s > wall_s
    assert run.events()[1]["text"].startswith(f"resumed at checkpoint {done}, "), "not a row was lost"
    until_gone(run)
    assert not (run.path / "checkpoints").exists() and not (run.path / "pause").exists()


@pytest.mark.parametrize("wish", ["pause", "stop"])
def test_the_last_epoch_is_saved_however_dear_saving_is(wish: str, store: RunStore, config: Config, wait: Wait) -> None:
    run = launch(store, config("epochs=12 epoch_s=0.05 saving=0"))
    until_epoch(run, 3)
    run.request_pause() if wish == "pause" else run.request_stop()
    wait(run, "paused" if wish == "pause" else "stopped")
    done = len(epochs(run))
    resume(store, run)
    wait(run, "finished")
    assert epochs(run) == list(range(1, 13))
    (text,) = [event["text"] for event in run.events() if event["kind"] == "resumed"]
    assert text.startswith(f"resumed at checkpoint 2, {done / 12:.0%} done"), "the first, and the one that was needed"


def test_a_queued_run_is_paused_before_it_starts_and_resumed_from_its_beginning(
    store: RunStore, config: Config, wait: Wait
) -> None:
    run = store.create(config("epochs=2"))
    run.request_pause()
    assert run.state.state == "paused" and launcher.drain(store) == []
    resume(store, run)
    wait(run, "finished")
    assert epochs(run) == [1, 2]


def test_a_stopped_run_may_go_on_all_the_same(store: RunStore, config: Config, wait: Wait) -> None:
    run = launch(store, config("epochs=20 epoch_s=0.05"))
    until_epoch(run, 2)
    run.request_stop()
    wait(run, "stopped")
    resume(store, run)
    wait(run, "finished")
    assert epochs(run) == list(range(1, 21)) and not (run.path / "stop").exists()


def test_a_second_signal_in_mid_epoch_loses_that_epoch_and_no_more(store: RunStore, config: Config, wait: Wait) -> None:
    # R12
    run = launch(store, config("epochs=6 hang_at=4"))
    until_epoch(run, 3)
    stop_now(run)
    wait(run, "stopped")
    assert epochs(run) == [1, 2, 3]
    resume(store, run)
    wait(run, "finished")
    assert epochs(run) == [1, 2, 3, 4, 5, 6]


@pytest.mark.parametrize(("told", "state"), [("epochs=2", "finished"), ("epochs=4 fail_at=2", "failed")])
def test_signals_at_the_end_do_not_keep_it_from_saying_how_it_ended(
    store: RunStore, config: Config, wait: Wait, told: str, state: str
) -> None:
    # R12: the second signal of an impatient user may come when the epoch has ended and its end is being written.
    run = launch(store, config(f"{told} struck_at_end=1"))
    wait(run, state)
    assert "StopNow" not in run.log_tail()


def test_a_killed_run_is_interrupted_within_two_seconds(store: RunStore, config: Config) -> None:
    # R9
    run = launch(store, config("epochs=500 epoch_s=0.05"))
    until_epoch(run, 1)
    os.kill(run.state.pid or 0, signal.SIGKILL)
    struck = time.monotonic()
    while run.state.state != "interrupted":
        assert time.monotonic() < struck + 2.0
        time.sleep(0.005)


def test_a_hung_run_is_stalled_and_comes_back_or_is_ended(store: RunStore, config: Config, wait: Wait) -> None:
    # R9: the fake learner's patience is half a second, or ten of its epochs.
    back, ended = [launch(store, config("epochs=500 epoch_s=0.05")) for _ in range(2)]
    for run in (back, ended):
        until_epoch(run, 2)
        os.kill(run.state.pid or 0, signal.SIGSTOP)
    for run in (back, ended):
        wait(run, "stalled")
        assert run.state.active and not run.state.resumable
        with pytest.raises(RunBusyError, match="cannot be resumed: it is running"):
            resume(store, run)
    os.kill(back.state.pid or 0, signal.SIGCONT)
    wait(back, "running")
    stop_now(ended)
    wait(ended, "interrupted")


def test_jumps_of_the_clock_neither_stall_a_run_nor_turn_its_times_round(
    store: RunStore, config: Config, monkeypatch: pytest.MonkeyPatch
) -> None:
    # R20: an hour back, a day on, from one look to the next.
    jumps = iter(range(10**6))

    class Jumping(datetime):
        @classmethod
        def now(cls, tz: object = None) -> datetime:  # type: ignore[override]
            return datetime.now() + timedelta(hours=(-1, 24)[next(jumps) % 2])

    run = store.create(config("epochs=5 epoch_s=0.01"))
    monkeypatch.setattr(run_folder, "datetime", Jumping)
    monkeypatch.setattr(time, "time", lambda: Jumping.now().timestamp())
    train(run, store)
    walls = [event["wall_s"] for event in run.events()]
    assert walls == sorted(walls) and walls[0] >= 0.0 and walls[-1] < 60.0
    assert run.state.state == "finished"
    lock = run.claim()
    run.write_state(dataclasses.replace(run.state, state="running", updated="2001-01-01T00:00:00+00:00"))
    assert run.state.state == "running"
    os.close(lock or 0)


@pytest.mark.parametrize("racers", [2, 8])
def test_however_many_resume_it_is_started_once(racers: int, store: RunStore, config: Config, wait: Wait) -> None:
    # R11
    run = launch(store, config("epochs=8 epoch_s=0.02 die_at=3"))
    wait(run, "interrupted")
    (run.path / "config.json").write_text(json.dumps(config("epochs=8 epoch_s=0.02").to_json()))

    def ask(_: int) -> str:
        own = RunStore(store.root)
        try:
            resume(own, own.get(run.id))
        except RunBusyError as error:
            return "busy" if "cannot be resumed" in str(error) else str(error)
        return "started"

    with ThreadPoolExecutor(racers) as pool:
        assert Counter(pool.map(ask, range(racers))) == {"started": 1, "busy": racers - 1}
    wait(run, "finished")
    assert epochs(run) == list(range(1, 9)) and run.state.resumes == 1


@pytest.mark.parametrize("state", ["finished", "queued"])
def test_what_has_nothing_to_resume_says_so(state: str, store: RunStore, config: Config) -> None:
    run = store.create(config())
    run.write_state(RunState(state))
    words = "there is nothing left to train" if state == "finished" else "it is queued"
    with pytest.raises(RunBusyError, match=f"run {run.id} cannot be resumed: {words}"):
        resume(store, run)


def test_a_damaged_run_is_not_resumed_but_named(store: RunStore, config: Config) -> None:
    run = store.create(config())
    (run.path / "config.json").write_text("{")
    with pytest.raises(RunFileError, match=r"cannot be resumed: config.json is not JSON"):
        resume(store, store.get(run.id))


def test_when_no_checkpoint_is_whole_the_run_fails_with_the_reason(store: RunStore, config: Config, wait: Wait) -> None:
    run = launch(store, config("epochs=9 die_at=4"))
    wait(run, "interrupted")
    for path in (run.path / "checkpoints").glob("state-*"):
        path.write_bytes(b"")
    resume(store, run)
    wait(run, "failed")
    assert f"run {run.id} has no whole checkpoint: checkpoint 3 cannot be used: state-000003" in run.state.error


def test_a_damaged_newest_checkpoint_costs_an_epoch_and_is_told(store: RunStore, config: Config, wait: Wait) -> None:
    run = launch(store, config("epochs=9 die_at=5"))
    wait(run, "interrupted")
    (run.path / "checkpoints" / "state-000004.safetensors").write_bytes(b"")
    (run.path / "config.json").write_text(json.dumps(config("epochs=9").to_json()))
    resume(store, run)
    wait(run, "finished")
    assert epochs(run) == list(range(1, 10))
    (text,) = [event["text"] for event in run.events() if event["kind"] == "resumed"]
    assert text.startswith(
        "resumed at checkpoint 3, 33% done; checkpoint 4 cannot be used: state-000004.safetensors is 0"
    )


def test_saving_takes_a_small_share_of_the_time() -> None:
    pace = pulse.Pulse(began_s=100.0)
    assert pace.worth_saving(100.0)
    pace.saved(1.0)
    assert not pace.worth_saving(119.0)
    assert pace.worth_saving(121.0)


def test_patience_grows_with_the_longest_pause() -> None:
    pace = pulse.Pulse(began_s=0.0)
    assert pace.beat(3.0) == pulse.LEAST_PATIENCE_S
    assert pace.beat(63.0) == 600.0
    assert pace.beat(64.0) == 600.0


def test_the_commands_pause_and_resume(
    store: RunStore, config: Config, wait: Wait, capsys: pytest.CaptureFixture[str]
) -> None:
    run = launch(store, config("epochs=20 epoch_s=0.05"))
    until_epoch(run, 1)
    assert cli.main(["pause", run.id, "--runs", str(store.root), "--json"]) == 0
    assert json.loads(capsys.readouterr().out) == {"id": run.id, "state": "running", "pause_requested": True}
    wait(run, "paused")
    assert cli.main(["pause", run.id, "--runs", str(store.root)]) == 1
    assert f"run {run.id} is not running: it is paused" in capsys.readouterr().err
    assert cli.main(["resume", run.id, "--runs", str(store.root), "--json"]) == 0
    (told,) = json.loads(capsys.readouterr().out)["runs"]
    assert (told["id"], told["state"], told["stages"][0]["epochs"]) == (run.id, "finished", 20)
    assert cli.main(["resume", run.id, "--runs", str(store.root)]) == 1
    assert "there is nothing left to train" in capsys.readouterr().err


def test_who_follows_a_resumed_run_hears_each_event_once(
    store: RunStore, config: Config, wait: Wait, capsys: pytest.CaptureFixture[str]
) -> None:
    run = launch(store, config("epochs=6 epoch_s=0.02 hang_at=3"))
    until_epoch(run, 2)
    os.kill(run.state.pid or 0, signal.SIGKILL)
    wait(run, "interrupted")
    follow(LocalEngine(store), [resume(store, run)])
    lines = capsys.readouterr().err.splitlines()
    assert [line for line in lines if "stage 1" in line] == []
    assert len([line for line in lines if "resumed at checkpoint" in line]) == 1
