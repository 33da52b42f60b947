"""Policy files: safetensors with a card, written so that a reader sees the old file or the new one, never half.

The card travels inside the file; the JSON file beside it is a copy to read and to search.
"""

from __future__ import annotations

import dataclasses
import json
import struct
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load, save

from agents.disk import replace_file
from agents.features import ObservationFeatures
from agents.policy import ACTIVATIONS, SQUASHES, NetworkPolicy
from agents.task import Domain, FloatArray
from sim.errors import UsageError, shorten

SIZE_LIMIT: Final = 4_000_000
"""Largest policy file that is read [bytes]."""
HEADER_LIMIT: Final = 64 * 1024
"""Longest header, card included, that is parsed [bytes]."""
CARD_KEY: Final = "card"
_BENDS: Final = {"activation": ACTIVATIONS, "squash": SQUASHES}


class PolicyFileError(UsageError):
    """A policy file is missing, damaged, or made for something else."""


@dataclass(frozen=True, kw_only=True)
class PolicyCard:
    """Where a policy comes from and what it was trained for."""

    name: str
    """Name shown in tables and commands."""
    task: str
    """Name of the task it was trained on."""
    missiles: tuple[int, ...]
    """Subtasks it knows."""
    hidden: tuple[int, ...]
    """Widths of its hidden layers."""
    layout_digest: str
    """Identifies the columns of its observations."""
    features_digest: str
    """Identifies how its network reads them."""
    scenario: str
    scenario_digest: str
    variant: str
    profile: str
    seed: int
    command: str
    """Command line that makes such a policy."""
    code_version: str
    epoch: int
    """Epoch of its stage after which it was taken."""
    env_steps: int
    """Environment steps of its stage until then."""
    updates: int
    """Gradient steps of its stage until then."""
    final: bool
    """The stage is over; this is its best policy."""
    evaluation: Mapping[str, Any] | None = None
    """With the keys of `workbench evaluate --json`: a final policy on fresh episodes that had no part in choosing it,
    any other on the held-out episodes by which it became the best so far."""
    activation: str = "relu"
    """Bend of its hidden layers, one of `agents.policy.ACTIVATIONS`; older files do not say."""
    squash: str = "tanh"
    """Bend of its output, one of `agents.policy.SQUASHES`; likewise."""

    def to_json(self) -> dict[str, Any]:
        """All fields as plain JSON values."""
        return dataclasses.asdict(self)


def save_policy(path: Path | str, policy: NetworkPolicy, card: PolicyCard) -> None:
    """Write a policy and its card to `path` (.safetensors), and the card beside it as JSON."""
    path = Path(path)
    text = json.dumps(card.to_json(), indent=2, ensure_ascii=False, allow_nan=False)
    tensors = {name: np.ascontiguousarray(array) for name, array in _named(policy).items()}
    _replace(path, save(tensors, metadata={CARD_KEY: text}))
    _replace(path.with_suffix(".json"), (text + "\n").encode())


def load_policy(path: Path | str, domain: Domain | None = None) -> NetworkPolicy:
    """Read a policy file, distrusting it: size, card, tensor names, shapes, types and values are all checked.

    Raises:
        PolicyFileError: naming the file and what is wrong with it.
    """
    path = Path(path)
    content = _read(path)
    card = _card(path, content)
    features = _features(path, card, domain or _evasion())
    try:
        tensors = load(content)
    except (SafetensorError, ValueError, KeyError, TypeError) as error:
        raise PolicyFileError(f"policy file '{path}' is damaged: {shorten(str(error), 200)}") from None
    layers = _layers(path, tensors, [features.size, *card.hidden, 1])
    limit = (domain or _evasion()).action_limit
    return NetworkPolicy(card.name, features, layers, limit, card, activation=card.activation, squash=card.squash)


def _named(policy: NetworkPolicy) -> dict[str, FloatArray]:
    named = {}
    for index, (weight, bias) in enumerate(policy.layers):
        named[f"layers.{index}.weight"], named[f"layers.{index}.bias"] = weight, bias
    return named


def _read(path: Path) -> bytes:
    try:
        with path.open("rb") as file:
            content = file.read(SIZE_LIMIT + 1)
    except OSError as error:
        raise PolicyFileError(f"policy file '{path}' cannot be read: {error.strerror}") from None
    if len(content) > SIZE_LIMIT:
        raise PolicyFileError(f"policy file '{path}' is larger than {SIZE_LIMIT // 1_000_000} MB, no policy is")
    return content


def _card(path: Path, content: bytes) -> PolicyCard:
    """The card in a file's header; every field present, none unknown, all of the right type."""
    try:
        (length,) = struct.unpack("<Q", content[:8])
        if length > HEADER_LIMIT:
            raise ValueError("a header as long as no policy's")
        header = _strict_json(content[8 : 8 + length])
        values = _strict_json(header["__metadata__"][CARD_KEY])
    except (struct.error, ValueError, KeyError, TypeError, RecursionError):
        raise PolicyFileError(f"policy file '{path}' is damaged or has no card") from None
    return card_from_json(values, f"policy file '{path}'")


def _strict_json(text: bytes | str) -> Any:
    """JSON in which no key occurs twice and every number is finite; two readers could take others for two meanings."""
    return json.loads(text, object_pairs_hook=_distinct, parse_constant=_refuse_constant)


def _distinct(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    values = dict(pairs)
    if len(values) < len(pairs):
        raise ValueError("a key occurs twice")
    return values


def _refuse_constant(name: str) -> None:
    raise ValueError(f"{name} is no JSON number")


def card_from_json(values: Any, where: str) -> PolicyCard:
    """A card from JSON values.

    Raises:
        PolicyFileError: starting with `where`, for unknown, missing or impossible values.
    """
    names = {item.name for item in dataclasses.fields(PolicyCard)}
    needed = {item.name for item in dataclasses.fields(PolicyCard) if item.default is dataclasses.MISSING}
    if not isinstance(values, dict) or set(values) - names or needed - set(values):
        raise PolicyFileError(f"{where} has a card with unknown or missing keys")
    values = dict(values)
    for name in ("missiles", "hidden"):
        if not isinstance(values[name], list):
            raise PolicyFileError(f"{where} has a card whose {name} is not a list")
        values[name] = tuple(values[name])
    given = [item for item in dataclasses.fields(PolicyCard) if item.name in values]
    wrong = [item.name for item in given if not _legal(item, values[item.name])]
    if wrong:
        raise PolicyFileError(f"{where} has a card whose {wrong[0]} is {shorten(repr(values[wrong[0]]))}")
    return PolicyCard(**values)


def _legal(item: dataclasses.Field[Any], value: Any) -> bool:
    if item.name == "evaluation":
        return value is None or isinstance(value, dict)
    if item.name in _BENDS:
        return isinstance(value, str) and value in _BENDS[item.name]
    if item.type == "tuple[int, ...]":
        return len(value) <= 64 and all(type(number) is int and 0 < number <= 4096 for number in value)
    if item.type == "str":
        return isinstance(value, str) and len(value) <= 500 and (value.isprintable() or not value)
    return type(value) is {"int": int, "bool": bool}[str(item.type)]


def _features(path: Path, card: PolicyCard, domain: Domain) -> ObservationFeatures:
    layout = domain.layout(card.missiles)
    features = domain.features(layout)
    if card.layout_digest != layout.digest or card.features_digest != features.digest:
        raise PolicyFileError(
            f"policy file '{path}' was made for other observations than this version's; train it again"
        )
    return features


def _layers(path: Path, tensors: dict[str, Any], widths: list[int]) -> list[tuple[FloatArray, FloatArray]]:
    expected = {}
    for index in range(len(widths) - 1):
        expected[f"layers.{index}.weight"] = (widths[index + 1], widths[index])
        expected[f"layers.{index}.bias"] = (widths[index + 1],)
    if set(tensors) != set(expected):
        odd = sorted(set(tensors) ^ set(expected))
        raise PolicyFileError(f"policy file '{path}' has missing or unexpected tensors: {', '.join(odd)[:200]}")
    for name, shape in expected.items():
        array = tensors[name]
        if array.shape != shape or array.dtype != np.float32:
            found = f"{array.dtype} {list(array.shape)}"
            raise PolicyFileError(f"policy file '{path}': {name} is {found}; float32 {list(shape)} is needed")
        if not np.isfinite(array).all():
            raise PolicyFileError(f"policy file '{path}': {name} holds numbers that are not finite")
    pairs = range(len(widths) - 1)
    return [(tensors[f"layers.{i}.weight"], tensors[f"layers.{i}.bias"]) for i in pairs]


def _replace(path: Path, content: bytes) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    replace_file(path, content)


def _evasion() -> Domain:
    from agents.evasion import EVASION

    return EVASION
