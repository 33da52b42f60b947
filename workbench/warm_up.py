"""What the server loads in its own time: first what the first page needs, the rest once the person looks at it."""

from __future__ import annotations

import contextvars
import importlib
import logging
import time
from collections.abc import Iterable

from workbench.context import AppContext

FIRST = ("workbench.pages.fly",)
LATER = (
    "workbench.pages.compare",
    "workbench.pages.curriculum",
    "workbench.pages.live",
    "workbench.pages.runs",
    "workbench.pages.paper",
    "rerun",
)
LATER_S = 10.0
"""The first page is there by then: two threads of one interpreter would only keep each other waiting."""

log = logging.getLogger(__name__)


def warm_up(context: AppContext, later_s: float = LATER_S) -> None:
    """Load what the first flight needs; after `later_s` [s] the other pages, the index of runs and the Rerun viewer.

    Whatever fails is only logged: the page that needs it will say so to the person.
    """
    contextvars.copy_context().run(_warm_up, context, later_s)


def _warm_up(context: AppContext, later_s: float) -> None:
    import panel as pn
    from bokeh.document import Document

    from workbench.viewer_files import ensure_viewer

    # Else this thread would see the document of whichever page the server is busy with, and Panel would take components
    # that are loaded meanwhile for that page's own: the next page with one of them would stay empty.
    pn.state.curdoc = Document()
    try:
        _load(FIRST)
        _fly_a_step()
        time.sleep(later_s)
        _load(LATER)
        context.index.look()
        ensure_viewer()
    except Exception as error:
        log.warning("warm-up: %s", error)


def _load(names: Iterable[str]) -> None:
    for name in names:
        importlib.import_module(name)


def _fly_a_step() -> None:
    """Warp's library and the kernels, which whoever flies first would wait for."""
    from sim.task import Task
    from sim.world import World
    from workbench.scenarios import load_scenario

    world = World(Task(load_scenario()), 1)
    world.reset()
    world.step([0.0])
