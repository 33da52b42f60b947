"""The queue of comparisons: work of all pages, flown by a few processes, so that no page ever waits for a flight."""

from __future__ import annotations

import asyncio
import contextlib
import json
import sys
from asyncio.subprocess import PIPE, Process
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from workbench.comparison import Work
from workbench.comparison_cache import ComparisonCache
from workbench.launcher import cpu_count, environment

ENTRY = ("-m", "workbench.comparison_worker")
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


class ComparisonQueue:
    """Belongs to one server, and to its event loop: pages ask for work and look how it stands."""

    def __init__(self, runs: Path, cache: ComparisonCache | None = None, workers: int | None = None) -> None:
        self.cache = cache or ComparisonCache()
        self._runs, self._limit = runs, workers or cpu_count()
        self._standing: dict[Work, Standing] = {}
        self._waiting: list[Work] = []
        self._flying: dict[Work, Process] = {}
        self._workers: set[asyncio.Task[None]] = set()
        self._news = asyncio.Event()

    def want(self, works: Iterable[Work], *, soon: bool = False) -> None:
        """Queue what has no result and is not on its way; `soon` in front of everything that waits."""
        new = [w for w in dict.fromkeys(works) if self.state(w) in ("", "failed") and not self.cache.has(w)]
        for work in new:
            self._standing[work] = Standing("waiting")
        self._waiting[:] = [*new, *self._waiting] if soon else [*self._waiting, *new]
        self._news.set()
        for _ in range(min(len(self._waiting), self._limit - len(self._workers))):
            task = asyncio.get_running_loop().create_task(self._work())
            self._workers.add(task)
            task.add_done_callback(self._workers.discard)

    def drop(self, works: Iterable[Work]) -> None:
        """Forget work that waits, and end what flies it."""
        for work in works:
            if self._standing.pop(work, None) is None:
                continue
            if work in self._waiting:
                self._waiting.remove(work)
            if (process := self._flying.get(work)) is not None:
                _kill(process)

    def standing(self, work: Work) -> Standing | None:
        """How it stands; None when it has its result or was never asked for."""
        return self._standing.get(work)

    def state(self, work: Work) -> str:
        """`waiting`, `flying`, `failed`, or empty."""
        standing = self._standing.get(work)
        return standing.state if standing else ""

    async def close(self) -> None:
        """End all workers."""
        self.drop(list(self._standing))
        for task in list(self._workers):
            task.cancel()
        await asyncio.gather(*self._workers, return_exceptions=True)

    async def _work(self) -> None:
        """One worker: a process, restarted when it was ended, until nothing has been left to do for a while."""
        process: Process | None = None
        try:
            while (work := await self._next()) is not None:
                if process is None or process.returncode is not None:
                    process = await self._start()
                if self._standing.get(work) is None:  # dropped while the process came up
                    continue
                await self._fly(work, process)
        finally:
            if process is not None:
                await _end(process)

    async def _next(self) -> Work | None:
        while not self._waiting:
            self._news.clear()
            try:
                async with asyncio.timeout(IDLE_S):
                    await self._news.wait()
            except TimeoutError:
                return None
        return self._waiting.pop(0)

    async def _start(self) -> Process:
        command = [sys.executable, *ENTRY, str(self._runs), str(self.cache.folder)]
        starting = asyncio.ensure_future(
            asyncio.create_subprocess_exec(
                *command, stdin=PIPE, stdout=PIPE, stderr=None, env=environment(), start_new_session=True
            )
        )
        try:
            return await asyncio.shield(starting)
        except asyncio.CancelledError:
            await _end(await starting)  # or it would outlive the server
            raise

    async def _fly(self, work: Work, process: Process) -> None:
        assert process.stdin is not None and process.stdout is not None
        standing = self._standing[work]
        standing.state, self._flying[work] = "flying", process
        try:
            process.stdin.write((json.dumps(work.to_json()) + "\n").encode())
            error = "the process that flew it ended"
            while line := await process.stdout.readline():
                said = json.loads(line)
                if "share" not in said:
                    error = said.get("error", "")
                    break
                standing.share = said["share"]
            else:
                await process.wait()
        finally:
            del self._flying[work]
        # Dropped work is forgotten, and asked for again it stands anew: what ended was not that.
        if self._standing.get(work) is standing:
            missing = not error and not self.cache.has(work)
            self._finish(work, CHANGED if missing else error)

    def _finish(self, work: Work, error: str) -> None:
        if not error:
            del self._standing[work]
            return
        self._standing[work] = Standing("failed", error=error)
        failed = [one for one, standing in self._standing.items() if standing.state == "failed"]
        for one in failed[:-ERRORS_KEPT]:
            del self._standing[one]


def _kill(process: Process) -> None:
    with contextlib.suppress(ProcessLookupError):
        process.kill()


async def _end(process: Process) -> None:
    _kill(process)
    if process.stdin is not None:
        process.stdin.close()
    await process.wait()
