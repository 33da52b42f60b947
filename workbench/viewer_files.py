"""The Rerun web viewer as static files of our own server: taken from the installed wheel once per version.

The wheel holds the viewer only inside its program, which is started on loopback for a second and asked for it. Viewer
and recordings then always have the same version, and nothing comes from the internet.
"""

from __future__ import annotations

import contextlib
import gzip
import importlib.metadata
import importlib.util
import os
import re
import shutil
import socket
import subprocess
import tempfile
import time
import urllib.error
import urllib.request
from collections.abc import Iterator
from pathlib import Path

from sim.errors import SubMasError
from workbench.cache_folder import cache_folder
from workbench.run_files import waiting_lock

FILES = ("index.html", "re_viewer.js", "re_viewer_bg.wasm", "favicon.ico")
PATIENCE_S = 30.0
_FOREIGN_LINKS = re.compile(rb'<link[^>]*href="https?://[^>]*>\s*', re.DOTALL)


class ViewerError(SubMasError):
    """The installed Rerun wheel does not give its web viewer."""


def viewer_folder() -> Path:
    """The folder of the viewer that belongs to the installed `rerun-sdk`, whether it is there yet or not."""
    return cache_folder() / f"rerun-viewer-{importlib.metadata.version('rerun-sdk')}"


def ensure_viewer() -> Path:
    """The viewer's folder, filled when it was not: 1 s, plus 4 s to compress; several processes may ask at once.

    Raises:
        ViewerError: the wheel's program does not start, or the cache folder cannot be written.
    """
    folder = viewer_folder()
    if folder.is_dir():
        return folder
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        with waiting_lock(folder.parent / ".viewer.lock"):
            if not folder.is_dir():
                _fill(folder)
    except OSError as error:
        raise ViewerError(f"the Rerun viewer cannot be put into {folder}: {error}") from error
    return folder


def _fill(folder: Path) -> None:
    """A complete folder appears under its name, or none."""
    with tempfile.TemporaryDirectory(dir=folder.parent, prefix=".viewer-") as scratch:
        fresh = Path(scratch, "viewer")
        fresh.mkdir()
        with _wheel_server(Path(scratch)) as address:
            for name in FILES:
                (fresh / name).write_bytes(_get(f"{address}/{'' if name == 'index.html' else name}"))
        page = fresh / "index.html"
        page.write_bytes(_FOREIGN_LINKS.sub(b"", page.read_bytes()))
        for name in ("re_viewer.js", "re_viewer_bg.wasm"):
            with (fresh / name).open("rb") as plain, gzip.open(fresh / f"{name}.gz", "wb", compresslevel=6) as packed:
                shutil.copyfileobj(plain, packed, 1 << 20)
        os.replace(fresh, folder)


@contextlib.contextmanager
def _wheel_server(home: Path) -> Iterator[str]:
    """The wheel's own viewer server on loopback, for a moment. In a home of its own it sends no usage data."""
    viewer_port, data_port = _free_ports(2)
    command = [str(_wheel_program()), "--serve-web", "--bind", "127.0.0.1"]
    command += ["--web-viewer-port", str(viewer_port), "--port", str(data_port)]
    environment = {"HOME": str(home), "CI": "1", "PATH": os.environ.get("PATH", "")}
    quiet = subprocess.DEVNULL
    with subprocess.Popen(command, env=environment, stdin=quiet, stdout=quiet, stderr=quiet) as process:
        try:
            address = f"http://127.0.0.1:{viewer_port}"
            _await(address, process)
            yield address
        finally:
            process.kill()


def _wheel_program() -> Path:
    spec = importlib.util.find_spec("rerun_cli")
    folders = list(spec.submodule_search_locations or []) if spec else []
    if not folders or not Path(folders[0], "rerun").is_file():
        raise ViewerError(
            "the installed rerun-sdk has no viewer program; reinstall it: pip install --force-reinstall rerun-sdk"
        )
    return Path(folders[0], "rerun")


def _free_ports(count: int) -> list[int]:
    with contextlib.ExitStack() as open_sockets:
        sockets = [open_sockets.enter_context(socket.socket()) for _ in range(count)]
        for each in sockets:
            each.bind(("127.0.0.1", 0))
        return [each.getsockname()[1] for each in sockets]


def _get(address: str) -> bytes:
    direct = urllib.request.build_opener(urllib.request.ProxyHandler({}))
    with direct.open(address, timeout=PATIENCE_S) as reply:
        return reply.read()


def _await(address: str, process: subprocess.Popen[bytes]) -> None:
    deadline = time.monotonic() + PATIENCE_S
    while True:
        try:
            _get(address + "/favicon.ico")
            return
        except (urllib.error.URLError, ConnectionError) as error:
            if process.poll() is not None or time.monotonic() > deadline:
                raise ViewerError(f"the viewer program of rerun-sdk did not start: {error}") from error
            time.sleep(0.05)
