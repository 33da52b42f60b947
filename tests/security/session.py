"""A page session without a browser: it says what Bokeh's page says, so that all a page starts is running."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from contextlib import contextmanager

from websockets.sync.client import ClientConnection, connect

from tests.conftest import Served

OPEN = json.dumps({"msgid": "1", "msgtype": "PULL-DOC-REQ"}), "{}", "{}"


@contextmanager
def session(served: Served, path: str) -> Iterator[ClientConnection]:
    """The websocket of a page that has been opened at `path`; its document has been asked for and has come."""
    page = served.ask(path)
    assert page.status == 200, page.status
    (token,) = re.findall(rb'"token":"([^"]+)"', page.body)[:1]
    name = path.partition("?")[0]
    with connect(
        f"ws://127.0.0.1:{served.port}{name}/ws", origin=served.address, subprotocols=["bokeh", token.decode()],
        additional_headers={"Cookie": served.cookie}, max_size=None, proxy=None, open_timeout=60,
    ) as socket:  # fmt: skip
        _await(socket, "ACK")  # the server takes nothing before
        for part in OPEN:
            socket.send(part)
        _await(socket, "PULL-DOC-REPLY")
        yield socket


def _await(socket: ClientConnection, kind: str) -> None:
    """Read until a message of this kind has come: header, metadata and content."""
    while f'"{kind}"' not in str(socket.recv(timeout=60)):
        pass
    socket.recv(timeout=60)
    socket.recv(timeout=60)
