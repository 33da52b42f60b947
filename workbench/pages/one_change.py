"""Many changes of a page as one."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager

import panel as pn
from panel.io import hold


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
    # Held back, or a model would be told of as it was when it came, and what is changed of it afterwards would be lost.
    with document.models.freeze(), hold(document):  # frozen it would stay after an error
        try:
            yield
        except BaseException as error:
            problem = error
    if problem is not None:
        raise problem
