"""The bar that says so when a page has lost its server, and what to do; by itself it only brings pages back."""

from __future__ import annotations

from pathlib import Path

from panel.custom import JSComponent


class ConnectionBar(JSComponent):
    """Nothing to see while the connection stands.

    Bokeh tries again for half a minute and then gives up in silence; a session that was gone for long would come back
    as it was when the page was opened. So the bar asks the server itself: one that answers gets the page anew, by its
    address, in which everything about a view is; one that was started again, or does not answer, is a sentence.
    Nothing that was pressed meanwhile is kept or sent later.
    """

    _esm = Path(__file__).with_suffix(".js")


def connection_bar() -> ConnectionBar:
    """For the frame of every page."""
    return ConnectionBar(width=0, height=0, margin=0)
