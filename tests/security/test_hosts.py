"""S4: the server answers to its own names only, whatever the port, so that no foreign name can be pointed at it."""

from __future__ import annotations

import pytest

from tests.conftest import Served

OURS = ["127.0.0.1:{port}", "localhost:{port}", "LOCALHOST:{port}", "[::1]:{port}", "localhost:9000", "localhost"]
FOREIGN = [
    "evil.example",
    "evil.example:{port}",
    "localhost.evil.com:{port}",
    "127.0.0.1.nip.io:{port}",
    "127.0.0.2:{port}",
    "127.0.0.10:{port}",
    "0.0.0.0:{port}",
    "0x7f000001:{port}",
    "localhost.:{port}",
    "localhost:{port}:80",
    "localhost:{port}@evil.example",
    "user@localhost:{port}",
    "localhost:port",
    "localhost, evil.example",
    "localhost evil.example",
    "[::1",
    "::1",
    "",
]


@pytest.mark.parametrize("host", OURS)
def test_our_names_are_answered(served: Served, host: str) -> None:
    host = host.format(port=served.port)
    assert served.ask("/healthz", host=host).status == 200
    assert served.upgrade("/fly/ws", host=host, origin=f"http://{host}") == 101


@pytest.mark.parametrize("host", FOREIGN)
def test_other_names_are_refused(served: Served, host: str) -> None:
    host = host.format(port=served.port)
    assert served.ask("/healthz", host=host).status in (400, 403)
    assert served.upgrade("/fly/ws", host=host, origin=f"http://{host}") in (400, 403)


@pytest.mark.parametrize("host", ["evil.example", "localhost.evil.com"])
def test_the_token_does_not_help_a_foreign_name(served: Served, host: str) -> None:
    assert served.ask(f"/fly?token={served.token}", host=host).status == 403


def test_two_host_headers_are_refused(served: Served) -> None:
    assert served.ask("/healthz", hOST="evil.example").status in (400, 403)


def test_an_absolute_address_is_refused(served: Served) -> None:
    assert served.ask("http://evil.example/healthz").status == 403
