"""What `workbench doctor` asks of the runs folder: room, rights, locks, its runs and their index, and of the port."""

from __future__ import annotations

import os
import shutil
import socket
import sqlite3
import stat
import tempfile
from pathlib import Path
from urllib.parse import quote

from workbench.commands.doctor_machine import Missing

FREE_GB = 2.0
CHOOSE = "choose another with --runs"


def writable(runs: Path) -> str:
    """Where it is, made when there is none."""
    try:
        runs.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryFile(dir=runs) as file:
            file.write(b"x")
            file.flush()
            os.fsync(file.fileno())
    except OSError as error:
        raise Missing(f"{runs.absolute()}: {error.strerror}", CHOOSE) from error
    return str(runs.absolute())


def locks(runs: Path) -> str:
    """Whether a lock keeps a second process out, by which a living training is known; some network folders do not."""
    from workbench.run_files import is_locked, take_lock

    try:
        with tempfile.NamedTemporaryFile(dir=runs, prefix=".doctor-") as file:
            path = Path(file.name)
            held = take_lock(path)
            kept_out = is_locked(path)
            if held is not None:
                os.close(held)
    except OSError as error:
        raise Missing(str(error.strerror), CHOOSE) from error
    if held is None or not kept_out:
        raise Missing("locks have no effect here", "use a folder on a local disk (--runs)")
    return "keep a second process out"


def permissions(runs: Path) -> str:
    """Whether only this user can put runs there, and nothing secret lies about."""
    for path in (runs, runs / ".trash", runs / ".serve.lock"):
        if not path.exists():
            continue
        found = path.stat()
        if hasattr(os, "geteuid") and found.st_uid not in (os.geteuid(), 0):
            raise Missing(f"{path.absolute()} belongs to another user", f"use a folder of your own, or chown {path}")
        if stat.S_IMODE(found.st_mode) & stat.S_IWOTH:
            raise Missing(f"everybody may write {path.absolute()}", f"chmod o-w {path}: what is written there is run")
    lock = runs / ".serve.lock"
    if lock.is_file() and "token=" in lock.read_text(errors="replace"):
        raise Missing("the lock of the server holds a token", f"stop the server, remove {lock}, start it again")
    return "written by this user alone; the token is in no file"


def free_disk(runs: Path) -> str:
    """Room on the disk of the runs."""
    there = next(folder for folder in (runs.absolute(), *runs.absolute().parents) if folder.is_dir())
    free_gb = shutil.disk_usage(there).free / 1e9
    if free_gb < FREE_GB:
        raise Missing(f"{free_gb:.1f} GB", f"free some space: runs and recordings want {FREE_GB:.0f} GB")
    return f"{free_gb:.0f} GB"


def readable(runs: Path) -> str:
    """How many runs there are, and the first that cannot be read."""
    from workbench.runs import RunStore

    every = RunStore(runs).list()
    bad = [run for run in every if run.problem]
    if bad:
        found = f"{len(bad)} of {len(every)} cannot be read: {bad[0].id}: {bad[0].problem}"
        raise Missing(found, f"the others are whole; mend it, or: workbench runs delete {bad[0].id}")
    return f"{len(every)} run{'s' * (len(every) != 1)}, all readable"


def index(runs: Path) -> str:
    """Whether the index can be used as it is; nothing is lost if not."""
    from workbench.run_index.file import NAME, VERSION

    path = runs / NAME
    if not path.exists():
        return "none yet; the server makes it"
    remedy = f"nothing to do: the server makes it anew from the runs; or remove {path}"
    try:
        database = sqlite3.connect(f"file:{quote(str(path.absolute()))}?mode=ro", uri=True, timeout=1.0)
        try:
            (version,) = database.execute("PRAGMA user_version").fetchone()
            sound = database.execute("PRAGMA quick_check(1)").fetchone() == ("ok",)
            count = database.execute("SELECT count(*) FROM run").fetchone()[0] if version == VERSION else 0
        finally:
            database.close()
    except sqlite3.Error as error:
        raise Missing(f"it cannot be read: {error}", remedy) from error
    if not sound:
        raise Missing("its pages are damaged", remedy)
    if version != VERSION:
        raise Missing("it is of another version", remedy)
    return f"whole, {count} run{'s' * (count != 1)}"


def port_free(runs: Path, port: int) -> str:
    """Whether the pages can be served, or already are."""
    from workbench.run_files import is_locked

    lock = runs / ".serve.lock"
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("127.0.0.1", port))
        except (OSError, OverflowError) as error:
            if is_locked(lock) and f":{port}/" in (where := lock.read_text(errors="replace").strip()):
                return f"served at {where}"
            reason = getattr(error, "strerror", None) or error
            raise Missing(f"{port}: {reason}", "workbench serve --port 0 takes any free one") from error
    return f"{port} is free"
