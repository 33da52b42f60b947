"""S11: a policy file is exactly a policy or one sentence, whatever is in it; it never runs and is cheap to refuse."""

from __future__ import annotations

import json
import os
import pickle
import random
import struct
import time
import tracemalloc
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from safetensors.numpy import load, save

from agents.checkpoint import HEADER_LIMIT, SIZE_LIMIT, PolicyFileError, load_policy
from sim.assets import asset_path
from workbench import cli

GOOD = asset_path("policies", "submas-source-3.safetensors").read_bytes()
FUZZ = int(os.environ.get("FUZZ", "400"))
"""Mutated files a push; more are tried with `FUZZ=50000`."""
MEMORY_LIMIT_BYTES = 50_000_000
TIME_LIMIT_S = 10.0
"""Generous, as machines differ: what is meant is that nothing takes for ever."""


def parts(content: bytes) -> tuple[dict[str, Any], bytes]:
    (length,) = struct.unpack("<Q", content[:8])
    return json.loads(content[8 : 8 + length]), content[8 + length :]


def joined(header: object, data: bytes, length: int | None = None) -> bytes:
    text = header if isinstance(header, bytes) else json.dumps(header).encode()
    return struct.pack("<Q", len(text) if length is None else length) + text + data


def with_header(change: Callable[[dict[str, Any]], object]) -> bytes:
    header, data = parts(GOOD)
    return joined(change(header) or header, data)


def with_tensors(change: Callable[[dict[str, np.ndarray]], object]) -> bytes:
    header, _ = parts(GOOD)
    tensors = {name: array.copy() for name, array in load(GOOD).items()}
    change(tensors)
    return save(tensors, metadata=header["__metadata__"])


def with_card(**change: object) -> bytes:
    def alter(header: dict[str, Any]) -> None:
        card = json.loads(header["__metadata__"]["card"])
        header["__metadata__"]["card"] = json.dumps({**card, **change})

    return with_header(alter)


class Runs:
    """What would happen if anybody unpickled it."""

    def __reduce__(self) -> tuple[Callable[..., Any], tuple[str]]:
        return os.mkdir, ("stolen",)


def zip_bomb() -> bytes:
    import io

    buffer = io.BytesIO()
    with zipfile.ZipFile(buffer, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("archive/data.pkl", bytes(3_000_000))
    return buffer.getvalue()


def twice(header: dict[str, Any]) -> bytes:
    text = json.dumps(header)
    return (text[:-1] + ', "layers.0.bias": ' + json.dumps(header["layers.0.bias"]) + "}").encode()


def offsets(first: int, last: int) -> Callable[[dict[str, Any]], None]:
    return lambda header: header["layers.0.bias"].update(data_offsets=[first, last])


def first_value(value: float) -> Callable[[dict[str, np.ndarray]], None]:
    return lambda tensors: tensors["layers.0.weight"].__setitem__((0, 0), value)


HOSTILE: dict[str, bytes] = {
    "nothing": b"",
    "a pickle": pickle.dumps(Runs()),
    "a pickle in a header": joined(pickle.dumps(Runs()), b""),
    "a zip": zip_bomb(),
    "header length 2^63": joined({}, b"", 1 << 63),
    "header length 2^64-1": joined({}, b"", (1 << 64) - 1),
    "header longer than the file": joined({}, b"", 10_000),
    "header of 100 kB": with_header(lambda header: header["__metadata__"].update(more="x" * 100_000)),
    "a header of nests": joined(b"[" * 60_000, b""),
    "a card of nests": with_header(lambda header: header["__metadata__"].update(card="[" * 60_000)),
    "a card of deep nests in a value": with_header(
        lambda header: header["__metadata__"].update(card='{"evaluation":' + '{"a":' * 9_000 + "1" + "}" * 9_001)
    ),
    "a number of many digits": with_header(
        lambda header: header["__metadata__"].update(card='{"seed":' + "9" * 50_000 + "}")
    ),
    "a key twice": with_header(twice),
    "a card with a key twice": with_header(
        lambda header: header["__metadata__"].update(card=header["__metadata__"]["card"][:-1] + ', "seed": 1}')
    ),
    "a card with NaN": with_card(evaluation={"success_rate": float("nan")}),
    "no JSON": joined(b"\xff" * 50, b""),
    "a header that is a list": joined([], b""),
    "no metadata": joined({"a": {"dtype": "F32", "shape": [1], "data_offsets": [0, 4]}}, bytes(4)),
    "metadata that is a text": joined({"__metadata__": "card"}, b""),
    "offsets that overlap": with_header(offsets(0, 256)),
    "negative offsets": with_header(offsets(-4, 252)),
    "offsets beyond the end": with_header(offsets(0, 1 << 40)),
    "offsets the wrong way round": with_header(offsets(400, 100)),
    "a shape that overflows": with_header(lambda header: header["layers.0.bias"].update(shape=[1 << 62, 1 << 62])),
    "a negative shape": with_header(lambda header: header["layers.0.bias"].update(shape=[-1])),
    "an unknown type": with_header(lambda header: header["layers.0.bias"].update(dtype="PICKLE")),
    "another type": with_header(lambda header: header["layers.0.bias"].update(dtype="I32")),
    "bytes at the end": GOOD + b"more",
    "a tensor too many": with_tensors(lambda tensors: tensors.update({"../x": np.zeros(1, np.float32)})),
    "a tensor too few": with_tensors(lambda tensors: tensors.pop("layers.1.bias")),
    "weights of double precision": with_tensors(
        lambda tensors: tensors.update({"layers.0.weight": tensors["layers.0.weight"].astype(np.float64)})
    ),
    "a shape turned round": with_tensors(
        lambda tensors: tensors.update({"layers.0.weight": np.ascontiguousarray(tensors["layers.0.weight"].T)})
    ),
    "NaN": with_tensors(first_value(float("nan"))),
    "infinity": with_tensors(first_value(float("inf"))),
    "the shapes of another task": joined(
        parts(asset_path("policies", "submas-target.safetensors").read_bytes())[0], parts(GOOD)[1]
    ),
    "another task's card": with_card(missiles=[1, 2, 3, 4]),
    "a billion neurons": with_card(hidden=[1 << 30, 1 << 30]),
    "a name that steers": with_card(name="\x1b[31m"),
    "an unknown bend": with_card(activation="__import__('os')"),
    "too large": GOOD + bytes(SIZE_LIMIT),
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_one_sentence(
    name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    path = tmp_path / "policy.safetensors"
    path.write_bytes(HOSTILE[name])
    tracemalloc.start()
    began_s = time.monotonic()
    try:
        with pytest.raises(PolicyFileError) as caught:
            load_policy(path)
        assert tracemalloc.get_traced_memory()[1] < MEMORY_LIMIT_BYTES
    finally:
        tracemalloc.stop()
    assert time.monotonic() - began_s < TIME_LIMIT_S
    sentence = str(caught.value)
    assert sentence.startswith(f"policy file '{path}'") and len(sentence) < len(str(path)) + 300
    assert cli.main(["fly", str(path)]) == 2
    told = capsys.readouterr()
    assert told.out == "" and told.err.count("\n") == 1 and told.err.startswith("workbench: policy file ")
    assert [each.name for each in tmp_path.iterdir()] == [path.name], "it was read, and nothing else happened"


def test_a_good_file_is_a_policy_and_small(tmp_path: Path) -> None:
    path = tmp_path / "policy.safetensors"
    path.write_bytes(GOOD)
    assert load_policy(path).layout is not None
    assert len(GOOD) < SIZE_LIMIT and struct.unpack("<Q", GOOD[:8])[0] < HEADER_LIMIT / 8


def test_a_huge_file_is_refused_by_its_beginning(tmp_path: Path) -> None:
    path = tmp_path / "policy.safetensors"
    path.write_bytes(GOOD)
    os.truncate(path, 400_000_000)  # a hole: it takes no space on the disk
    tracemalloc.start()
    try:
        with pytest.raises(PolicyFileError, match="is larger than 4 MB, no policy is"):
            load_policy(path)
        assert tracemalloc.get_traced_memory()[1] < MEMORY_LIMIT_BYTES
    finally:
        tracemalloc.stop()


def test_every_truncation_is_one_sentence(tmp_path: Path) -> None:
    path = tmp_path / "policy.safetensors"
    lengths = [*range(0, 64), *range(64, 2500, 61), *range(2500, len(GOOD), 16_384), len(GOOD) - 1]
    for length in lengths:
        path.write_bytes(GOOD[:length])
        with pytest.raises(PolicyFileError):
            load_policy(path)


def mutated(chance: random.Random) -> bytes:
    """The good file with a few bytes changed, cut out, doubled or moved; mostly in its header."""
    content = bytearray(GOOD)
    for _ in range(chance.choice((1, 1, 2, 4, 16))):
        place = chance.randrange(8 if chance.random() < 0.2 else chance.choice((2000, len(content))))
        kind = chance.randrange(5)
        if kind == 0:
            content[place] ^= 1 << chance.randrange(8)
        elif kind == 1:
            content[place : place + chance.randrange(1, 40)] = b""
        elif kind == 2:
            content[place:place] = content[place : place + chance.randrange(1, 40)]
        elif kind == 3:
            content[place : place + 1] = chance.choice(
                (b"\x00", b"\xff", b'"', b"{", b"[", b"9", b"-", b"e", b"\\u0000")
            )
        else:
            content[place : place + 8] = struct.pack(
                "<Q", chance.choice((0, 1, 1 << 31, 1 << 32, 1 << 63, (1 << 64) - 1))
            )
    return bytes(content)


def test_mutations_are_policies_or_one_sentence(tmp_path: Path) -> None:
    path, chance = tmp_path / "policy.safetensors", random.Random(f"policies {FUZZ}")
    refused = 0
    began_s = time.monotonic()
    for _ in range(FUZZ):
        path.write_bytes(mutated(chance))
        try:
            policy = load_policy(path)
        except PolicyFileError:
            refused += 1
        else:
            assert all(np.isfinite(array).all() for layer in policy.layers for array in layer)
    assert refused > FUZZ / 2
    assert time.monotonic() - began_s < TIME_LIMIT_S * FUZZ / 10


@pytest.mark.parametrize("kind", ["folder", "pipe", "link to nothing", "device"])
def test_what_is_no_plain_file_is_one_sentence_and_nobody_waits(
    kind: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "policy.safetensors"
    if kind == "folder":
        path.mkdir()
    elif kind == "pipe":
        os.mkfifo(path)
    else:
        path.symlink_to("/dev/zero" if kind == "device" else tmp_path / "nothing")
    assert cli.main(["fly", str(path)]) == 2
    told = capsys.readouterr().err
    assert told.count("\n") == 1 and "does not exist" in told
