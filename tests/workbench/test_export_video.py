"""Animations, read back by other libraries than wrote them where there is one: pictures, durations, what is seen."""

from __future__ import annotations

import io
import sys
from itertools import pairwise

import av
import numpy as np
import pytest
from PIL import Image

from layouts.animation import HOLD_S
from layouts.theme import FAILURE, POLICY_A, POLICY_B, SUCCESS, rgb
from sim.world import Outcome
from tests.workbench.flights import ending, shorten_films
from workbench import cli, export_video
from workbench.export_video import GIF_HEIGHT, GIF_PER_S, MP4_HEIGHT, MP4_PER_S, NO_ENCODER, gif_bytes, mp4_bytes

Told = list[tuple[int, int]]


@pytest.fixture(autouse=True)
def _short_films(monkeypatch: pytest.MonkeyPatch) -> None:
    shorten_films(monkeypatch)


def silent(_done: int, _total: int) -> None:
    pass


def gif_pictures(data: bytes) -> tuple[list[np.ndarray], list[int]]:
    pictures, durations = [], []
    with Image.open(io.BytesIO(data)) as animation:
        for number in range(animation.n_frames):
            animation.seek(number)
            pictures.append(np.asarray(animation.convert("RGB")))
            durations.append(animation.info["duration"])
    return pictures, durations


def near(picture: np.ndarray, colour: str, distance: float = 24.0) -> int:
    """How many pixels have almost this colour."""
    return int((np.linalg.norm(picture.astype(float) - rgb(colour), axis=2) < distance).sum())


def test_a_gif_shows_the_flight_and_holds_its_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(export_video, "GIF_SECONDS", HOLD_S + 0.5)
    told: Told = []
    data = gif_bytes([ending(Outcome.SHOT_DOWN)], lambda done, total: told.append((done, total)))
    pictures, durations = gif_pictures(data)
    assert pictures[0].shape == (GIF_HEIGHT, GIF_HEIGHT * 16 // 9, 3)
    assert sum(durations) == round((HOLD_S + 0.5) * 1000)
    assert durations[-1] >= HOLD_S * 1000
    assert told == [(number, 25) for number in range(1, 26)]
    assert all((before != after).any() for before, after in pairwise(pictures))
    assert near(pictures[0], POLICY_A) > 20
    failure = [near(picture[: GIF_HEIGHT // 10], FAILURE) for picture in (pictures[0], pictures[-1])]
    assert failure[0] == 0 < failure[1]


def test_a_gif_repeats_for_ever_and_says_what_it_shows() -> None:
    with Image.open(io.BytesIO(gif_bytes([ending(Outcome.EXIT)], silent))) as animation:
        assert animation.info["loop"] == 0
        assert b"exit of a test on target" in animation.info["comment"]


def test_a_film_has_all_its_pictures_at_its_rate(monkeypatch: pytest.MonkeyPatch) -> None:
    told: Told = []
    data = mp4_bytes([ending(Outcome.EXIT), ending(Outcome.SHOT_DOWN)], lambda *step: told.append(step))
    with av.open(io.BytesIO(data)) as film:
        (stream,) = film.streams
        assert (stream.codec_context.name, stream.codec_context.pix_fmt) == ("h264", "yuv420p")
        assert stream.average_rate == MP4_PER_S
        pictures = [frame.to_ndarray(format="rgb24") for frame in film.decode(video=0)]
        assert "of a test on target" in film.metadata["title"]
    assert len(pictures) == len(told) == round((HOLD_S + 0.2) * MP4_PER_S)
    assert pictures[0].shape == (MP4_HEIGHT, MP4_HEIGHT * 16 // 9, 3)
    left, right = (pictures[-1][: MP4_HEIGHT // 8, half] for half in (slice(640), slice(640, 1280)))
    assert near(left, POLICY_A, 40) and near(right, POLICY_B, 40)
    assert near(left, SUCCESS, 40) and near(right, FAILURE, 40)
    assert not near(left, FAILURE, 40)
    assert data.index(b"moov") < data.index(b"mdat"), "a browser would have to load all of it before it plays"


def test_a_damaged_film_is_not_read_as_one() -> None:
    """The reading of the tests above can fail."""
    data = mp4_bytes([ending(Outcome.EXIT)], silent)
    with pytest.raises(av.error.FFmpegError):
        av.open(io.BytesIO(data[: data.index(b"moov")]))
    animation = gif_bytes([ending(Outcome.EXIT)], silent)
    with pytest.raises((OSError, EOFError)):
        gif_pictures(animation[:-4000])


def test_the_rates_of_pictures_are_those_promised() -> None:
    assert (GIF_PER_S, MP4_PER_S) == (10, 20)


def test_without_the_encoder_one_sentence_says_what_to_install(
    monkeypatch: pytest.MonkeyPatch, tmp_path: pytest.TempPathFactory, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "av", None)
    assert cli.main(["fly", "random", "--out", f"{tmp_path}/flight.mp4"]) == 1
    assert capsys.readouterr().err == f"workbench: {NO_ENCODER}\n"
