"""What the terminal shows of problems while pages are served."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Iterator
from types import SimpleNamespace
from typing import Any, cast

import pytest
from bokeh.document import Document
from bokeh.document.events import TitleChangedEvent
from bokeh.protocol import Protocol
from bokeh.server.connection import ServerConnection
from bokeh.server.protocol_handler import ProtocolHandler
from bokeh.server.session import ServerSession

from workbench.server_log import HEARD, LeftPage


@pytest.fixture
def filtered() -> Iterator[None]:
    one = LeftPage()
    for name in HEARD:
        logging.getLogger(name).addFilter(one)
    yield
    for name in HEARD:
        logging.getLogger(name).removeFilter(one)


def _connection() -> ServerConnection:
    session: Any = SimpleNamespace(subscribe=lambda it: None, unsubscribe=lambda it: None)
    nothing: Any = None
    return ServerConnection(Protocol(), nothing, nothing, cast(ServerSession, session))


def _say(connection: ServerConnection) -> None:
    """A page tells of a change."""
    message = Protocol().create("PATCH-DOC", [TitleChangedEvent(Document(), "another")])
    asyncio.run(ProtocolHandler().handle(message, connection))


def test_what_a_page_says_after_it_was_left_is_no_error(filtered: None, caplog: pytest.LogCaptureFixture) -> None:
    connection = _connection()
    connection.detach_session()
    _say(connection)
    assert caplog.records == []


def test_an_error_of_a_page_that_stands_is_shown(filtered: None, caplog: pytest.LogCaptureFixture) -> None:
    connection = _connection()

    def fail(*_: object) -> None:
        raise AssertionError("of our own")

    cast(Any, connection.session)._handle_patch = fail
    _say(connection)
    (record,) = caplog.records
    assert record.exc_info
    assert "of our own" in str(record.exc_info[1])


def test_what_cannot_be_told_a_page_that_was_left_is_no_warning(
    filtered: None, caplog: pytest.LogCaptureFixture
) -> None:
    logger = logging.getLogger("panel.io.document")
    logger.warning("Failed sending message as connection was closed")
    logger.warning("Failed sending message due to following error: no memory")
    assert [record.getMessage() for record in caplog.records] == [
        "Failed sending message due to following error: no memory"
    ]
