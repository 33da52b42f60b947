"""What several suites need: a workbench served by a process of its own, and a client that can say anything to it."""

from __future__ import annotations

import http.client
import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

START_PATIENCE_S = 60.0


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Browser tests come last: Playwright's event loop runs to the end, and other tests start loops of their own."""
    items.sort(key=lambda item: "browser" in item.path.parts)


@dataclass(frozen=True)
class Reply:
    """What came back."""

    status: int
    headers: dict[str, str]
    """By lower-case name."""
    body: bytes


@dataclass
class Served:
    """A running `workbench serve` and how to talk to it."""

    process: subprocess.Popen[str]
    port: int
    token: str
    runs: Path
    cache: Path
    log: Path
    cookie: str = field(default="", repr=False)

    @property
    def address(self) -> str:
        """Without a slash at the end."""
        return f"http://127.0.0.1:{self.port}"

    @property
    def link(self) -> str:
        """The printed address, token included."""
        return f"{self.address}/?token={self.token}"

    def ask(
        self, path: str, method: str = "GET", cookie: str | None = None, host: str | None = None, **headers: str
    ) -> Reply:
        """One request, sent exactly as given; `cookie` "" sends none, None the right one, header `a_b` is `a-b`."""
        given = {name.replace("_", "-"): value for name, value in headers.items()}
        cookie = self.cookie if cookie is None else cookie
        if cookie:
            given["Cookie"] = cookie
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
        connection.putheader("Host", f"127.0.0.1:{self.port}" if host is None else host)
        for name, value in given.items():
            connection.putheader(name, value)
        connection.endheaders()
        reply = connection.getresponse()
        body = b"" if reply.status == 101 else reply.read()
        connection.close()
        return Reply(reply.status, {name.lower(): value for name, value in reply.getheaders()}, body)

    def upgrade(self, path: str, origin: str | None = "own", protocol: str = "bokeh", **more: str | None) -> int:
        """The status of a websocket handshake: 101 when it is let in."""
        headers = {"Upgrade": "websocket", "Connection": "Upgrade", "Sec_WebSocket_Version": "13"}
        headers |= {"Sec_WebSocket_Key": "dGhlIHNhbXBsZSBub25jZQ==", "Sec_WebSocket_Protocol": protocol}
        if origin is not None:
            headers["Origin"] = self.address if origin == "own" else origin
        return self.ask(path, **headers, **more).status  # type: ignore[arg-type]


def start_server(folder: Path, *arguments: str) -> Served:
    """Start `workbench serve` on a free port with runs and caches in `folder`, and wait for its address."""
    log, runs, cache = folder / "serve.log", folder / "runs", folder / "cache"
    command = [sys.executable, "-m", "workbench", "serve", "--port", "0", "--no-browser", "--runs", str(runs)]
    environment = {**os.environ, "XDG_CACHE_HOME": str(cache), "PYTHONWARNINGS": "default"}
    with log.open("w") as file:
        process = subprocess.Popen(
            [*command, *arguments], stdin=subprocess.DEVNULL, stdout=file, stderr=file, text=True, env=environment
        )
    found = _await_address(process, log)
    served = Served(process, int(found[1]), found[2], runs, cache / "submas-workbench", log)
    served.cookie = served.ask(f"/?token={served.token}", cookie="").headers["set-cookie"].partition(";")[0]
    return served


def _await_address(process: subprocess.Popen[str], log: Path) -> re.Match[str]:
    deadline = time.monotonic() + START_PATIENCE_S
    while time.monotonic() < deadline and process.poll() is None:
        if found := re.search(r"http://127\.0\.0\.1:(\d+)/\?token=([\w-]+)\n", log.read_text()):
            return found
        time.sleep(0.05)
    process.kill()
    pytest.fail(f"the server did not start: {log.read_text()}")


@pytest.fixture(scope="session")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Served]:
    """One workbench for the whole session; tests leave it as they found it."""
    server = start_server(tmp_path_factory.mktemp("served"))
    yield server
    server.process.terminate()
    assert server.process.wait(timeout=30) == 0, server.log.read_text()
