"""How the Runs page follows the run folders: once a second, away from the event loop, without a sign of being busy."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Awaitable, Callable

from workbench.run_index.index import RunIndex

TICK_S = 1.0
PROGRESS_S = 0.5

log = logging.getLogger(__name__)


class Follower:
    """Awaits `tick` again and again until it is stopped.

    Not a periodic callback of Panel's: each of its turns walks the whole page twice to say that it is busy.
    """

    def __init__(self, tick: Callable[[], Awaitable[None]]) -> None:
        self._tick = tick
        self._task: asyncio.Task[None] | None = None

    def start(self) -> None:
        """Begin; needs a running event loop."""
        self._task = asyncio.create_task(self._follow())

    def stop(self) -> None:
        """The page was left."""
        if self._task is not None:
            self._task.cancel()

    async def _follow(self) -> None:
        while True:
            await asyncio.sleep(TICK_S)
            try:
                await self._tick()
            except Exception:  # the next look may succeed; a page that stopped following would say nothing
                log.exception("the list of runs could not be brought up to date")


async def look(index: RunIndex, progress: Callable[[], Awaitable[None]]) -> bool:
    """Bring the index up to date; whether anything changed. `progress` is awaited while many folders are read."""
    looking = asyncio.ensure_future(asyncio.to_thread(index.look))
    while not (await asyncio.wait([looking], timeout=PROGRESS_S))[0]:
        if index.reading is not None:
            await progress()
    return looking.result()
