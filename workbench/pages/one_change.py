"""Many changes of a page as one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import panel as pn


@contextmanager
def one_change() -> Iterator[None]:
    """What is changed within is gathered once, at its end.

    Bokeh walks through every model of a page after each change that may bring models or drop some; a page that shows
    something else makes dozens of such, and a walk through a few hundred models takes ten milliseconds.
    """
    document = pn.state.curdoc
    if document is None:
        yield
        return
    problem = None
    with document.models.freeze():  # which would stay frozen after an error
        try:
            yield
        except BaseException as error:
            problem = error
    if problem is not None:
        raise problem
