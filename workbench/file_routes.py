"""Files that the server hands out: the Rerun viewer under `/rerun/`, recordings under `/rrd/`, scripts, `/healthz`.

Names are matched, never joined: the viewer's files are a fixed list, a recording is one name inside the cache.
"""

from __future__ import annotations

import asyncio
import hashlib
import mimetypes
import os
from pathlib import Path

from tornado.web import HTTPError, RequestHandler, StaticFileHandler

from workbench.guard import VIEWER_CSP
from workbench.viewer_files import FILES, ensure_viewer

Route = tuple[str, type[RequestHandler], dict[str, object]]
HERE = Path(__file__).parent
SCRIPTS = ("native_import", "figure_layout", "select_keys", "page_exchange")
"""Part of every page, in this order."""


class ViewerFileHandler(RequestHandler):
    """One file of the Rerun viewer, compressed when the browser can take it (13.8 MB instead of 43)."""

    async def get(self, name: str) -> None:
        """The first request of a version fills the viewer's folder, which takes some seconds."""
        name = name or "index.html"
        if name not in FILES:
            raise HTTPError(404)
        folder = await asyncio.get_running_loop().run_in_executor(None, ensure_viewer)
        path, packed = folder / name, folder / f"{name}.gz"
        self.set_header("Content-Type", mimetypes.guess_type(name)[0] or "application/octet-stream")
        self.set_header("Content-Security-Policy", VIEWER_CSP)
        self.set_header("Cache-Control", "private, no-cache")
        self.set_header("Rerun-Final-Length", str(path.stat().st_size))
        if packed.is_file():
            self.set_header("Vary", "Accept-Encoding")
        if packed.is_file() and "gzip" in self.request.headers.get("Accept-Encoding", ""):
            self.set_header("Content-Encoding", "gzip")
            path = packed
        self.finish(path.read_bytes())

    head = get


class RecordingHandler(StaticFileHandler):
    """A recording that a page has put into the cache."""

    def validate_absolute_path(self, root: str, absolute_path: str) -> str | None:
        """Refuse what leaves the cache, also through a link."""
        if not Path(os.path.realpath(absolute_path)).is_relative_to(os.path.realpath(root)):
            raise HTTPError(404)
        return super().validate_absolute_path(root, absolute_path)

    def get_content_type(self) -> str:
        """Rerun's format has no registered type."""
        return "application/octet-stream"

    def set_extra_headers(self, path: str) -> None:
        """The same name may hold a new recording after an upgrade; the browser asks again each time."""
        self.set_header("Cache-Control", "private, no-cache")


class HealthHandler(RequestHandler):
    """Says that the server answers."""

    def get(self) -> None:
        """A word, for scripts that wait for the server."""
        self.finish("ok")

    head = get


def scripts() -> dict[str, str]:
    """Name and address of each script of every page; the address changes with its words, so browsers may keep it."""
    return {name: f"/{name}.js?v={_digest(HERE / f'{name}.js')}" for name in SCRIPTS}


def _digest(path: Path) -> str:
    return hashlib.sha256(path.read_bytes()).hexdigest()[:12]


def file_routes(recordings: Path) -> list[Route]:
    """The routes of this module; `recordings` is the cache folder of `.rrd` files."""
    return [
        (r"/rerun/([a-z_]*(?:\.[a-z]+)?)", ViewerFileHandler, {}),
        (r"/rrd/([A-Za-z0-9][A-Za-z0-9._-]{0,150}\.rrd)", RecordingHandler, {"path": str(recordings)}),
        (rf"/((?:{'|'.join(SCRIPTS)})\.js)", StaticFileHandler, {"path": str(HERE)}),
        (r"/healthz", HealthHandler, {}),
    ]
