"""The pages survive what happens to their folder, and trainings what happens to the pages (R6, R7, R10, R11, R19)."""

from __future__ import annotations

import errno
import os
import shutil
import signal
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil
import pytest

from agents.config import TrainingConfig
from tests.conftest import Served, start_server
from tests.reliability.test_resume import until_epoch
from tests.security.session import session
from workbench import server
from workbench.app import PAGES
from workbench.launcher import drain, launch
from workbench.runs import Run, RunStore

Config = Callable[..., TrainingConfig]
Wait = Callable[[Run, str], None]
PATIENCE_S = 60.0


def _no_config(run: Path) -> None:
    (run / "config.json").unlink()


def _folder_for_file(name: str) -> Callable[[Path], None]:
    def harm(run: Path) -> None:
        (run / name).unlink(missing_ok=True)
        (run / name).mkdir()

    return harm


def _text(name: str, text: str) -> Callable[[Path], None]:
    def harm(run: Path) -> None:
        (run / name).write_text(text)

    return harm


def _pipe(name: str) -> Callable[[Path], None]:
    def harm(run: Path) -> None:
        (run / name).unlink(missing_ok=True)
        os.mkfifo(run / name)

    return harm


def _dangling(run: Path) -> None:
    shutil.rmtree(run)
    run.symlink_to(run.parent / "nowhere")


def _file(run: Path) -> None:
    shutil.rmtree(run)
    run.write_text("not a folder")


FAULTS: dict[str, Callable[[Path], None]] = {
    "no config": _no_config,
    "no state": lambda run: (run / "state.json").unlink(),
    "torn config": _text("config.json", '{"profile": "smo'),
    "config of nests": _text("config.json", "[" * 100_000),
    "config is a list": _text("config.json", "[1, 2]"),
    "config with NaN": _text("config.json", '{"seed": NaN}'),
    "state of zero bytes": _text("state.json", "\x00" * 500),
    "empty state": _text("state.json", ""),
    "config is a folder": _folder_for_file("config.json"),
    "metrics are a folder": _folder_for_file("metrics.jsonl"),
    "config is a pipe": _pipe("config.json"),
    "metrics are a pipe": _pipe("metrics.jsonl"),
    "notes are a pipe": _pipe("notes.json"),
    "policy is a pipe": _pipe("policy.safetensors"),
    "metrics of one endless line": _text("metrics.jsonl", "x" * 3_000_000),
    "metrics with NaN": _text("metrics.jsonl", '{"epoch": NaN}\n{"epoch": 2}\n'),
    "metrics of other things": _text("metrics.jsonl", '{"epoch": "one", "return_mean": {}, "task": 3}\n'),
    "policy is junk": _text("policy.safetensors", "junk"),
    "a loop of links": lambda run: (shutil.rmtree(run), run.symlink_to(run))[1],
    "a link to nothing": _dangling,
    "a file": _file,
}


@pytest.fixture(scope="module")
def harmed(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[Served, list[str]]]:
    """A server of three good runs and one for each fault; the ids of the good ones."""
    folder = tmp_path_factory.mktemp("harmed")
    store = RunStore(folder / "runs")
    good = [store.create(TrainingConfig(profile="smoke", missiles=1, name=f"good {number}")).id for number in range(3)]
    for number in good:
        store.get(number).request_pause()  # nobody shall train it
    for name, harm in FAULTS.items():
        run = store.create(TrainingConfig(profile="smoke", missiles=1, name=name))
        run.request_pause()
        harm(run.path)
    started = start_server(folder)
    yield started, good
    started.process.terminate()
    started.process.wait(timeout=30)


@pytest.mark.parametrize("name", PAGES)
def test_bad_runs_never_hide_the_others_on_any_page(name: str, harmed: tuple[Served, list[str]]) -> None:
    # R6
    served, good = harmed
    reply = served.ask(f"/{name}?run={good[0]}&a={good[0]}&show={','.join(good)}")
    assert reply.status == 200 and b"cannot be shown" not in reply.body
    assert "Traceback" not in served.log.read_text()


@pytest.mark.parametrize(("name", "most"), [("live", 5), ("runs", 99)])
def test_each_bad_run_is_read_about_in_words(name: str, most: int, harmed: tuple[Served, list[str]]) -> None:
    served, good = harmed
    bad = [run.id for run in RunStore(served.runs).list() if run.id not in good]
    assert len(bad) == len(FAULTS)
    for run in bad[:: max(len(bad) // most, 1)]:
        reply = served.ask(f"/{name}?run={run}")
        assert reply.status == 200 and b"cannot be shown" not in reply.body
    assert "Traceback" not in served.log.read_text()


def test_a_page_that_lives_on_them_lives(harmed: tuple[Served, list[str]]) -> None:
    served, _good = harmed
    with session(served, "/runs"), session(served, "/live"):
        time.sleep(2.0)  # the pages look again twice a second
    assert served.process.poll() is None
    assert "Traceback" not in served.log.read_text()


def test_the_server_may_be_killed_and_another_finds_the_training(
    store: RunStore, config: Config, wait: Wait, tmp_path: Path
) -> None:
    # R10: the training goes on, the next server of the folder sees it, and the folder is not left locked.
    first = start_server(tmp_path)
    run = launch(store, config("epochs=200 epoch_s=0.05"))
    until_epoch(run, 2)
    first.process.send_signal(signal.SIGKILL)
    first.process.wait()
    done = len(run.metrics())
    second = start_server(tmp_path)
    try:
        assert second.ask(f"/live?run={run.id}").status == 200
        until_epoch(run, done + 2)
        assert run.state.state == "running"
        run.request_stop()
        wait(run, "stopped")
    finally:
        second.process.terminate()
        second.process.wait(timeout=30)
    assert "Traceback" not in second.log.read_text()


def test_two_launchers_of_one_folder_start_what_waits_once(store: RunStore, config: Config, wait: Wait) -> None:
    # R11: two servers cannot hold one folder; a command beside a server is the other way to be two.
    runs = [store.create(config("epochs=2")) for _ in range(4)]
    started = [run.id for each in (store, RunStore(store.root)) for run in drain(each)]
    for run in runs:
        wait(run, "finished")
    assert sorted(started) == sorted(set(started))
    assert [[row["epoch"] for row in run.metrics()] for run in runs] == [[1, 2]] * 4


def test_a_full_disk_keeps_no_page_shut(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # R7: the lock is taken, its words are lost, the address is printed.
    with server.claim(tmp_path) as lock:

        def full(*_: object) -> int:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

        monkeypatch.setattr(server.os, "pwrite", full)
        server._announce("http://127.0.0.1:1/", "secret", lock, browser=False)
    assert "http://127.0.0.1:1/?token=secret" in capsys.readouterr().out


def test_pages_that_were_left_leave_nothing_behind(served: Served) -> None:
    # R19, in small: descriptors, threads and processes come back to what they were.
    process = psutil.Process(served.process.pid)

    def held() -> tuple[int, int, int]:
        return process.num_fds(), process.num_threads(), len(process.children(recursive=True))

    def visit() -> None:
        with session(served, "/fly?seed=5"), session(served, "/runs"):
            time.sleep(0.3)

    visit()
    # What is loaded once has been loaded; the viewer's files are the last of it.
    _until(lambda: any(served.cache.glob("rerun-viewer-*")) and held() == (time.sleep(1.0), held())[1])
    before = held()
    for _ in range(2):
        visit()
    _until(lambda: all(now <= then + 3 for now, then in zip(held(), before, strict=True)))
    assert all(now <= then + 3 for now, then in zip(held(), before, strict=True)), (before, held())


def _until(holds: Callable[[], bool]) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while not holds() and time.monotonic() < deadline:
        time.sleep(0.5)
