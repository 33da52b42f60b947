"""Live 3-D scenes behind the front door: one loopback viser server per page session, reached under `/viser/<session>/`.

viser itself knows neither users nor origins. Ours listen on loopback only and accept a websocket only with an origin
that nobody but this process knows, so another site's page or another user of the machine cannot pass the front door by.
A scene is there to be looked at: of what its page says only where the camera is and what it sees is passed on.
"""

from __future__ import annotations

import asyncio
import functools
import importlib.util
import secrets
import threading
from pathlib import Path
from typing import TYPE_CHECKING, Any

from tornado.httpclient import HTTPRequest
from tornado.web import HTTPError
from tornado.websocket import (
    WebSocketClientConnection,
    WebSocketClosedError,
    WebSocketHandler,
    websocket_connect,
)

from workbench.guard import SCENE_CSP

if TYPE_CHECKING:
    import viser

MESSAGE_LIMIT_BYTES = 64 * 1024 * 1024
LOOKS = frozenset({"ViewerCameraMessage", "GetRenderResponseMessage"})
"""What a scene's page may tell its server; presses, uploads, typed values and requests to be shared are dropped."""
QUIET = b"""<script>{
  const {warn} = console
  console.warn = (...words) => { if (!String(words[0]).startsWith("THREE.Clock: ")) warn(...words) }
}</script>"""
"""A note from one library to another about its next version, which nobody who looks at a scene can follow."""
_construction = threading.Lock()


class ViserRegistry(dict[str, "viser.ViserServer"]):
    """The viser servers that are reachable through the front door, by session name."""

    def __init__(self) -> None:
        super().__init__()
        self.origin = f"http://{secrets.token_hex(16)}.invalid"

    def open(self) -> tuple[str, viser.ViserServer]:
        """Start a server for one page session (about 10 ms): its name and itself. Its page is at `/viser/<name>/`."""
        name = secrets.token_urlsafe(12)
        self[name] = _loopback_server(self.origin)
        return name, self[name]

    def close(self, name: str) -> None:
        """Stop the server of a session; done beside the caller, as viser takes up to a second to stop."""
        server = self.pop(name, None)
        if server is not None:
            threading.Thread(target=server.stop, name=f"stop viser {name}", daemon=True).start()

    def close_all(self) -> None:
        """Stop every server, for the end of the process."""
        for name in tuple(self):
            self.close(name)


def _loopback_server(origin: str) -> viser.ViserServer:
    import rich
    import viser
    import websockets.asyncio.server as sockets
    from websockets.typing import Origin

    class PrivateServer(viser.ViserServer):
        """Never opens the public tunnel that any client could ask viser for."""

        def request_share_url(self, verbose: bool = True) -> str | None:
            """There is no share address."""
            return None

    rich.reconfigure(quiet=True)  # viser announces itself on standard output, address and all
    with _construction:
        # viser offers no way to name the origins it accepts; it looks `serve` up when it starts.
        plain = sockets.serve
        sockets.serve = functools.partial(plain, origins=[Origin(origin)])  # pyright: ignore[reportAttributeAccessIssue]
        try:
            server = PrivateServer(host="127.0.0.1", port=0, verbose=False)
        finally:
            sockets.serve = plain
    server.gui.configure_theme(show_logo=False, show_share_button=False)
    return server


def only_looks(message: str | bytes) -> bool:
    """Whether a message of a scene's page is one of LOOKS; what cannot be read is not."""
    import msgspec

    try:
        return isinstance(message, bytes) and msgspec.msgpack.decode(message, type=dict[str, Any])["type"] in LOOKS
    except (msgspec.DecodeError, KeyError, TypeError, RecursionError):
        return False


@functools.lru_cache(maxsize=1)
def _client_page() -> bytes:
    spec = importlib.util.find_spec("viser")
    if spec is None or spec.origin is None:
        raise HTTPError(404)
    page = (Path(spec.origin).parent / "client" / "build" / "index.html").read_bytes()
    return page.replace(b"<head>", b"<head>" + QUIET, 1)


class ViserHandler(WebSocketHandler):
    """viser's page on GET, and on the same path a websocket that is passed on to the session's server."""

    def initialize(self, registry: ViserRegistry) -> None:
        """Called by Tornado with the servers there are."""
        self.registry = registry
        self._subprotocol: str | None = None
        self._upstream: WebSocketClientConnection | None = None
        self._pump: asyncio.Task[None] | None = None

    def check_origin(self, origin: str) -> bool:
        """The front door has compared the origin with the host already."""
        return True

    async def get(self, *args: Any, **kwargs: Any) -> None:
        """The page, or the upgrade to a websocket."""
        if args[0] not in self.registry:
            raise HTTPError(404)
        if self.request.headers.get("Upgrade", "").lower() == "websocket":
            await super().get(*args, **kwargs)
            return
        self.set_header("Content-Type", "text/html; charset=utf-8")
        self.set_header("Content-Security-Policy", SCENE_CSP)
        self.set_header("Cache-Control", "private, no-cache")
        self.finish(_client_page())

    def select_subprotocol(self, subprotocols: list[str]) -> str | None:
        """Viser checks the version of its page through the subprotocol."""
        self._subprotocol = next((name for name in subprotocols if name.startswith("viser-v")), None)
        return self._subprotocol

    async def open(self, *args: str, **kwargs: str) -> None:
        """Connect to the session's server; Tornado keeps messages back until this returns."""
        server = self.registry.get(args[0])
        if server is None:
            self.close(1001, "this scene is gone")
            return
        request = HTTPRequest(f"ws://127.0.0.1:{server.get_port()}", headers={"Origin": self.registry.origin})
        names = [self._subprotocol] if self._subprotocol else None
        try:
            self._upstream = await websocket_connect(request, subprotocols=names, max_message_size=MESSAGE_LIMIT_BYTES)
        except OSError:
            self.close(1001, "this scene is gone")
            return
        self._pump = asyncio.create_task(self._pass_down(self._upstream))

    async def _pass_down(self, upstream: WebSocketClientConnection) -> None:
        try:
            while (message := await upstream.read_message()) is not None:
                await self.write_message(message, binary=isinstance(message, bytes))
        except WebSocketClosedError:
            return
        self.close(upstream.close_code, upstream.close_reason)

    async def on_message(self, message: str | bytes) -> None:
        """Pass a message of the page on to the session's server, if it only looks."""
        if self._upstream is not None and only_looks(message):
            try:
                await self._upstream.write_message(message, binary=isinstance(message, bytes))
            except WebSocketClosedError:
                self.close(1001, "this scene is gone")

    def on_close(self) -> None:
        """The page went away."""
        if self._upstream is not None:
            self._upstream.close()


def viser_routes(registry: ViserRegistry) -> list[tuple[str, type[ViserHandler], dict[str, object]]]:
    """The route of all sessions."""
    return [(r"/viser/([A-Za-z0-9_-]{8,64})/?", ViserHandler, {"registry": registry})]
