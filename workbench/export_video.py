"""An engagement as moving pictures: `.gif` for slides and pages, `.mp4` (H.264) for talks."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Callable, Iterator, Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from layouts.animation import frame_count, pictures
from layouts.captions import caption
from layouts.theme import BRANCH, DARK, FAILURE, GATE, INTERCEPTOR, POLICY_A, POLICY_B, SUCCESS, missile_colour, rgb
from sim.errors import SubMasError
from sim.trajectory import Trajectory

if TYPE_CHECKING:
    from PIL import Image

Update = Callable[[int, int], None]
"""Called with how many pictures are done and how many there are."""

GIF_SECONDS, GIF_PER_S, GIF_HEIGHT = 18.0, 10, 450
MP4_SECONDS, MP4_PER_S, MP4_HEIGHT = 24.0, 20, 720

QUALITY = "21"
"""Of x264, its `crf`: smaller is better and larger; from about 18 on nobody sees a difference."""

NO_ENCODER = (
    "a .mp4 needs the encoder PyAV (36 MB): install it with "
    "`pip install 'submas-workbench[export]'` or `pip install av`, or write a .gif"
)


class EncoderMissingError(SubMasError):
    """The library that a format needs is not installed."""


def check_encoder() -> None:
    """Whether a film can be encoded here, to be asked before one is drawn.

    Raises:
        EncoderMissingError: PyAV is not installed.
    """
    try:
        import av  # noqa: F401
    except ImportError as error:
        raise EncoderMissingError(NO_ENCODER) from error


def gif_bytes(flights: Sequence[Trajectory], update: Update) -> bytes:
    """An endless animation, 800 x 450 pixels; equal flights give equal files."""
    from PIL import Image

    count = frame_count(flights, GIF_SECONDS, GIF_PER_S)
    palette: Image.Image | None = None
    frames: list[Image.Image] = []
    for number, picture in enumerate(pictures(flights, GIF_SECONDS, GIF_PER_S, GIF_HEIGHT)):
        palette = palette or _palette()
        frames.append(Image.fromarray(picture).quantize(palette=palette, dither=Image.Dither.NONE))
        update(number + 1, count)
    buffer = io.BytesIO()
    first, *rest = frames
    first.save(
        buffer, "gif", save_all=True, append_images=rest, duration=1000 // GIF_PER_S, loop=0, optimize=False,
        disposal=1, comment=_title(flights).encode(),
    )  # fmt: skip
    return buffer.getvalue()


def _title(flights: Sequence[Trajectory]) -> str:
    """What the file shows, for its metadata; pictures alone do not say who left whom when."""
    return " | ".join(caption(flight) for flight in flights)


def _palette() -> Image.Image:
    """Every ink of the pictures in steps towards the grounds it lies on: the same colours in all pictures."""
    from PIL import Image

    inks = [POLICY_A, POLICY_B, BRANCH, INTERCEPTOR, GATE, SUCCESS, FAILURE]
    inks += [*(missile_colour(number) for number in range(1, 9)), "#e6ecf5", "#9aa7ba", "#ff963c", "#293446"]
    shares = np.linspace(0.12, 1.0, 12)[:, None]
    back, field = (np.array(colour, dtype=float) for colour in (DARK.background, DARK.field))
    colours = [back, field, np.array(DARK.grid, dtype=float), np.array(DARK.border, dtype=float)]
    for ink in dict.fromkeys(inks):
        colours += list(back + (np.array(rgb(ink)) - back) * shares)
    table = np.unique(np.array(colours).round().astype(np.uint8), axis=0)[:256]
    made = Image.new("P", (1, 1))
    made.putpalette(table.tobytes())
    return made


def mp4_bytes(flights: Sequence[Trajectory], update: Update) -> bytes:
    """A film of 1280 x 720 pixels that every player and slide program shows; equal flights give equal files.

    Raises:
        EncoderMissingError: PyAV is not installed.
    """
    check_encoder()
    import av

    # A file of its own: to move the index to the front, the library has to open what it has written again.
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "flight.mp4"
        with av.open(path, "w", format="mp4", options={"movflags": "+faststart", "fflags": "+bitexact"}) as container:
            container.metadata.update({"title": _title(flights), "comment": "SubMas workbench"})
            for packet in _packets(_stream(container), flights, update):
                container.mux(packet)
        return path.read_bytes()


def _stream(container: Any) -> Any:
    stream = container.add_stream("libx264", rate=MP4_PER_S)
    stream.width, stream.height, stream.pix_fmt = MP4_HEIGHT * 16 // 9, MP4_HEIGHT, "yuv420p"
    stream.time_base = Fraction(1, MP4_PER_S)
    # One thread: how the work is split changes the file, and machines differ in cores.
    stream.options = {"crf": QUALITY, "preset": "veryfast", "tune": "animation", "threads": "1"}
    return stream


def _packets(stream: Any, flights: Sequence[Trajectory], update: Update) -> Iterator[Any]:
    import av

    count = frame_count(flights, MP4_SECONDS, MP4_PER_S)
    for number, picture in enumerate(pictures(flights, MP4_SECONDS, MP4_PER_S, MP4_HEIGHT)):
        frame = av.VideoFrame.from_ndarray(picture, format="rgb24")
        frame.pts = number
        yield from stream.encode(frame)
        update(number + 1, count)
    yield from stream.encode(None)
