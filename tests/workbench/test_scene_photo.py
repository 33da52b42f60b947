"""The picture of a scene: from the newest browser there is, waited for, and given up in one sentence."""

from __future__ import annotations

import io
import threading
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from PIL import Image

from workbench.scene_photo import WIDTH, PhotoError, photograph


class Browser:
    """A client that shows one colour, after some failures."""

    def __init__(self, shade: int, failures: tuple[Exception, ...] = ()) -> None:
        self.camera, self.shade, self.failures = SimpleNamespace(aspect=2.0), shade, list(failures)

    def get_render(self, height: int, width: int, **_how: Any) -> np.ndarray:
        if self.failures:
            raise self.failures.pop(0)
        picture = np.full((height, width, 4), self.shade, np.uint8)
        picture[..., 3] = 255
        picture[-1, :, 3] = 0  # nothing is drawn there
        return picture


def scene(*browsers: Browser) -> Any:
    return SimpleNamespace(get_clients=lambda: dict(enumerate(browsers)))


GROUND = (30, 60, 90)


def shade(png: bytes) -> tuple[tuple[int, int], int]:
    with Image.open(io.BytesIO(png)) as picture:
        return picture.size, picture.convert("L").getpixel((5, 5))  # pyright: ignore[reportReturnType]


def test_the_newest_browser_is_asked_and_asked_again_when_it_failed() -> None:
    gone, fresh = Browser(10, (RuntimeError("gone"),) * 9), Browser(200, (RuntimeError("again"), TimeoutError()))
    assert shade(photograph(scene(gone, fresh), GROUND)) == ((WIDTH, WIDTH // 2), 200)


def test_a_browser_that_comes_late_is_waited_for() -> None:
    there: dict[int, Browser] = {}
    timer = threading.Timer(0.3, lambda: there.update({4: Browser(77)}))
    timer.start()
    assert shade(photograph(SimpleNamespace(get_clients=lambda: there), GROUND))[1] == 77  # pyright: ignore[reportArgumentType]


def test_nobody_there_is_a_sentence_and_a_closed_page_is_not_waited_for() -> None:
    with pytest.raises(PhotoError, match="sent no picture within 0 s; reload the page"):
        photograph(scene(), GROUND, patience_s=0.3)
    with pytest.raises(PhotoError):
        photograph(scene(), GROUND, wanted=lambda: False)


def test_where_nothing_is_drawn_the_ground_of_the_page_shines_through() -> None:
    with Image.open(io.BytesIO(photograph(scene(Browser(200)), GROUND))) as picture:
        assert picture.mode == "RGB"
        assert picture.getpixel((5, picture.height - 1)) == GROUND
        assert picture.getpixel((5, 5)) == (200, 200, 200)
