"""The queue of comparisons: work of all pages, flown by a few processes, so that no page ever waits for a flight."""

from __future__ import annotations

import asyncio
import contextlib
import json
import subprocess
import sys
from collections.abc import Hashable, Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from workbench.comparison.cache import ComparisonCache
from workbench.comparison.work import Work
from workbench.launcher import cpu_count, environment

ENTRY = ("-m", "workbench.comparison.worker")
"""What Python runs as a worker."""
IDLE_S = 20.0
"""A worker stays so long when nothing is left to do: what is asked for next begins at once."""
ERRORS_KEPT = 200
CHANGED = "the workbench's own code has changed since it was started; start it again"
"""Why a result has another name than the one that was asked for."""


@dataclass
class Standing:
    """How a piece of work stands while it has no result."""

    state: Literal["waiting", "flying", "failed"]
    share: float = 0.0
    """What is done of it, 0 to 1."""
    error: str = ""


@dataclass(frozen=True)
class Worker:
    """A process of `workbench.comparison.worker`.

    Not one of asyncio's: a server that ends while such a process comes up would wait for it for ever.
    """

    process: subprocess.Popen[bytes]
    said: asyncio.StreamReader
    pipe: asyncio.ReadTransport

    @classmethod
    async def start(cls, runs: Path, folder: Path) -> Worker:
        """A new process for this runs folder, whose results go into this folder."""
        process = subprocess.Popen(
            [sys.executable, *ENTRY, str(runs), str(folder)], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
            env=environment(), start_new_session=True,
        )  # fmt: skip
        said = asyncio.StreamReader()
        try:
            pipe, _ = await asyncio.get_running_loop().connect_read_pipe(
                lambda: asyncio.StreamReaderProtocol(said), process.stdout
            )
        except BaseException:
            process.kill()
            process.communicate()
            raise
        return cls(process, said, pipe)

    def ask(self, work: Work) -> None:
        """Give it a piece of work; one that has ended does not answer."""
        asked = self.process.stdin
        assert asked is not None
        with contextlib.suppress(BrokenPipeError):
            asked.write((json.dumps(work.to_json()) + "\n").encode())
            asked.flush()

    async def answer(self) -> dict[str, Any] | None:
        """What it says next; None when it has ended."""
        line = await self.said.readline()
        return json.loads(line) if line.endswith(b"\n") else None

    def end(self) -> None:
        """End it."""
        self.process.kill()
        with contextlib.suppress(BrokenPipeError):
            if self.process.stdin is not None:
                self.process.stdin.close()
        self.pipe.close()
        self.process.wait()


class ComparisonQueue:
    """Belongs to one server, and to its event loop: pages ask for work and look how it stands."""

    def __init__(self, runs: Path, cache: ComparisonCache | None = None, workers: int | None = None) -> None:
        self.cache = cache or ComparisonCache()
        self._runs, self._limit = runs, workers or cpu_count()
        self._standing: dict[Work, Standing] = {}
        self._askers: dict[Work, set[Hashable]] = {}
        self._waiting: list[Work] = []
        self._flying: dict[Work, Worker] = {}
        self._workers: set[asyncio.Task[None]] = set()
        self._news = asyncio.Event()

    def want(self, works: Iterable[Work], *, soon: bool = False, asker: Hashable = None) -> None:
        """Queue what has no result and is not on its way; `soon` in front of everything that waits.

        Args:
            works: what `asker` waits for from now on, whoever else does.
            soon: whether it is flown first.
            asker: a page.
        """
        wanted = list(dict.fromkeys(works))
        new = [work for work in wanted if self.state(work) in ("", "failed") and not self.cache.has(work)]
        for work in new:
            self._standing[work] = Standing("waiting")
        for work in wanted:
            if work in self._standing:
                self._askers.setdefault(work, set()).add(asker)
        self._waiting[:] = [*new, *self._waiting] if soon else [*self._waiting, *new]
        self._news.set()
        for _ in range(min(len(self._waiting), self._limit - len(self._workers))):
            task = asyncio.get_running_loop().create_task(self._work())
            self._workers.add(task)
            task.add_done_callback(self._workers.discard)

    def leave(self, asker: Hashable) -> None:
        """A page was closed: its work goes on, but no longer keeps others from dropping it."""
        for askers in self._askers.values():
            askers.discard(asker)

    def drop(self, works: Iterable[Work], asker: Hashable = None) -> None:
        """`asker` waits for this work no longer; what nobody else waits for is forgotten, and what flies it ended."""
        for work in works:
            self._askers.get(work, set()).discard(asker)
            if not self._askers.get(work):
                self._forget(work)

    def _forget(self, work: Work) -> None:
        self._askers.pop(work, None)
        if self._standing.pop(work, None) is not None:
            if work in self._waiting:
                self._waiting.remove(work)
            if (worker := self._flying.get(work)) is not None:
                worker.process.kill()

    def standing(self, work: Work) -> Standing | None:
        """How it stands; None when it has its result or was never asked for."""
        return self._standing.get(work)

    def state(self, work: Work) -> str:
        """`waiting`, `flying`, `failed`, or empty."""
        standing = self._standing.get(work)
        return standing.state if standing else ""

    async def close(self) -> None:
        """End all workers."""
        for work in list(self._standing):
            self._forget(work)
        for task in list(self._workers):
            task.cancel()
        await asyncio.gather(*self._workers, return_exceptions=True)

    async def _work(self) -> None:
        """One worker: a process, restarted when it was ended, until nothing has been left to do for a while."""
        worker: Worker | None = None
        try:
            while (work := await self._next()) is not None:
                if worker is None or worker.process.poll() is not None:
                    worker = await Worker.start(self._runs, self.cache.folder)
                if self._standing.get(work) is not None:  # else it was dropped while the process came up
                    await self._fly(work, worker)
        finally:
            if worker is not None:
                worker.end()

    async def _next(self) -> Work | None:
        while not self._waiting:
            self._news.clear()
            try:
                async with asyncio.timeout(IDLE_S):
                    await self._news.wait()
            except TimeoutError:
                return None
        return self._waiting.pop(0)

    async def _fly(self, work: Work, worker: Worker) -> None:
        standing = self._standing[work]
        standing.state, self._flying[work] = "flying", worker
        error = "the process that flew it ended"
        try:
            worker.ask(work)
            while said := await worker.answer():
                if "share" not in said:
                    error = said.get("error", "")
                    break
                standing.share = said["share"]
            else:
                worker.end()
        finally:
            del self._flying[work]
        # Dropped work is forgotten, and asked for again it stands anew: what ended was not that.
        if self._standing.get(work) is standing:
            missing = not error and not self.cache.has(work)
            self._finish(work, CHANGED if missing else error)

    def _finish(self, work: Work, error: str) -> None:
        self._askers.pop(work, None)
        if not error:
            del self._standing[work]
            return
        self._standing[work] = Standing("failed", error=error)
        failed = [one for one, standing in self._standing.items() if standing.state == "failed"]
        for one in failed[:-ERRORS_KEPT]:
            del self._standing[one]
