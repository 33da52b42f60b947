"""A page that was left is let go: its document, with everything that hangs on it."""

from __future__ import annotations

import ctypes
import gc
import weakref
from pathlib import Path
from types import SimpleNamespace
from typing import cast

import psutil
import pytest
from bokeh.application.application import SessionContext
from bokeh.document import Document
from bokeh.server.contexts import BokehSessionContext
from panel.io.state import set_curdoc, state
from panel_material_ui import Page
from panel_material_ui.notifications import NotificationArea

from workbench.app import framed
from workbench.context import AppContext
from workbench.session_end import ask_no_longer_whether_busy, forget_views, give_memory_back


def _end(document: Document, *, mended: bool) -> weakref.ref[Document]:
    """What Panel does when a session ends, and what is left of its document."""
    context = SimpleNamespace(_document=document, id="gone")
    with set_curdoc(document):
        area = NotificationArea()
        area.get_root(document)  # as Panel shows it: its document is in the table of views, not in the area's own
        area._server_destroy(cast("BokehSessionContext", context))
    if mended:
        forget_views(cast("SessionContext", context))
    return weakref.ref(document)


def test_the_document_of_a_session_that_ended_is_let_go() -> None:
    left = _end(Document(), mended=True)
    gc.collect()
    assert left() is None


def test_without_the_mend_panel_keeps_it() -> None:
    """Once this fails, Panel has mended it, and `session_end.py` can go."""
    left = _end(Document(), mended=False)
    gc.collect()
    held = left()
    assert held is not None
    forget_views(cast("SessionContext", SimpleNamespace(_document=held)))


def test_views_of_others_stay() -> None:
    mine, other = Document(), Document()
    state._views["other"] = (None, None, other, None)  # pyright: ignore[reportArgumentType]
    state._views["mine"] = (None, None, mine, None)  # pyright: ignore[reportArgumentType]
    forget_views(cast("SessionContext", SimpleNamespace(_document=mine)))
    assert state._views.pop("other")[2] is other
    assert "mine" not in state._views


def test_a_frame_is_let_go() -> None:
    """Its negative control is the second line: there is something to take back."""
    page = Page(main=[])
    assert any(watcher.inst is state for _, watcher in page._param__private.ref_watchers)
    ask_no_longer_whether_busy(page)
    left = weakref.ref(page)
    del page
    gc.collect()
    assert left() is None


@pytest.mark.skipif(not hasattr(ctypes.CDLL(None), "malloc_trim"), reason="another C library than glibc")
def test_freed_memory_goes_back_to_the_system() -> None:
    process, session = psutil.Process(), cast("SessionContext", None)
    pieces = [bytearray(1000) for _ in range(200_000)]
    kept = pieces[::50]  # scattered: the C library by itself gives nothing back below the last of them
    del pieces
    held = process.memory_info().rss
    give_memory_back(session)
    assert process.memory_info().rss < held - 100e6
    assert len(kept) == 4000


def test_pages_are_framed_with_all(tmp_path: Path) -> None:
    document = Document()
    with set_curdoc(document):
        page = framed(AppContext.of(tmp_path), "runs")
    assert {forget_views, give_memory_back} <= document.session_destroyed_callbacks
    assert not [watcher for _, watcher in page._param__private.ref_watchers if watcher.inst is state]
