"""Starting and stopping the server: every refusal is one sentence with the way out."""

from __future__ import annotations

import fcntl
import os
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest

from sim.errors import UsageError
from tests.conftest import Served, start_server
from workbench.server import ServeError, claim, serve


def _refusal(*arguments: str) -> tuple[int, str]:
    command = [sys.executable, "-m", "workbench", "serve", "--no-browser", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert done.stdout == ""
    assert "Traceback" not in done.stderr
    assert done.stderr.count("\n") == 1
    return done.returncode, done.stderr


def test_a_second_server_of_the_same_runs_names_the_first(served: Served) -> None:
    code, sentence = _refusal("--runs", str(served.runs), "--port", "0")
    assert code == 1
    assert f"already served at {served.address}/ (process {served.process.pid})" in sentence
    assert served.token not in sentence


def test_a_port_in_use_is_one_sentence(tmp_path: Path) -> None:
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        code, sentence = _refusal("--runs", str(tmp_path), "--port", str(port))
    assert (code, sentence) == (
        1,
        f"workbench: port {port} is in use; choose another with --port, or --port 0 for any free one\n",
    )


@pytest.mark.parametrize("port", [-1, 65536])
def test_an_impossible_port_is_a_usage_error(tmp_path: Path, port: int) -> None:
    with pytest.raises(UsageError, match=f"port {port} does not exist; choose 1 to 65535"):
        serve(tmp_path, port)


def test_a_runs_folder_that_is_a_file_is_one_sentence(tmp_path: Path) -> None:
    path = tmp_path / "runs"
    path.write_text("")
    with pytest.raises(ServeError, match=r"cannot be written \(file exists\); choose another with --runs"), claim(path):
        pass


def test_a_claim_ends_with_its_process_and_leaves_no_address(tmp_path: Path) -> None:
    with claim(tmp_path) as lock:
        os.pwrite(lock, b"http://127.0.0.1:1/", 0)
        with pytest.raises(ServeError, match=r"already served at http://127\.0\.0\.1:1/"), claim(tmp_path):
            pass
    with claim(tmp_path) as lock:
        assert (tmp_path / ".serve.lock").read_text() == ""
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)


@pytest.mark.parametrize(("number", "code"), [(signal.SIGINT, 130), (signal.SIGTERM, 0)])
def test_a_signal_ends_it_cleanly(tmp_path: Path, number: signal.Signals, code: int) -> None:
    served = start_server(tmp_path)
    assert served.ask("/healthz").body == b"ok"
    served.process.send_signal(number)
    assert served.process.wait(timeout=20) == code
    assert "Traceback" not in served.log.read_text()
    assert (served.runs / ".serve.lock").read_text() == ""


@pytest.mark.slow
def test_a_killed_server_leaves_nothing_in_the_way(tmp_path: Path) -> None:
    first = start_server(tmp_path)
    first.process.kill()
    first.process.wait()
    second = start_server(tmp_path)
    assert second.token != first.token
    assert second.ask("/healthz", cookie=first.cookie).status == 401
    second.process.terminate()
    assert second.process.wait(timeout=20) == 0


def test_the_first_answer_comes_soon(served: Served) -> None:
    begin = time.monotonic()
    assert served.ask("/healthz").status == 200
    assert time.monotonic() - begin < 2.0
