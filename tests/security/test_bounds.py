"""S6, S14, S15: reading changes nothing, large and slow requests are not waited for, and going remote is refused."""

from __future__ import annotations

import asyncio
import hashlib
import socket
import time
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from sim.errors import UsageError
from tests.conftest import Served
from tests.security.session import session
from workbench import cli, server
from workbench.app import PAGES
from workbench.context import AppContext
from workbench.guard import Guard
from workbench.server import MESSAGE_LIMIT_BYTES, REQUEST_LIMITS, build, serve

SOON_S = 20.0
"""Generous, as machines differ; what is refused would otherwise take minutes."""
RUN = "20260101-000000-aaaaaa"
READS = (
    "/fly?a=random&seed=1&mask=1,2&launch=1", f"/runs?view=trash&run={RUN}&delete={RUN}", f"/live?run={RUN}&stop=1",
    "/curriculum?launch=1&seeds=0-9", "/paper?run=table4", "/compare?policies=random&episodes=10&fly=1", "/healthz",
    "/rrd/none.rrd", "/viser/abcdefgh/",
)  # fmt: skip


def contents(folder: Path) -> dict[str, str]:
    """Digest of every file below a folder, but for the lock of the server and the index, which is a cache."""
    files = [path for path in folder.rglob("*") if path.is_file() and not path.name.startswith((".serve", ".index"))]
    return {str(path): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


def test_no_address_changes_anything(served: Served) -> None:
    # S6: also not with words in it that a page might take for an order; a page acts on a press alone.
    assert {path.partition("?")[0].strip("/") for path in READS} >= set(PAGES)
    run = served.runs / RUN
    run.mkdir(parents=True)
    (run / "config.json").write_text('{"profile": "smoke", "missiles": 1}')
    (run / "state.json").write_text('{"state": "finished"}')
    try:
        before = contents(served.runs)
        for path in READS:
            served.ask(path)
        with session(served, f"/live?run={RUN}&stop=1"):
            time.sleep(0.2)
        assert contents(served.runs) == before and len(before) == 2
    finally:
        for file in run.iterdir():
            file.unlink()
        run.rmdir()


@pytest.mark.parametrize("method", ["POST", "PUT"])
def test_a_large_body_is_not_taken(served: Served, method: str) -> None:
    began_s = time.monotonic()
    with socket.create_connection(("127.0.0.1", served.port), timeout=30) as plain:
        plain.sendall(
            f"{method} /fly HTTP/1.1\r\nHost: 127.0.0.1:{served.port}\r\nCookie: {served.cookie}\r\n"
            f"Content-Length: {1 << 30}\r\n\r\n".encode()
        )
        sent = 0
        try:
            for _ in range(1024):
                plain.sendall(bytes(1 << 20))
                sent += 1 << 20
        except OSError:
            pass
        assert sent < 1 << 28, "the server reads a body that nobody asked for"
    assert time.monotonic() - began_s < SOON_S
    assert served.ask("/healthz").status == 200


@pytest.mark.parametrize("what", ["one long header", "many headers", "a long address"])
def test_a_large_head_is_not_taken(served: Served, what: str) -> None:
    large = int(REQUEST_LIMITS["max_header_size"]) + 1
    try:
        if what == "one long header":
            status = served.ask("/healthz", X_Long="x" * large).status
        elif what == "many headers":
            status = served.ask("/healthz", **{f"X_{number}": "x" * 100 for number in range(large // 100)}).status
        else:
            status = served.ask("/healthz?" + "x" * large).status
    except OSError:
        status = 400  # the connection was closed without a word
    assert 400 <= status < 500
    assert served.ask("/healthz").status == 200


def test_requests_that_come_drop_by_drop_keep_nobody_waiting(served: Served) -> None:
    slow = [socket.create_connection(("127.0.0.1", served.port), timeout=30) for _ in range(100)]
    try:
        for each in slow:
            each.sendall(b"GET /healthz HTTP/1.1\r\nHost: 127.0")
        began_s = time.monotonic()
        assert served.ask("/healthz").status == 200
        assert time.monotonic() - began_s < SOON_S
    finally:
        for each in slow:
            each.close()


def test_nobody_is_waited_for_without_end() -> None:
    assert set(REQUEST_LIMITS) == {"max_header_size", "max_body_size", "body_timeout", "idle_connection_timeout"}
    assert REQUEST_LIMITS["body_timeout"] <= 60 and REQUEST_LIMITS["idle_connection_timeout"] <= 300
    assert REQUEST_LIMITS["max_body_size"] <= 1 << 20
    assert asyncio.run(_given()) == REQUEST_LIMITS


async def _given() -> dict[str, float]:
    """The limits that a server of ours works with."""
    built = build(AppContext.of(Path("runs")), Guard(), port=0)
    built.stop()
    limits = vars(built._http.conn_params) | {"idle_connection_timeout": built._http.conn_params.header_timeout}
    return {name: limits[name] for name in REQUEST_LIMITS}


def test_a_large_message_ends_its_own_page_alone(served: Served) -> None:
    with session(served, "/runs") as other, session(served, "/runs") as large:
        with pytest.raises(ConnectionClosed):
            large.send("x" * (MESSAGE_LIMIT_BYTES + 1))
            for _ in range(100):
                large.recv(timeout=30)
        assert other.ping().wait(30)
    assert served.ask("/healthz").status == 200


@pytest.mark.parametrize("message", ["", "{", "null", "[" * 100_000, '{"msgid": 1}', "\x00", b"\xff" * 1000])
def test_a_message_that_is_none_ends_its_own_page_alone(served: Served, message: str | bytes) -> None:
    with session(served, "/runs") as page:
        for _ in range(3):
            try:
                page.send(message)
            except ConnectionClosed:
                break
    assert served.ask("/runs").status == 200
    assert served.process.poll() is None


def test_many_websockets_without_a_page_are_no_page(served: Served) -> None:
    for _ in range(20):
        with connect(
            f"ws://127.0.0.1:{served.port}/fly/ws", origin=served.address, subprotocols=["bokeh", "made.up"],
            additional_headers={"Cookie": served.cookie}, proxy=None,
        ) as refused, pytest.raises(ConnectionClosed):  # fmt: skip
            refused.recv(timeout=30)
    assert served.ask("/healthz").status == 200


@pytest.mark.parametrize("host", ["0.0.0.0", "::", "", "192.168.1.7", "evil.example", "127.0.0.1.nip.io", "*", "[::]"])
def test_remote_is_refused_with_the_way_to_do_it(
    host: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    # S14
    monkeypatch.setattr(server, "_serve", lambda *_: pytest.fail("it serves"))
    with pytest.raises(UsageError, match="ssh -L 5006:localhost:5006"):
        serve(tmp_path / "runs", host=host)
    assert cli.main(["serve", "--host", host, "--runs", str(tmp_path / "runs")]) == 2
    told = capsys.readouterr()
    assert told.err.count("\n") == 1 and "this machine alone" in told.err and not told.out
    assert not (tmp_path / "runs").exists()
