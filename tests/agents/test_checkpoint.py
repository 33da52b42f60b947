"""Policy files: what is written comes back, and nothing damaged, foreign or oversized gets in."""

from __future__ import annotations

import dataclasses
import json
import os
from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import save

from agents.checkpoint import SIZE_LIMIT, PolicyCard, PolicyFileError, load_policy, save_policy
from agents.policy import NetworkPolicy
from tests.agents.test_policy import network_policy, observations

CARD = PolicyCard(
    name="submas-test",
    task="source-2",
    missiles=(1, 2),
    hidden=(32, 16),
    layout_digest="",
    features_digest="",
    scenario="default",
    scenario_digest="0123456789ab",
    variant="submas",
    profile="fast",
    seed=1,
    command="workbench train --missiles 2",
    code_version="0.1.0",
    epoch=3,
    env_steps=1000,
    updates=50,
    final=True,
    evaluation={"success_rate": 0.5},
)


def _card(policy: NetworkPolicy) -> PolicyCard:
    return dataclasses.replace(CARD, layout_digest=policy.layout.digest, features_digest=policy.features.digest)


def _tensors(policy: NetworkPolicy) -> dict[str, np.ndarray]:
    named = {}
    for index, (weight, bias) in enumerate(policy.layers):
        named[f"layers.{index}.weight"], named[f"layers.{index}.bias"] = weight.copy(), bias.copy()
    return named


def _write(path: Path, tensors: dict[str, np.ndarray], card: object) -> Path:
    path.write_bytes(save(tensors, metadata={"card": json.dumps(card)}))
    return path


@pytest.fixture
def policy() -> NetworkPolicy:
    return network_policy((1, 2))


def test_a_policy_comes_back_as_it_was(tmp_path: Path, policy: NetworkPolicy) -> None:
    path = tmp_path / "made" / "source-2.safetensors"
    save_policy(path, policy, _card(policy))
    loaded = load_policy(path)
    assert loaded.card == _card(policy) and loaded.name == "submas-test"
    seen = observations(policy.layout)
    np.testing.assert_array_equal(loaded.act(seen, loaded.layout), policy.act(seen, policy.layout))
    assert json.loads(path.with_suffix(".json").read_text())["missiles"] == [1, 2]
    assert sorted(file.name for file in path.parent.iterdir()) == ["source-2.json", "source-2.safetensors"]


def test_a_failed_write_leaves_the_old_file_and_no_litter(
    tmp_path: Path, policy: NetworkPolicy, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "p.safetensors"
    save_policy(path, policy, _card(policy))
    before = path.read_bytes()

    def full(source: str, target: Path) -> None:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "replace", full)
    with pytest.raises(OSError, match="No space"):
        save_policy(path, network_policy((1, 2), seed=9), _card(policy))
    assert path.read_bytes() == before
    assert sorted(file.name for file in tmp_path.iterdir()) == ["p.json", "p.safetensors"]


def _refused(path: Path, *words: str) -> None:
    with pytest.raises(PolicyFileError) as caught:
        load_policy(path)
    assert str(path) in str(caught.value)
    assert all(word in str(caught.value) for word in words), str(caught.value)


def test_missing_files_folders_and_empty_files_are_refused(tmp_path: Path) -> None:
    _refused(tmp_path / "none.safetensors", "No such file")
    _refused(tmp_path, "cannot be read")
    empty = tmp_path / "empty.safetensors"
    empty.write_bytes(b"")
    _refused(empty, "damaged")


def test_oversized_files_are_refused_unread(tmp_path: Path) -> None:
    path = tmp_path / "big.safetensors"
    with path.open("wb") as file:
        file.truncate(SIZE_LIMIT + 1)
    _refused(path, "4 MB")


def test_every_truncation_and_a_pickle_are_refused(tmp_path: Path, policy: NetworkPolicy) -> None:
    path = tmp_path / "p.safetensors"
    save_policy(path, policy, _card(policy))
    content = path.read_bytes()
    for length in (1, 8, 100, len(content) // 2, len(content) - 1):
        path.write_bytes(content[:length])
        _refused(path)
    path.write_bytes(b"\x80\x04\x95" + bytes(100))
    _refused(path, "damaged")


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"extra": np.zeros(1, np.float32)}, "extra"),
        ({"layers.0.bias": None}, "layers.0.bias"),
        ({"layers.0.bias": np.zeros(31, np.float32)}, "layers.0.bias"),
        ({"layers.1.weight": np.zeros((16, 32), np.float64)}, "float64"),
        ({"layers.2.bias": np.array([np.nan], np.float32)}, "finite"),
        ({"layers.2.bias": np.array([np.inf], np.float32)}, "finite"),
    ],
)
def test_wrong_tensors_are_refused(
    tmp_path: Path, policy: NetworkPolicy, change: dict[str, np.ndarray | None], word: str
) -> None:
    tensors = {name: array for name, array in {**_tensors(policy), **change}.items() if array is not None}
    _refused(_write(tmp_path / "p.safetensors", tensors, _card(policy).to_json()), word)


@pytest.mark.parametrize(
    ("change", "word"),
    [
        ({"layout_digest": "other"}, "other observations"),
        ({"features_digest": "other"}, "other observations"),
        ({"missiles": [1, 2, 3]}, "other observations"),
        ({"missiles": "12"}, "missiles"),
        ({"missiles": [1, "2"]}, "missiles"),
        ({"missiles": [10**9]}, "missiles"),
        ({"hidden": [10**9, 16]}, "hidden"),
        ({"seed": True}, "seed"),
        ({"name": "x" * 501}, "name"),
        ({"name": "a\x1b[31m"}, "name"),
        ({"final": 1}, "final"),
        ({"evaluation": [1]}, "evaluation"),
        ({"unknown": 1}, "unknown"),
    ],
)
def test_wrong_cards_are_refused(tmp_path: Path, policy: NetworkPolicy, change: dict[str, object], word: str) -> None:
    card = {**_card(policy).to_json(), **change}
    _refused(_write(tmp_path / "p.safetensors", _tensors(policy), card), word)


@pytest.mark.parametrize("card", [None, [], "text", {}, 3])
def test_a_card_that_is_no_card_is_refused(tmp_path: Path, policy: NetworkPolicy, card: object) -> None:
    _refused(_write(tmp_path / "p.safetensors", _tensors(policy), card), "card")


def test_a_file_without_a_card_is_refused(tmp_path: Path, policy: NetworkPolicy) -> None:
    path = tmp_path / "p.safetensors"
    path.write_bytes(save(_tensors(policy)))
    _refused(path, "no card")


def test_single_flipped_bytes_never_raise_anything_else(tmp_path: Path, policy: NetworkPolicy) -> None:
    path = tmp_path / "p.safetensors"
    save_policy(path, policy, _card(policy))
    content = bytearray(path.read_bytes())
    for position in range(0, min(len(content), 2500), 7):
        damaged = bytearray(content)
        damaged[position] ^= 0x41
        path.write_bytes(damaged)
        try:
            load_policy(path)
        except PolicyFileError:
            continue
