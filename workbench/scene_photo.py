"""A picture of what a browser shows of a viser scene, larger than it shows it."""

from __future__ import annotations

import io
import time
from collections.abc import Callable
from typing import TYPE_CHECKING

from PIL import Image

from layouts.theme import Rgb
from sim.errors import SubMasError

if TYPE_CHECKING:
    import viser

WIDTH = 1920
"""Pixels of a picture; its height is that of the view."""
PATIENCE_S = 150.0
"""A browser without a graphics card needs some seconds for a picture, and a busy machine many times as long."""
PAUSE_S = 0.2


class PhotoError(SubMasError):
    """No browser sent a picture."""


def photograph(
    server: viser.ViserServer,
    background: Rgb,
    wanted: Callable[[], bool] = lambda: True,
    patience_s: float = PATIENCE_S,
) -> bytes:
    """What the browser of a scene shows, as a PNG; waits for the browser, so not on the loop.

    A browser that has lost its connection comes back by itself, as a new client: then that one is asked.

    Args:
        server: of the scene.
        background: what shines through where nothing is drawn.
        wanted: asked again and again; once it says no, nobody waits any longer.
        patience_s: longest time to wait.

    Raises:
        PhotoError: within `patience_s` no browser was there, none sent a picture, or it is not wanted any more.
    """
    deadline = time.monotonic() + patience_s
    while (left_s := deadline - time.monotonic()) > 0.0 and wanted():
        clients = server.get_clients()
        if clients:
            try:
                return _render(clients[max(clients)], background, left_s)
            except (RuntimeError, TimeoutError):  # it went away, or could not draw
                pass
        time.sleep(PAUSE_S)
    raise PhotoError(f"the 3-D view sent no picture within {patience_s:.0f} s; reload the page and try again")


def _render(client: viser.ClientHandle, background: Rgb, patience_s: float) -> bytes:
    height = round(WIDTH / max(client.camera.aspect, 0.5))
    drawn = Image.fromarray(client.get_render(height, WIDTH, transport_format="png", timeout=patience_s))
    image = Image.new("RGBA", drawn.size, background)
    image.alpha_composite(drawn)
    packed = io.BytesIO()
    image.convert("RGB").save(packed, "PNG")
    return packed.getvalue()
