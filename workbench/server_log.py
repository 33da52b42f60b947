"""What the terminal of a server shows: words about what went wrong, and nothing of pages that were merely left."""

from __future__ import annotations

import asyncio
import logging
from typing import Any

HEARD = ("bokeh.server.protocol_handler", "panel.io.document", "tornado.application")
"""Loggers of what serves pages; a page that is closed while messages are on their way is an error to each of them."""


class LeftPage(logging.Filter):
    """Lets everything through but what a page that was left still said, or could no longer be told."""

    def filter(self, record: logging.LogRecord) -> bool:
        """Whether the record is shown."""
        problem = record.exc_info[1] if record.exc_info else None
        return not (asked_for_session_of_left_page(problem) or "connection was closed" in record.getMessage())


def asked_for_session_of_left_page(problem: BaseException | None) -> bool:
    """Whether it is the assertion of Bokeh's connection that it still has a session, which it lacks once closed."""
    from bokeh.server.connection import ServerConnection

    last = problem.__traceback__ if isinstance(problem, AssertionError) else None
    while last and last.tb_next:
        last = last.tb_next
    asked = ServerConnection.session.fget
    return bool(last and asked and last.tb_frame.f_code is asked.__code__)


def show_log() -> None:
    """One line for each problem, in the voice of the program."""
    logging.basicConfig(level=logging.WARNING, format="workbench: %(message)s")
    logging.getLogger("bokeh").setLevel(logging.ERROR)  # its warnings are about layout, for whoever writes a page
    for name in HEARD:
        logging.getLogger(name).addFilter(LeftPage())


def forgive_leaving(loop: asyncio.AbstractEventLoop, problem: dict[str, Any]) -> None:
    """For a loop's exceptions: a page that is closed while something is on its way to it is no error."""
    from tornado.iostream import StreamClosedError
    from tornado.websocket import WebSocketClosedError

    if not isinstance(problem.get("exception"), WebSocketClosedError | StreamClosedError):
        loop.default_exception_handler(problem)
