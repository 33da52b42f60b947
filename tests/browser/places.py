"""Where things stand on a page."""

from __future__ import annotations

import time

from playwright.sync_api import FloatRect, Locator

PATIENCE_S = 60.0
STILL_MS = 100


def box_of(part: Locator) -> FloatRect:
    """Where a part stands [px] once it stands still: parts are drawn anew, and pushed about, by what comes later.

    Raises AssertionError if it does not come to rest within a minute.
    """
    deadline = time.monotonic() + PATIENCE_S
    before = None
    while time.monotonic() < deadline:
        box = part.bounding_box()
        if box is not None and box == before:
            return box
        before = box
        part.page.wait_for_timeout(STILL_MS)
    raise AssertionError(f"{part} has not come to rest: {before}")
