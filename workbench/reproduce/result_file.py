"""Result sets as files: small JSON, a line for every number, read with distrust and replaced as a whole."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, get_args

from sim.errors import SubMasError
from workbench.reproduce.protocol import Item
from workbench.reproduce.result_set import (
    SCHEMA,
    Curve,
    Flight,
    MissileCurve,
    Number,
    Replay,
    ReplayMissile,
    ResultSet,
    Training,
)
from workbench.run_files import strict, write_bytes

SIZE_LIMIT: Final = 2_000_000
"""Largest file that is read [bytes]; a full one of ten seeds has less than 200 000."""
ITEM_NAMES: Final = get_args(Item)
LISTS: Final = ("trainings", "numbers", "curves", "flights", "replays")
OPTIONAL: Final = ("seed_counts", "replays")
"""Left out of the file where they say nothing."""


class ResultSetError(SubMasError):
    """A result set cannot be read or written; the message names the file and what is wrong."""


def to_text(result: ResultSet) -> str:
    """The file's text: a line for every number, curve and flight, so that two versions compare line by line."""
    values = strict(dataclasses.asdict(result))
    head = {n: value for n, value in values.items() if n not in LISTS and (value or n not in OPTIONAL)}
    lines = [f"  {json.dumps(name)}: {_compact(value)}" for name, value in sorted(head.items())]
    for name in (name for name in LISTS if values[name] or name not in OPTIONAL):
        # What is empty stands for itself.
        rows = ",\n".join(f"    {_compact({k: v for k, v in row.items() if _says(k, v)})}" for row in values[name])
        lines.append(f'  "{name}": [\n{rows}\n  ]' if rows else f'  "{name}": []')
    return "{\n" + ",\n".join(lines) + "\n}\n"


def save(result: ResultSet, path: Path) -> bool:
    """Write the file, the whole of it or nothing; returns whether it is any different from before."""
    data = to_text(result).encode()
    if path.is_file() and path.read_bytes() == data:
        return False
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ResultSetError(f"results folder {path.parent} cannot be made: {error.strerror}") from error
    write_bytes(path, data)
    return True


def load(path: Path) -> ResultSet | None:
    """The result set in a file, or None if there is no file.

    Raises:
        ResultSetError: the file is damaged, or of another version.
    """
    try:
        with path.open("rb") as file:
            data = file.read(SIZE_LIMIT + 1)
    except FileNotFoundError:
        return None
    except OSError as error:
        raise ResultSetError(f"result set {path} cannot be read: {error.strerror}") from error
    if len(data) > SIZE_LIMIT:
        raise ResultSetError(f"result set {path} is larger than {SIZE_LIMIT // 1_000_000} MB")
    try:
        return from_json(json.loads(data))
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        raise ResultSetError(f"result set {path} is damaged or of another version: {error}") from error


def from_json(values: Any) -> ResultSet:
    """A result set from JSON values.

    Raises:
        ValueError, KeyError, TypeError, AttributeError: they are something else.
    """
    if values["schema"] != SCHEMA:
        raise ValueError(f"schema is {values['schema']!r}, this version reads {SCHEMA}")
    if values["item"] not in ITEM_NAMES:
        raise ValueError(f"item is {values['item']!r}")
    plain = _tuples(values)
    flights = [
        Flight(**{**flight, "missiles": tuple(MissileCurve(**missile) for missile in flight["missiles"])})
        for flight in plain["flights"]
    ]
    parts = {
        "trainings": tuple(Training(**training) for training in plain["trainings"]),
        "numbers": tuple(_checked(Number(**number)) for number in plain["numbers"]),
        "curves": tuple(Curve(**curve) for curve in plain["curves"]),
        "flights": tuple(flights),
        "replays": tuple(_replay(replay) for replay in plain.get("replays", ())),
    }
    return ResultSet(**{**plain, **parts})


def _replay(values: Mapping[str, Any]) -> Replay:
    replay = Replay(**{**values, "missiles": tuple(ReplayMissile(**missile) for missile in values["missiles"])})
    if not len(replay.time_s) == len(replay.evader_km) == len(replay.interceptor_km) > 0:
        raise ValueError(f"the replay of {replay.variant} has tracks of different lengths")
    return replay


def _checked(number: Number) -> Number:
    low, high = number.success_ci95
    if not 0.0 <= low <= number.success_rate <= high <= 1.0 or not math.isfinite(number.mean_return):
        raise ValueError(f"the number of {number.variant} on {number.task} is impossible")
    return number


def _tuples(value: Any) -> Any:
    if isinstance(value, dict):
        return {name: _tuples(item) for name, item in value.items()}
    return tuple(_tuples(item) for item in value) if isinstance(value, list) else value


def _says(name: str, value: Any) -> bool:
    return value != "" and (name != "resumes" or value != 0)


def _compact(value: Any) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
