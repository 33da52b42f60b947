"""S2 and S3: nothing without the token, on any route, and the token stays secret."""

from __future__ import annotations

import ast
import asyncio
import re
from pathlib import Path
from types import SimpleNamespace

import pytest
from tornado.httputil import HTTPHeaders, HTTPServerRequest, RequestStartLine
from tornado.web import Application, RequestHandler

from tests.conftest import Served
from workbench import guard
from workbench.guard import Guard, _log_request

SOURCE = Path(guard.__file__)
REFUSED = 401


def _route_patterns() -> list[str]:
    """Every route of the server, so that one added later is tried as well."""
    from workbench.context import AppContext
    from workbench.server import build

    async def patterns() -> list[str]:
        server = build(AppContext.of(Path("runs")), Guard(), port=0)
        rules = server._tornado.default_router.rules[0].target.rules
        server.stop()
        return [rule.matcher.regex.pattern for rule in rules if hasattr(rule.matcher, "regex")]

    return asyncio.run(patterns())


def _example(pattern: str) -> str:
    """A path of the pattern's shape: groups become a letter."""
    groups = re.compile(r"\((?:[^()]|\([^()]*\))*\)")
    return groups.sub("x", pattern).replace("/?", "/").rstrip("$").replace("\\", "") or "/"


@pytest.fixture(scope="module")
def paths() -> list[str]:
    """An example of every route, and of none."""
    examples = sorted({_example(pattern) for pattern in _route_patterns()})
    assert {"/fly/", "/runs/ws", "/healthz", "/rrd/x"} <= set(examples), examples
    return [*examples, "/", "/nowhere", "/rerun/index.html", "/static/js/bokeh.min.js"]


@pytest.mark.parametrize("kind", ["none", "wrong", "empty", "of another server", "token as cookie"])
def test_no_route_answers_without_the_cookie(served: Served, paths: list[str], kind: str) -> None:
    name = served.cookie.partition("=")[0]
    values = {"none": "", "wrong": f"{name}=x", "empty": f"{name}=", "of another server": "workbench_0=" + "a" * 32}
    cookie = values.get(kind, f"{name}={served.token}")
    assert {served.ask(path, cookie=cookie).status for path in paths} == {REFUSED}


def test_no_websocket_opens_without_the_cookie(served: Served, paths: list[str]) -> None:
    assert {served.upgrade(path, cookie="") for path in paths} == {REFUSED}


@pytest.mark.parametrize("token", ["", "x", "a" * 5000, "%00", "0"])
def test_a_wrong_token_is_refused(served: Served, token: str) -> None:
    assert served.ask(f"/fly?token={token}", cookie="").status == REFUSED


def test_a_websocket_takes_no_token_in_its_address(served: Served) -> None:
    for cookie in ("", None):
        assert served.upgrade(f"/fly/ws?token={served.token}", cookie=cookie) == REFUSED


def test_secrets_are_compared_in_a_time_that_tells_nothing() -> None:
    # A plain comparison ends at the first letter that differs, and how long it took can be measured.
    compared = [node for node in ast.walk(ast.parse(SOURCE.read_text("utf-8"))) if isinstance(node, ast.Compare)]
    assert len(compared) > 5
    secret = re.compile(r"self\.(token|_cookie)|\boffered\b|cookie\.value")
    assert [text for node in compared if secret.search(text := ast.unparse(node))] == []
    assert SOURCE.read_text("utf-8").count("hmac.compare_digest(") == 2


def test_every_start_has_secrets_of_its_own() -> None:
    several = [Guard() for _ in range(5)]
    for name in ("token", "_cookie", "cookie_name"):
        assert len({getattr(guard, name) for guard in several}) == 5
    assert all(len(guard.token) >= 22 and len(guard._cookie) >= 22 for guard in several)
    assert not any(guard.token in repr(guard) or guard._cookie in repr(guard) for guard in several)


def test_what_fails_is_logged_without_its_query(caplog: pytest.LogCaptureFixture) -> None:
    # Jupyter wrote cookies and addresses of whatever failed with a 5xx into its log.
    request = HTTPServerRequest(
        start_line=RequestStartLine("GET", "/fly?token=hush", "HTTP/1.1"),
        headers=HTTPHeaders({"Host": "localhost", "Cookie": "w=hush"}),
        connection=SimpleNamespace(set_close_callback=lambda _: None),  # type: ignore[arg-type]
    )  # fmt: skip
    handler = RequestHandler(Application(), request)
    handler.set_status(500)
    _log_request(handler)
    assert "GET /fly failed with status 500" in caplog.text and "hush" not in caplog.text


def test_the_token_is_exchanged_for_a_cookie_and_leaves_the_address(served: Served) -> None:
    reply = served.ask(f"/fly?mask=1%2C2&token={served.token}&seed=3", cookie="")
    assert (reply.status, reply.headers["location"]) == (302, "/fly?mask=1%2C2&seed=3")
    cookie = reply.headers["set-cookie"]
    assert "HttpOnly" in cookie
    assert "SameSite=Strict" in cookie
    assert served.token not in cookie


def test_a_link_followed_from_another_site_also_arrives(served: Served) -> None:
    reply = served.ask(f"/fly?token={served.token}", cookie="", Sec_Fetch_Site="cross-site", Sec_Fetch_Mode="navigate")
    assert (reply.status, reply.headers["refresh"]) == (200, "0; url=/fly")
    assert "set-cookie" in reply.headers


@pytest.mark.parametrize("path", ["//evil.example/", "///evil.example", "/\\evil.example", "/%2fevil.example"])
def test_the_exchange_never_leads_to_another_site(served: Served, path: str) -> None:
    location = served.ask(f"{path}?token={served.token}", cookie="").headers["location"]
    assert re.match(r"/[^/\\]", location)


def test_the_token_is_long_and_nowhere_on_disk(served: Served) -> None:
    assert len(served.token) >= 22  # 128 bit in base 64
    served.ask(f"/fly/ws?token={served.token}x", cookie="")
    written = [path for root in (served.runs, served.cache) for path in root.rglob("*") if path.is_file()]
    assert served.runs / ".serve.lock" in written
    small = [path for path in written if path.stat().st_size < 1_000_000]
    assert not [path for path in small if served.token.encode() in path.read_bytes()]
    assert served.log.read_text().count(served.token) == 1


def test_no_page_holds_the_token_or_the_cookie(served: Served) -> None:
    body = served.ask("/fly").body.decode()
    assert served.token not in body
    assert served.cookie.partition("=")[2] not in body
