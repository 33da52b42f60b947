"""Runs on a Ray cluster are those of this machine, bit for bit, whatever dies on the way; nothing is lost."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import pytest

from agents.config import TrainingConfig
from sim.errors import UsageError
from tests.cluster.conftest import OpenEngine
from tests.cluster.following import await_, await_ends, kill_training, kill_worker, trainings
from tests.reliability.test_kill import assert_same_policies, rows, told, uninterrupted
from workbench.engine import LocalEngine
from workbench.launcher import stop_now
from workbench.run_folder import Run
from workbench.runs import RunBusyError, RunStore

HELD_AT = 3


def config(store: RunStore, seed: int, hold: int = HELD_AT) -> TrainingConfig:
    """A training of six epochs, which waits on a cluster after the third for the file `go` beside the runs."""
    return TrainingConfig(missiles=1, seed=seed, name=f"hold={hold} go={store.root.parent / 'go'}")


def reached(run: Run, request: str) -> bool:
    """Whether a request stands in the run's folder on its node."""
    return any(Path(tempfile.gettempdir()).glob(f"workbench-run-*/{run.id}/{request}"))


def held(run: Run, at: int = HELD_AT) -> bool:
    """Whether the head knows so many epochs and a checkpoint behind them."""
    return len(run.metrics()) == at and (run.path / f"checkpoints/manifest-{at:06}.json").exists()


def assert_same(run: Run, whole: Run) -> None:
    assert rows(run) == rows(whole)
    assert told(run) == told(whole)
    assert_same_policies(run, whole)
    assert not (run.path / "checkpoints").exists()


def resumed(run: Run) -> list[str]:
    return [event["text"] for event in run.events() if event["kind"] == "resumed"]


def test_a_killed_worker_and_a_killed_training_cost_nothing_when_streamed(store: RunStore, engine: OpenEngine) -> None:
    with engine(run_folders="streamed") as ray:
        runs = [ray.launch(config(store, seed)) for seed in (1, 2)]
        await_(ray, lambda: all(held(run) for run in runs), *runs)
        assert {run.state.state for run in runs} == {"running"} and all(run.is_alive() for run in runs)
        assert len({run.state.node for run in runs}) == 2, "one on each node"
        assert not any(run.state.pid for run in runs), "a number of another machine's process"
        kill_worker(runs[0])
        kill_training(runs[1])
        await_ends(ray, *runs)
    for run in runs:
        assert run.state.state == "finished" and run.state.retries == 1
        assert [text.partition(" at ")[2] for text in resumed(run)] == [f"checkpoint {HELD_AT}, 50% done"]
        assert_same(run, uninterrupted(store, run.config))
    assert not list(store.root.glob(".shared-*"))


def test_a_removed_node_costs_nothing_on_shared_storage(store: RunStore, engine: OpenEngine, cluster: Any) -> None:
    with engine(run_folders="shared") as ray:
        runs = [ray.launch(config(store, seed)) for seed in (1, 2)]
        await_(ray, lambda: all(held(run) for run in runs), *runs)
        lost = max(cluster.worker_nodes, key=lambda node: node.unique_id)
        cluster.remove_node(lost, allow_graceful=False)
        await_(ray, lambda: any(run.state.retries for run in runs), *runs)
        (store.root.parent / "go").touch()
        await_ends(ray, *runs)
    cluster.add_node(num_cpus=1, include_dashboard=False, object_store_memory=80 * 2**20, node_ip_address="127.0.0.1")
    assert sorted(run.state.retries for run in runs) == [0, 1]
    for run in runs:
        assert run.state.state == "finished" and len(resumed(run)) == run.state.retries
        assert_same(run, uninterrupted(store, run.config))


def test_stop_pause_and_the_end_at_once_reach_a_node_and_a_paused_run_goes_on_here(
    store: RunStore, engine: OpenEngine
) -> None:
    go = store.root.parent / "go"
    with engine(run_folders="streamed") as ray:
        paused, ended = (ray.launch(config(store, seed)) for seed in (1, 2))
        waiting, stopped = (ray.launch(config(store, seed, hold=6)) for seed in (3, 4))
        await_(ray, lambda: held(paused) and held(ended), paused, ended)
        assert waiting.state.state == "queued" and ray.free() == 0
        waiting.request_stop()
        await_(ray, lambda: not waiting.is_alive(), waiting)
        assert waiting.state.state == "stopped" and not waiting.metrics(), "it never began"
        with pytest.raises(RunBusyError):
            LocalEngine(store).resume(paused)
        stop_now(ended)  # it hangs in an epoch that never ends
        await_ends(ray, ended)
        assert ended.state.state == "stopped" and len(ended.metrics()) == HELD_AT
        await_(ray, lambda: bool(stopped.metrics()), stopped)
        stopped.request_stop()
        paused.request_pause()
        await_(ray, lambda: reached(stopped, "stop") and reached(paused, "pause"), paused, stopped)
        go.touch()
        await_ends(ray, paused, stopped)
    assert (paused.state.state, stopped.state.state) == ("paused", "stopped")
    assert not trainings(paused) and not trainings(stopped)
    LocalEngine(store).resume(paused)
    await_(LocalEngine(store), lambda: not (paused.state.active or paused.is_alive()), paused)
    assert paused.state.state == "finished" and paused.state.engine == ""
    assert_same(paused, uninterrupted(store, paused.config))


def test_what_a_command_leaves_goes_on_with_the_next_one_and_a_hopeless_run_fails(
    store: RunStore, engine: OpenEngine
) -> None:
    with engine(retries=0) as ray:
        left, hopeless = (ray.launch(config(store, seed)) for seed in (1, 2))
        await_(ray, lambda: held(left) and held(hopeless), left, hopeless)
        kill_training(hopeless)
        await_ends(ray, hopeless)
        assert hopeless.state.state == "failed"
        assert hopeless.state.error.startswith("its process died (signal 9), 1 times, the last time on ")
    assert left.state.state == "interrupted" and not trainings(left)
    with engine() as ray:
        ray.resume(left)
        (store.root.parent / "go").touch()
        await_ends(ray, left)
    assert left.state.state == "finished" and left.state.resumes == 1
    assert_same(left, uninterrupted(store, left.config))


def twice(number: int, deaths: str) -> int:
    """Dies the first time it is called."""
    import os
    import signal

    if number == 1 and not Path(deaths).exists():
        Path(deaths).touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return 2 * number


def test_each_call_of_a_study_is_a_task_and_one_that_dies_is_made_again(engine: OpenEngine, tmp_path: Path) -> None:
    with engine() as ray:
        found = dict(ray.each(twice, [(number, str(tmp_path / "died")) for number in range(4)]))
    assert found == {0: 0, 1: 2, 2: 4, 3: 6} and (tmp_path / "died").exists()


@pytest.mark.parametrize("needs", [{"gpus_per_run": 1.0}, {"cpus_per_run": 2.0}])
def test_what_no_node_has_is_said_before_anything_begins(
    needs: dict[str, float], engine: OpenEngine, store: RunStore
) -> None:
    with pytest.raises(UsageError, match=r"^no node of this Ray has "), engine(**needs):
        pytest.fail("it began")
    assert not store.list()
