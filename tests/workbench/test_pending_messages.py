"""A change that comes while another one is being written reaches the page."""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Coroutine
from types import SimpleNamespace
from typing import Any

import pytest
from bokeh.document import Document
from panel.io import document as panels

from workbench import pending_messages

Writer = Callable[[Document], Coroutine[Any, Any, None]]


class _Connection:
    """As little of a page's connection as is asked."""

    _socket = None
    protocol = SimpleNamespace(create=lambda kind, events: " ".join(events))


def _written(writer: Writer, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What reaches a page that is told "first", and "second" in the turn of the loop in which "first" is written."""
    reached: list[str] = []
    connection: Any = _Connection()
    monkeypatch.setattr(panels, "_dispatch_msgs", writer)

    async def tell() -> None:
        written = asyncio.get_running_loop().create_future()

        def write(_connection: Any, events: Any = None, msg: Any = None) -> list[asyncio.Future[None]]:
            reached.append(msg)
            return [written]

        monkeypatch.setattr(panels, "dispatch_django", write)
        doc = Document()
        panels.schedule_write_events(doc, [connection], ["first"])  # type: ignore[list-item]
        await asyncio.sleep(0)  # it is being written
        written.set_result(None)
        panels.schedule_write_events(doc, [connection], ["second"])  # type: ignore[list-item]
        for _ in range(10):
            await asyncio.sleep(0)
        assert doc not in panels._WRITE_BLOCK or doc in panels._WRITE_MSGS

    asyncio.run(tell())
    return reached


def test_a_change_in_the_moment_of_writing_is_written_too(monkeypatch: pytest.MonkeyPatch) -> None:
    assert _written(pending_messages.write_all, monkeypatch) == ["first", "second"]


def test_without_the_mend_it_stays_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    """When this fails, Panel writes it by itself, and the mend can go."""
    assert _written(pending_messages._write, monkeypatch) == ["first"]


def test_pages_are_served_with_the_mend(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(panels, "_dispatch_msgs", pending_messages._write)
    pending_messages.leave_no_message_behind()
    assert panels._dispatch_msgs is pending_messages.write_all
