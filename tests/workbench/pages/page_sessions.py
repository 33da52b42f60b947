"""Pages without a browser: actions in an event loop, as a session has one, and the Live page of an address."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from typing import Any

from workbench.context import AppContext
from workbench.pages.live import LivePage
from workbench.pages.live_settings import read_settings


def do(*actions: Callable[[], object] | Coroutine[Any, Any, object]) -> None:
    """Do these one after the other, each with all it sets off, in a loop as a session has one."""

    async def each() -> None:
        for action in actions:
            if isinstance(action, Coroutine):
                await action
            else:
                action()
            while others := [task for task in asyncio.all_tasks() if task is not asyncio.current_task()]:
                await asyncio.wait(others, timeout=5.0)

    asyncio.run(each())


def opened_live(app: AppContext, **query: str) -> LivePage:
    """The Live page of this address, brought up to date."""
    page = LivePage(app)
    page.settings, page._standing = read_settings(query), True
    do(page.refresh())
    return page
