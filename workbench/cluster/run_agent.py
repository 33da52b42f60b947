"""A node's side of a run: starts the training as a process of its own, brings it what it needs and its files home.

`train` is the Ray task. It works in the run folder itself where storage is shared, else in a folder of the node that
`run_mirror` streams to the head. If the task dies, the training loses its standard input and dies with it.
"""

from __future__ import annotations

import contextlib
import hashlib
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, Final

from workbench.cluster.receiver import GivenUpError
from workbench.cluster.run_mirror import Head, RunMirror
from workbench.cluster.scratch import scratch
from workbench.launcher import environment

LOOK_S: Final = 0.5
"""Time between two looks at the run folder and at what the head wishes."""
END_PATIENCE_S: Final = 10.0
"""How long a training may take to end at once before it is killed."""
SCRATCH: Final = "workbench-run-"


@dataclass(frozen=True)
class Order:
    """What a node is to do; plain values only."""

    run: str
    attempt: int
    folder: str
    """The run folder as the head sees it."""
    folders: str
    """shared, streamed or auto."""
    proof: str
    """A file beside the run folder that only shared storage shows here, empty if none was made."""
    entry: tuple[str, ...]
    """What Python runs as a training process."""
    versions: Mapping[str, str]
    """What must be the same here for the same numbers."""
    guide: Mapping[str, bytes]
    """Files to put beside the configuration, where the guide is not one that is shipped."""


@dataclass(frozen=True)
class Outcome:
    """How an attempt ended on its node."""

    exit_code: int | None = None
    """Of the training process; None if it was not started."""
    node: str = ""
    unwanted: bool = False
    """Somebody stopped the run while it waited."""
    refused: str = ""
    """Why this node cannot train it; another could not either."""


class RemoteHead:
    """The receiver's actor, asked for one attempt at one run."""

    def __init__(self, actor: Any, order: Order) -> None:
        self._actor, self._order = actor, order
        # While a task's main thread waits for an answer, Ray gives its core to another task; the training needs it.
        self._beside = ThreadPoolExecutor(max_workers=1)

    def call(self, method: str, *values: Any) -> Any:
        """See `run_mirror.Head`; waits for the answer."""
        return self._beside.submit(self._ask, method, values).result()

    def _ask(self, method: str, values: tuple[Any, ...]) -> Any:
        import ray

        return ray.get(getattr(self._actor, method).remote(self._order.run, self._order.attempt, *values))


def train(actor: Any, order: Order) -> Outcome:
    """The Ray task: one attempt at one run, from its last checkpoint on.

    Raises:
        GivenUpError: the engine counts on another attempt by now.
    """
    return attempt(RemoteHead(actor, order), order, node_words())


def attempt(head: Head, order: Order, node: str) -> Outcome:
    """The same with any head."""
    here = versions_here()
    other = [f"{name} {here.get(name)} instead of {there}" for name, there in order.versions.items()
             if here.get(name) != there]  # fmt: skip
    if other:
        return Outcome(node=node, refused=f"{node} would train something else: it has {', '.join(other)}")
    shared = _is_shared(order)
    if order.folders == "shared" and not shared:
        return Outcome(node=node, refused=f"{node} does not see {order.folder}; use --run-folders streamed")
    if not head.call("begin", node):
        return Outcome(node=node, unwanted=True)
    if shared and order.folders != "streamed":
        return Outcome(_work(head, Path(order.folder), order, None), node)
    with scratch(SCRATCH) as place:
        folder = place / order.run
        folder.mkdir()
        mirror = RunMirror(folder, head)
        mirror.fetch()
        for name, data in order.guide.items():
            (folder / name).write_bytes(data)
        return Outcome(_work(head, folder, order, mirror), node)


def _work(head: Head, folder: Path, order: Order, mirror: RunMirror | None) -> int:
    """Train; the exit code."""
    process = _spawn(folder, order.entry)
    try:
        ending_s = float("inf")
        while process.poll() is None:
            if mirror is not None:
                mirror.send()
            if _obey(head.call("wishes"), folder, mirror is not None) and ending_s == float("inf"):
                process.send_signal(signal.SIGTERM)
                ending_s = time.monotonic() + END_PATIENCE_S
            if time.monotonic() > ending_s:
                process.kill()
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(LOOK_S)
        if mirror is not None:
            mirror.send(last=True)
        return process.returncode
    finally:
        process.kill()
        process.wait()
        if process.stdin:
            process.stdin.close()


def _spawn(folder: Path, entry: tuple[str, ...]) -> subprocess.Popen[bytes]:
    with (folder / "log.txt").open("ab") as log:
        return subprocess.Popen(
            [sys.executable, *entry, str(folder), "--held"], stdin=subprocess.PIPE, stdout=log,
            stderr=subprocess.STDOUT, env=environment(), start_new_session=True,
        )  # fmt: skip


def _obey(wishes: tuple[bool, bool, bool], folder: Path, streamed: bool) -> bool:
    """Bring the head's wishes into a folder that is only here; whether the run is to end at once."""
    for name, wished in zip(("stop", "pause"), wishes, strict=False):
        if streamed and wished:
            (folder / name).touch()
    return wishes[2]


def _is_shared(order: Order) -> bool:
    return bool(order.proof) and Path(order.folder).is_dir() and Path(order.folder).with_name(order.proof).is_file()


def node_words() -> str:
    """This node in a few words: its host's name, and which of several nodes of that host."""
    import ray

    return f"{socket.gethostname()} ({ray.get_runtime_context().get_node_id()[:6]})"


@cache
def versions_here() -> dict[str, str]:
    """What a training's numbers depend on: the source of simulator and learner, and the libraries."""
    import agents
    import sim
    from workbench.recorder import versions

    content = hashlib.sha256()
    for package in (sim, agents):
        root = Path(str(package.__file__)).parent
        for path in sorted(root.rglob("*.py")):
            content.update(f"{path.relative_to(root)}\0".encode() + path.read_bytes() + b"\0")
    return {"source": content.hexdigest()[:12], **versions()}


__all__ = ["GivenUpError", "Order", "Outcome", "attempt", "train"]
