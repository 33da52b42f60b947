"""S7: every answer, also a refusal, says that it may not be sniffed or framed, nor load anything from elsewhere."""

from __future__ import annotations

import pytest

from tests.conftest import Served
from workbench.guard import HEADERS

ANSWERS = {
    "/fly": 200,
    "/rerun/": 200,
    "/rerun/re_viewer.js": 200,
    "/healthz": 200,
    "/favicon.ico": 200,
    "/static/js/bokeh.min.js": 200,
    "/": 302,
    "/nowhere": 404,
    "/rrd/none.rrd": 404,
    "/viser/abcdefgh/": 404,
    "/fly/autoload.js": 400,
    "/fly/ws": 400,
}


@pytest.mark.parametrize("path", ANSWERS)
def test_every_answer_carries_the_headers(served: Served, path: str) -> None:
    reply = served.ask(path)
    assert reply.status == ANSWERS[path]
    _assert_headers(reply.headers)


@pytest.mark.parametrize(
    "refusal",
    [{"cookie": ""}, {"host": "evil.example"}, {"method": "DELETE"}, {"Sec_Fetch_Site": "cross-site"}],
    ids=lambda refusal: next(iter(refusal)),
)
def test_every_refusal_carries_the_headers(served: Served, refusal: dict[str, str]) -> None:
    reply = served.ask("/fly", **refusal)
    assert 400 <= reply.status < 500
    _assert_headers(reply.headers)


def _assert_headers(headers: dict[str, str]) -> None:
    for name, value in HEADERS.items():
        assert headers[name.lower()] == value
    policy = dict(part.split(maxsplit=1) for part in headers["content-security-policy"].split("; "))
    assert policy["default-src"] == policy["frame-ancestors"] == "'self'"
    assert policy["object-src"] == policy["base-uri"] == "'none'"
    assert policy["connect-src"] == "'self' data: blob:"
    assert "http" not in headers["content-security-policy"]
    assert not [name for name in headers if name.startswith("access-control-")]


def test_pages_are_not_kept_by_the_browser(served: Served) -> None:
    assert "no-store" in served.ask("/fly").headers["cache-control"]


def test_an_error_shows_no_traceback(served: Served) -> None:
    assert b"Traceback" not in served.ask("/fly/autoload.js").body
