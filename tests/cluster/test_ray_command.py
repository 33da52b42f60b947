"""`--engine ray` on the command line: on loopback alone, nothing left behind, and a sentence where Ray is missing."""

from __future__ import annotations

import contextlib
import importlib.util
import ipaddress
import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil
import pytest

from tests.cluster.conftest import skip_without_ray
from workbench import cli
from workbench.runs import Run, RunStore

PATIENCE_S = 400.0
SLOW = ("ray::DashboardAgent", "ray::RuntimeEnvAgent")
"""They notice by themselves that their node is gone, and end within two minutes."""
HELD = Path(__file__).with_name("held_command.py")
ROOT = Path(__file__).parents[2]


@pytest.fixture
def command(tmp_path: Path) -> Iterator[Callable[..., subprocess.Popen[str]]]:
    """Starts `workbench` in a session of its own, with trainings that can be held; none outlives the test."""
    skip_without_ray()
    started: list[subprocess.Popen[str]] = []
    (tmp_path / "tmp").mkdir()

    def start(*line: str) -> subprocess.Popen[str]:
        places = {"TMPDIR": str(tmp_path / "tmp"), "PYTHONPATH": str(ROOT)}
        process = subprocess.Popen(
            [sys.executable, str(HELD), *line], cwd=tmp_path, env={**os.environ, **places}, start_new_session=True,
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
        )  # fmt: skip
        started.append(process)
        return process

    yield start
    for process in started:
        for each in descendants(process.pid):
            each.kill()
        process.kill()
        process.communicate()


def descendants(pid: int) -> list[psutil.Process]:
    try:
        return psutil.Process(pid).children(recursive=True)
    except psutil.Error:
        return []


def started_run(root: Path, process: subprocess.Popen[str]) -> Run:
    """The one run, as soon as it works and has learned an epoch."""
    deadline = time.monotonic() + PATIENCE_S
    while True:
        runs = RunStore(root).list()
        if runs and runs[0].metrics():
            return runs[0]
        assert time.monotonic() < deadline and process.poll() is None, process.communicate()
        time.sleep(0.05)


def train(*more: str) -> list[str]:
    name = ["--name", "hold=1 go=never"]
    return ["train", "--missiles", "1", "--seeds", "3", "--json", "--engine", "ray", *name, *more]


def listening(processes: list[psutil.Process]) -> set[str]:
    """Addresses at which these processes wait for others."""
    found = set()
    for process in processes:
        try:
            connections = process.net_connections("inet")
        except psutil.Error:
            continue
        found |= {connection.laddr.ip for connection in connections if connection.status == psutil.CONN_LISTEN}
    return found


def is_loopback(address: str) -> bool:
    ip = ipaddress.ip_address(address)
    mapped = getattr(ip, "ipv4_mapped", None)
    return (mapped or ip).is_loopback


def assert_gone(processes: list[psutil.Process]) -> None:
    _, alive = psutil.wait_procs(processes, timeout=60)
    assert not alive, [process.cmdline() for process in alive]


def test_ray_listens_on_loopback_alone_and_ctrl_c_leaves_nothing_behind(
    command: Callable[..., subprocess.Popen[str]], tmp_path: Path
) -> None:
    process = command(*train("--run-folders", "streamed"))
    run = started_run(tmp_path / "runs", process)
    family = descendants(process.pid)
    assert any("raylet" in each.name() for each in family)
    addresses = listening([psutil.Process(process.pid), *family])
    assert len(addresses) >= 1 and all(map(is_loopback, addresses)), addresses
    assert not any("dashboard.py" in " ".join(each.cmdline()) and "--port" in each.cmdline() for each in family)
    for _ in range(2):  # to everybody, as a terminal does it
        os.killpg(process.pid, signal.SIGINT)
        time.sleep(1.0)
    out, err = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 130, err
    assert json.loads(out)["runs"][0]["state"] == "stopped" and "Traceback" not in err
    assert run.state.state == "stopped" and run.metrics()
    assert_gone(family)
    assert not [*(tmp_path / "tmp").glob("ray-*"), *(tmp_path / "tmp").glob("workbench-run-*")]


def test_when_the_command_is_killed_everything_dies_and_the_run_is_interrupted(
    command: Callable[..., subprocess.Popen[str]], tmp_path: Path
) -> None:
    process = command(*train())
    run = started_run(tmp_path / "runs", process)
    family = descendants(process.pid)
    working = [each for each in family if each.name() not in SLOW]
    process.kill()
    assert_gone(working)
    assert run.state.state == "interrupted"
    for each in set(family) - set(working):
        with contextlib.suppress(psutil.NoSuchProcess):
            each.kill()


def test_without_ray_a_sentence_says_how_to_install_it(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    found = importlib.util.find_spec
    monkeypatch.setattr(importlib.util, "find_spec", lambda name, *more: None if name == "ray" else found(name, *more))
    assert cli.main(["train", "--profile", "smoke", "--engine", "ray", "--runs", str(tmp_path / "runs")]) == 2
    assert capsys.readouterr().err == (
        "workbench: --engine ray needs Ray; install it with: pip install 'submas-workbench[cluster]'\n"
    )
    assert not (tmp_path / "runs").exists()


@pytest.mark.parametrize(
    ("line", "sentence"),
    [
        ("--engine cloud", "--engine is 'cloud'; legal are local, ray"),
        ("--ray-address auto", "--run-folders and --retries need --engine ray"),
        ("--engine ray --run-folders there", "--run-folders is 'there'; legal are auto, shared, streamed"),
        ("--engine ray --cpus-per-run 0", "--cpus-per-run is 0; legal are 0.01 to 1024"),
        ("--engine ray --gpus-per-run -1", "--gpus-per-run is -1; legal are 0 to 64"),
        ("--engine ray --retries 101", "--retries is 101; legal are 0 to 100"),
        ("--engine ray --ray-address ray://head:10001", "give HOST:PORT"),
        ("--engine ray --ray-address head", "--ray-address is 'head'; legal are auto and HOST:PORT"),
    ],
)
def test_a_mistake_is_one_sentence(
    line: str, sentence: str, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    assert cli.main(["train", "--profile", "smoke", "--runs", str(tmp_path / "runs"), *line.split()]) == 2
    err = capsys.readouterr().err
    assert sentence in err and err.count("\n") == 1
    assert not (tmp_path / "runs").exists()


def test_an_address_where_nobody_answers_is_told_at_once(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    line = ["train", "--profile", "smoke", "--engine", "ray", "--ray-address", "127.0.0.1:1"]
    assert cli.main([*line, "--runs", str(tmp_path / "runs")]) == 1
    assert capsys.readouterr().err.startswith("workbench: nobody answers at 127.0.0.1:1: ")


def test_nothing_imports_ray_unless_it_is_asked_for() -> None:
    script = (
        "import sys; from workbench import cli; cli.main(['train', '--help']); import workbench.engine, workbench.app; "
        "sys.exit(any(name.split('.')[0] == 'ray' for name in sys.modules))"
    )
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, check=False).returncode == 0
