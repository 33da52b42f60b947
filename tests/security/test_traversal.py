"""S8: no address leads out of the folder it stands for."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.conftest import Served

CANARY = b"canary-6f1d"
ESCAPES = [
    "../canary.rrd",
    "..%2fcanary.rrd",
    "%2e%2e/canary.rrd",
    "%2e%2e%2fcanary.rrd",
    "%252e%252e%252fcanary.rrd",
    "..\\canary.rrd",
    "..%5ccanary.rrd",
    "./../canary.rrd",
    "x/../../canary.rrd",
    "/canary.rrd",
    "{absolute}",
    "%2f{absolute}",
    "../rrd-evil/canary.rrd",
    "canary.rrd%00",
    "%00canary.rrd",
    "..%c0%afcanary.rrd",
    "%e2%80%a5/canary.rrd",  # a two dot leader
    "%ef%bc%8e%ef%bc%8e/canary.rrd",  # full-width dots
    "C:/canary.rrd",
    "*.rrd",
    ".canary.rrd",
    "link.rrd",
    "linked/canary.rrd",
    "a" * 5000 + ".rrd",
]
ROUTES = ["/rrd/", "/rerun/", "/viser/", "/viser/abcdefgh/", "/static/", "/"]


@pytest.fixture(scope="module")
def canary(served: Served) -> Iterator[Path]:
    """A file beside the recordings, one in a sibling folder, and links to it from inside."""
    outside, recordings = served.cache / "canary.rrd", served.cache / "rrd"
    sibling = served.cache / "rrd-evil"
    for folder in (recordings, sibling):
        folder.mkdir(parents=True, exist_ok=True)
    for path in (outside, sibling / "canary.rrd", recordings / ".canary.rrd"):
        path.write_bytes(CANARY)
    (recordings / "link.rrd").symlink_to(outside)
    (recordings / "linked").symlink_to(sibling)
    (recordings / "real.rrd").write_bytes(b"RRF2")
    yield outside
    for name in ("link.rrd", "linked", "real.rrd"):
        (recordings / name).unlink()


@pytest.mark.parametrize("route", ROUTES)
@pytest.mark.parametrize("escape", ESCAPES)
def test_no_address_leads_out(served: Served, canary: Path, route: str, escape: str) -> None:
    reply = served.ask(route + escape.format(absolute=canary))
    assert CANARY not in reply.body
    assert reply.status in (302, 400, 403, 404), reply.status


def test_what_is_inside_is_served(served: Served, canary: Path) -> None:
    reply = served.ask("/rrd/real.rrd")
    assert (reply.status, reply.body) == (200, b"RRF2")
    assert reply.headers["content-type"] == "application/octet-stream"
