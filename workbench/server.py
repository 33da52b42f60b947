"""The one place that binds a socket: pages, viewers, recordings and live scenes at one guarded address."""

from __future__ import annotations

import asyncio
import contextlib
import errno
import gc
import os
import platform
import signal
import sys
import threading
import webbrowser
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from sim.errors import SubMasError, UsageError, shorten
from workbench.guard import Guard, stand_before
from workbench.launcher import tend
from workbench.run_files import take_lock
from workbench.server_log import forgive_leaving, show_log

if TYPE_CHECKING:
    from panel.io.server import Server

    from workbench.context import AppContext

HOST = "127.0.0.1"
OWN_NAMES = (HOST, "localhost")
LOCK = ".serve.lock"
INTERRUPTED = 130
MESSAGE_LIMIT_BYTES = 8 * 1024 * 1024
"""Largest message of a page: a picture of the 3-D scene; everything else is small."""
REQUEST_LIMITS = {"max_header_size": 64 * 1024, "max_body_size": 64 * 1024, "body_timeout": 10.0,
                  "idle_connection_timeout": 60.0}  # fmt: skip
"""Nothing here takes a body; who sends one, or a request drop by drop, is not waited for [bytes, s]."""


class ServeError(SubMasError):
    """The server cannot start here."""


def serve(runs: Path, port: int = 5006, browser: bool = True, host: str = HOST) -> int:
    """Serve until SIGINT (returns 130) or SIGTERM (returns 0).

    Args:
        runs: the runs folder, made when missing; one server at a time.
        port: 0 takes any free one.
        browser: whether to open the pages in the person's browser.
        host: an address of this machine that nobody else can reach.

    Raises:
        UsageError: an impossible port, or a host that others can reach.
        ServeError: the port or the runs folder is taken, or the folder cannot be written.
    """
    if not 0 <= port <= 65535:
        raise UsageError(f"port {port} does not exist; choose 1 to 65535, or 0 for any free one (--port)")
    if host not in OWN_NAMES:
        raise UsageError(
            f"--host {shorten(host)}: the pages start processes as you and are served to this machine alone; "
            f"from another machine run 'ssh -L {port or 5006}:localhost:{port or 5006} {shorten(platform.node())}' "
            f"and open http://localhost:{port or 5006}/ there"
        )
    show_log()
    with claim(runs) as lock:
        return asyncio.run(_serve(runs, port, browser, lock))


@contextlib.contextmanager
def claim(runs: Path) -> Iterator[int]:
    """Hold the runs folder for one server; yields the lock file, which tells the next who tries the address."""
    path = runs / LOCK
    try:
        runs.mkdir(parents=True, exist_ok=True)
        lock = take_lock(path)
    except OSError as error:
        reason = (error.strerror or str(error)).lower()
        raise ServeError(
            f"the runs folder '{runs}' cannot be written ({reason}); choose another with --runs"
        ) from error
    if lock is None:
        raise ServeError(
            f"the runs folder '{runs}' is already served{_where(path)}; "
            "open that one, stop it, or choose another folder with --runs"
        )
    try:
        yield lock
    finally:
        with contextlib.suppress(OSError):
            os.ftruncate(lock, 0)
        os.close(lock)


def _where(lock: Path) -> str:
    with contextlib.suppress(OSError):
        if text := lock.read_text().strip():
            return f" at {text}"
    return ""


async def _serve(runs: Path, port: int, browser: bool, lock: int) -> int:
    from workbench.context import AppContext
    from workbench.warm_up import warm_up

    context, guard = AppContext.of(runs), Guard()
    server = build(context, guard, port)
    loop = asyncio.get_running_loop()
    loop.set_exception_handler(forgive_leaving)
    end: asyncio.Future[int] = loop.create_future()
    for number, code in ((signal.SIGINT, INTERRUPTED), (signal.SIGTERM, 0)):
        loop.add_signal_handler(number, lambda code=code: end.done() or end.set_result(code))
    gc.freeze()  # modules stay: to walk over them in search of garbage stops every page for a third of a second
    server.start()
    _announce(f"http://{HOST}:{server.port}/", guard.token, lock, browser)
    threading.Thread(target=warm_up, args=(context,), name="warm-up", daemon=True).start()
    queue = asyncio.create_task(tend(context.store))
    try:
        return await end
    finally:
        queue.cancel()
        server.stop()
        context.viser.close_all()


def build(context: AppContext, guard: Guard, port: int) -> Server:
    """The server, listening on loopback but not yet answering; needs a running event loop."""
    from panel.io.server import get_server

    from workbench.app import PAGES, TITLE, applications
    from workbench.file_routes import file_routes
    from workbench.viser_proxy import viser_routes

    try:
        server = get_server(
            dict(applications(context)),
            port=port,
            address=HOST,
            title={name: f"{title} · {TITLE}" for name, title in PAGES.items()},
            websocket_origin=["*"],  # the guard compares origin and host on any port; Bokeh could only know fixed ones
            use_index=False,
            http_server_kwargs=dict(REQUEST_LIMITS),
            websocket_max_message_size=MESSAGE_LIMIT_BYTES,
            check_unused_sessions_milliseconds=5000,  # a page that was left stops its clock and scene soon
            extra_patterns=[
                *file_routes(context.recordings.folder),
                *viser_routes(context.viser),
                *_first_page(next(iter(PAGES))),
            ],
        )
    except OSError as error:
        raise _port_error(port, error) from error
    stand_before(server._tornado, guard)  # Bokeh has no public way to its Tornado application
    return server


def _first_page(name: str) -> list[tuple[str, type, dict[str, object]]]:
    from tornado.web import RedirectHandler

    return [(r"/", RedirectHandler, {"url": f"/{name}", "permanent": False})]


def _port_error(port: int, error: OSError) -> SubMasError:
    if error.errno == errno.EADDRINUSE:
        return ServeError(f"port {port} is in use; choose another with --port, or --port 0 for any free one")
    return ServeError(f"port {port} cannot be opened ({error.strerror}); choose another with --port")


def _announce(address: str, token: str, lock: int, browser: bool) -> None:
    """The token is printed, and nowhere else: not in the lock file, not in a log."""
    with contextlib.suppress(OSError):  # a full disk: the pages open all the same, the lock holds without words
        os.ftruncate(lock, 0)
        os.pwrite(lock, f"{address} (process {os.getpid()})\n".encode(), 0)
    link = f"{address}?token={token}"
    print(f"SubMas workbench: {link}\nCtrl-C stops it; trainings go on.", flush=True)
    if browser and _has_screen():
        threading.Thread(target=webbrowser.open, args=(link,), name="browser", daemon=True).start()


def _has_screen() -> bool:
    """On a machine without a screen `webbrowser` would start a text browser in this terminal."""
    return sys.platform in ("darwin", "win32") or any(os.environ.get(name) for name in ("DISPLAY", "WAYLAND_DISPLAY"))
