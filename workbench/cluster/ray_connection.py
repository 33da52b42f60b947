"""A Ray of one's own on this machine's loopback, or the way to a cluster that is there already."""

from __future__ import annotations

import contextlib
import importlib.util
import os
import re
import secrets
import socket
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

from sim.errors import SubMasError, UsageError
from workbench.cluster.scratch import scratch
from workbench.engine_options import EngineOptions
from workbench.launcher import cpu_count

LOOPBACK: Final = "127.0.0.1"
OBJECT_STORE_BYTES: Final = 128 * 2**20
"""Shared memory of a Ray of one's own: files travel through it in pieces of a few megabytes."""
ANSWER_S: Final = 5.0
ADDRESS: Final = re.compile(r"auto|(?P<host>[A-Za-z0-9._-]+|\[[0-9A-Fa-f:]+\]):(?P<port>[0-9]{1,5})")
QUIET: Final = {
    "RAY_USAGE_STATS_ENABLED": "0",  # nothing is told to anybody
    "RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO": "0",
}
AS_EQUALS: Final = {"RAY_worker_niceness": "0"}
"""Ray's workers would give way to everything else on the machine; a run of the local engine does not."""
ON_LOOPBACK: Final = {"RAY_ENABLE_WINDOWS_OR_OSX_CLUSTER": "0"}
"""Ray replaces a loopback address by that of a network card and then listens on every one, except where clusters are
switched off, which is what this says. `_started` looks whether it has helped."""
SOCKET_PATH_LIMIT: Final = 40
"""Longest folder for temporary files [characters]: Ray's sockets lie below it, and their paths are short by law."""


class ClusterError(SubMasError):
    """Ray cannot be started or reached; the message says why."""


@contextlib.contextmanager
def connected(options: EngineOptions) -> Iterator[None]:
    """Ray, for as long as the context lasts.

    Raises:
        UsageError: Ray is not installed, or the address is none.
        ClusterError: it cannot be started, or nobody answers at the address.
    """
    _check(options.ray_address)
    os.environ.update(QUIET)
    with _reached(options.ray_address) if options.ray_address else _started():
        yield


def _check(address: str) -> None:
    if importlib.util.find_spec("ray") is None:
        raise UsageError("--engine ray needs Ray; install it with: pip install 'submas-workbench[cluster]'")
    if address.startswith("ray://"):
        raise UsageError(
            f"--ray-address is '{address[:60]}': Ray's client is not used; give HOST:PORT, as in head:6379, and run "
            "this command on a node of the cluster"
        )
    if address and not ADDRESS.fullmatch(address):
        raise UsageError(f"--ray-address is '{address[:60]}'; legal are auto and HOST:PORT, as in head:6379")


@contextlib.contextmanager
def _started() -> Iterator[None]:
    """A Ray of this command alone: on loopback, without dashboard, with a token that nobody else knows."""
    os.environ.update(ON_LOOPBACK | AS_EQUALS)
    if os.environ.setdefault("RAY_AUTH_MODE", "token") == "token" and "RAY_AUTH_TOKEN_PATH" not in os.environ:
        os.environ.setdefault("RAY_AUTH_TOKEN", secrets.token_hex(32))
    base = tempfile.gettempdir()
    with (
        scratch("ray-", Path(base if len(base) <= SOCKET_PATH_LIMIT else "/tmp")) as folder,
        _initialised(
            address="local", num_cpus=cpu_count(), include_dashboard=False, object_store_memory=OBJECT_STORE_BYTES,
            _node_ip_address=LOOPBACK, _temp_dir=str(folder),
        ),
    ):  # fmt: skip
        import ray

        bound = ray.util.get_node_ip_address()
        if bound != LOOPBACK:
            raise ClusterError(f"Ray would listen on {bound} instead of {LOOPBACK}; this version cannot be used")
        yield


@contextlib.contextmanager
def _reached(address: str) -> Iterator[None]:
    found = ADDRESS.fullmatch(address)
    if found and found["host"]:
        # Ray itself would try for a minute.
        try:
            socket.create_connection((found["host"].strip("[]"), int(found["port"])), ANSWER_S).close()
        except (OSError, OverflowError) as error:
            raise ClusterError(f"nobody answers at {address}: {error}; start Ray there, see docs/cluster.md") from error
    with _initialised(address=address):
        yield


@contextlib.contextmanager
def _initialised(**how: Any) -> Iterator[None]:
    import ray
    from ray._private import worker

    # Ray's notes on dead nodes go to standard output, where `--json` promises one object; the engine says it in a line.
    worker.print_to_stdstream = lambda *_, **__: None
    try:
        ray.init(log_to_driver=False, configure_logging=False, namespace="submas-workbench", **how)
    except (RuntimeError, ValueError, ConnectionError, OSError, TimeoutError) as error:
        said = next(iter(str(error).strip().splitlines()), type(error).__name__)
        raise ClusterError(f"Ray does not start or answer: {said}") from error
    try:
        yield
    finally:
        ray.shutdown()
