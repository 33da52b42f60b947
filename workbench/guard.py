"""The rules of the front door: which requests come in, and what every answer says about itself.

The door stands before Tornado's routing, so a page, a websocket, a file or an error page added later is behind it too.
A request comes in when it names us as its host (no DNS rebinding), is not made by somebody else's page, only reads,
and carries the cookie that the token in the printed address is exchanged for.
"""

from __future__ import annotations

import hashlib
import hmac
import html
import logging
import re
import secrets
from dataclasses import dataclass, field
from typing import Any
from urllib.parse import parse_qsl, urlencode

from tornado.httputil import HTTPHeaders, HTTPServerRequest
from tornado.web import Application, OutputTransform, RequestHandler

# Any port: `ssh -L 9000:localhost:5006` makes the browser say localhost:9000.
OUR_HOST = re.compile(r"(localhost|127\.0\.0\.1|\[::1\])(:[0-9]{1,5})?", re.IGNORECASE)

_COMMON = (
    "default-src 'self'; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; font-src 'self' data:; "
    "connect-src 'self' data: blob:; worker-src 'self' blob:; object-src 'none'; base-uri 'none'; form-action 'self'; "
    "frame-ancestors 'self'; "
)
# Bokeh compiles its templates with Function() and loads components from blob: addresses.
PAGE_CSP = _COMMON + "script-src 'self' blob: 'unsafe-inline' 'unsafe-eval'"
# viser compiles its message readers, and its depth sorting is WebAssembly.
SCENE_CSP = _COMMON + "script-src 'self' blob: 'unsafe-inline' 'unsafe-eval' 'wasm-unsafe-eval'"
# The Rerun viewer is WebAssembly; no foreign host in `connect-src` is what keeps its telemetry off.
VIEWER_CSP = _COMMON + "script-src 'self' blob: 'unsafe-inline' 'wasm-unsafe-eval'"
HEADERS = {
    "X-Content-Type-Options": "nosniff",
    "X-Frame-Options": "SAMEORIGIN",
    "Referrer-Policy": "no-referrer",
    "Cross-Origin-Opener-Policy": "same-origin",
    "Cross-Origin-Resource-Policy": "same-origin",
    "Server": "workbench",
}

log = logging.getLogger(__name__)


@dataclass(frozen=True)
class Answer:
    """What the door says instead of letting a request in."""

    status: int
    sentence: str = ""
    location: str = ""
    """Where to go on, without the token; the cookie goes with it."""


@dataclass(frozen=True)
class Guard:
    """The secrets of one start of the server, and the judgement of each request."""

    token: str = field(default_factory=lambda: secrets.token_urlsafe(24), repr=False)
    _cookie: str = field(default_factory=lambda: secrets.token_urlsafe(24), repr=False)

    @property
    def cookie_name(self) -> str:
        """Differs between servers: browsers share cookies between all ports of a host."""
        return "workbench_" + hashlib.sha256(self.token.encode()).hexdigest()[:8]

    def judge(self, request: HTTPServerRequest) -> Answer | None:
        """None lets the request in."""
        return _foreign(request) or self._unknown(request)

    def _unknown(self, request: HTTPServerRequest) -> Answer | None:
        offered = request.query_arguments.get("token", [b""])[-1]
        if offered and _is_websocket(request):
            return Answer(401, "A websocket takes no token in its address.")  # a failed one is logged, address and all
        if offered and hmac.compare_digest(offered, self.token.encode()):
            return Answer(302, location=_without_token(request))
        cookie = request.cookies.get(self.cookie_name)
        if cookie is not None and hmac.compare_digest(cookie.value.encode(), self._cookie.encode()):
            return None
        return Answer(401, "This workbench needs its token: open the address that `workbench serve` printed.")

    def admit(self, handler: RequestHandler) -> None:
        """Give the browser the cookie that stands for the token from now on."""
        handler.set_cookie(self.cookie_name, self._cookie, httponly=True, samesite="Strict", path="/")


def _is_websocket(request: HTTPServerRequest) -> bool:
    return "websocket" in request.headers.get("Upgrade", "").lower()


def _foreign(request: HTTPServerRequest) -> Answer | None:
    host = request.headers.get("Host", "")
    if not OUR_HOST.fullmatch(host) or not (request.uri or "").startswith("/"):
        return Answer(403, "This server answers to localhost and 127.0.0.1 only.")
    if "%00" in request.path:
        return Answer(400, "An address holds no zero byte.")  # Tornado's file handlers would fail on it
    if request.method not in ("GET", "HEAD"):
        return Answer(405, "This server only answers GET and HEAD.")
    origin = request.headers.get("Origin")
    if _is_websocket(request):
        own = origin is not None and origin.lower() == f"http://{host}".lower()
        return None if own else Answer(403, "A websocket may only be opened by a page of this server.")
    if _embedded_elsewhere(request):
        return Answer(403, "Another site's page may not read from this server.")
    return None


def _embedded_elsewhere(request: HTTPServerRequest) -> bool:
    site = request.headers.get("Sec-Fetch-Site", "none")
    return site in ("cross-site", "same-site") and request.headers.get("Sec-Fetch-Mode") != "navigate"


def _without_token(request: HTTPServerRequest) -> str:
    """The same address without the token; one leading slash, as `//host` would lead to another site."""
    rest = [(key, value) for key, value in parse_qsl(request.query, keep_blank_values=True) if key != "token"]
    path = "/" + request.path.replace("\\", "/").lstrip("/")
    return path + ("?" + urlencode(rest) if rest else "")


class DoorHandler(RequestHandler):
    """Gives the door's answer to any method and any path."""

    def initialize(self, guard: Guard, answer: Answer) -> None:
        """Called by Tornado with the answer to give."""
        self.guard, self.answer = guard, answer

    async def prepare(self) -> None:
        """Answer before any method is looked at."""
        self.set_status(self.answer.status)
        if self.answer.location:
            self._let_in(self.answer.location)
        self.finish(_PAPER.format(title=self.answer.status, text=html.escape(self.answer.sentence)))

    def _let_in(self, location: str) -> None:
        self.guard.admit(self)
        self.set_header("Cache-Control", "no-store")
        if self.request.headers.get("Sec-Fetch-Site", "none") in ("none", "same-origin"):
            self.set_header("Location", location)
        else:
            # Browsers withhold a SameSite=Strict cookie along a redirect that started on another site's page.
            self.set_status(200)
            self.set_header("Refresh", f"0; url={location}")


_PAPER = (
    "<!doctype html><meta charset='utf-8'><title>{title} · SubMas workbench</title>"
    "<body style='font:16px/1.5 system-ui;max-width:40em;margin:15vh auto;padding:0 1em;color-scheme:light dark'>"
    "<h1 style='font-weight:500'>SubMas workbench</h1><p>{text}</p>"
)


class SecurityHeaders(OutputTransform):
    """Adds the security headers to every answer, errors included; a handler may set its own content policy."""

    def transform_first_chunk(
        self, status_code: int, headers: HTTPHeaders, chunk: bytes, finishing: bool
    ) -> tuple[int, HTTPHeaders, bytes]:
        """Called by Tornado before the first bytes of an answer leave."""
        for name, value in HEADERS.items():
            headers[name] = value
        if "Content-Security-Policy" not in headers:
            headers["Content-Security-Policy"] = PAGE_CSP
        for name in [name for name in headers if name.startswith("Access-Control-")]:
            del headers[name]  # Bokeh lets any site read its embedding script
        return status_code, headers, chunk


def _log_request(handler: RequestHandler) -> None:
    """Failures are logged by path alone: a query may hold the token."""
    if handler.get_status() >= 500:
        log.error("%s %s failed with status %d", handler.request.method, handler.request.path, handler.get_status())


def stand_before(application: Application, guard: Guard) -> None:
    """Put the guard before all routes of `application`, those that exist and those still to come."""
    application.add_transform(SecurityHeaders)
    application.settings["log_function"] = _log_request
    route = application.find_handler

    def find_handler(request: HTTPServerRequest, **kwargs: Any) -> Any:
        answer = guard.judge(request)
        if answer is None:
            return route(request, **kwargs)
        return application.get_handler_delegate(request, DoorHandler, {"guard": guard, "answer": answer})

    application.find_handler = find_handler
