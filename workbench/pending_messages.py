"""Nothing that a page is told stays behind in the server: a mend of a race in Panel 1.9.

What changes while other messages are being written waits in `_WRITE_MSGS`, and a task is to write it. If the writing
before ends in the same turn of the event loop, it takes back the mark that something waits, and the task, which comes
after, finds no mark and goes. The change then stays behind until the next one: about one opening in two hundred kept
its "Reading …" for ever.
"""

from __future__ import annotations

from bokeh.document import Document
from panel.io import document as panels

_write = panels._dispatch_msgs


async def write_all(doc: Document) -> None:
    """Write what waits for a document's pages; what came meanwhile and lost its mark gets it back, and a task."""
    await _write(doc)
    if doc in panels._WRITE_MSGS and doc not in panels._WRITE_BLOCK:
        panels._WRITE_BLOCK[doc] = True
        panels._dispatch_write_task(doc, write_all, doc)


def leave_no_message_behind() -> None:
    """Once per process, before pages are served."""
    panels._dispatch_msgs = write_all
