"""S5 and S6: another page in the same browser can neither open a websocket nor read nor change anything."""

from __future__ import annotations

import pytest

from tests.conftest import Served

FOREIGN = [
    None,
    "",
    "null",
    "http://evil.example",
    "http://localhost.evil.com:{port}",
    "http://127.0.0.1:{port}.evil.com",
    "http://127.0.0.1:1",
    "http://127.0.0.1",
    "http://localhost:{port}",  # ours by meaning, but not the host of the page that was opened
    "https://127.0.0.1:{port}",
    "http://127.0.0.1:{port}.",
    "http://127.0.0.1.:{port}",
    "http://127.0.0.1:{port}@evil",
    "http://127.0.0.1:{port}/",
    "http://127.0.0.1:{port} http://evil.example",
    "file://",
]
SOCKETS = ["/fly/ws", "/runs/ws", "/viser/abcdefgh", "/viser/abcdefgh/", "/nowhere"]


@pytest.mark.parametrize("path", SOCKETS)
@pytest.mark.parametrize("origin", FOREIGN)
def test_websockets_of_other_pages_are_refused(served: Served, path: str, origin: str | None) -> None:
    origin = origin and origin.format(port=served.port)
    assert served.upgrade(path, origin=origin) == 403


def test_websockets_of_our_pages_open(served: Served) -> None:
    assert served.upgrade("/fly/ws") == 101
    assert served.upgrade("/fly/ws", origin=f"HTTP://127.0.0.1:{served.port}") == 101


@pytest.mark.parametrize("site", ["cross-site", "same-site"])
@pytest.mark.parametrize("mode", ["no-cors", "cors", "same-origin", "websocket", ""])
def test_other_pages_cannot_embed_what_we_serve(served: Served, site: str, mode: str) -> None:
    for path in ("/healthz", "/rerun/", "/rrd/a.rrd", "/fly"):
        assert served.ask(path, Sec_Fetch_Site=site, Sec_Fetch_Mode=mode).status == 403


@pytest.mark.parametrize("site", ["same-origin", "none"])
def test_our_own_pages_read(served: Served, site: str) -> None:
    assert served.ask("/healthz", Sec_Fetch_Site=site, Sec_Fetch_Mode="cors").status == 200


@pytest.mark.parametrize("method", ["POST", "PUT", "PATCH", "DELETE", "OPTIONS", "TRACE", "CONNECT", "MADEUP"])
@pytest.mark.parametrize("path", ["/fly", "/rrd/a.rrd", "/viser/abcdefgh", "/healthz", "/nowhere"])
def test_nothing_can_be_changed_by_a_request(served: Served, method: str, path: str) -> None:
    assert served.ask(path, method=method).status == 405
