"""Configurations: there and back through JSON, and every mistake named."""

from __future__ import annotations

import dataclasses
import json

import pytest

from agents.config import PROFILES, VARIANTS, ConfigError, TrainingConfig


def test_json_and_back() -> None:
    config = TrainingConfig(curriculum=True, missiles=2, variant="dec-pr", profile="paper", seed=7, name="try")
    values = json.loads(json.dumps(config.to_json()))
    assert TrainingConfig.from_json(values) == config
    assert config.hyperparameters is PROFILES["paper"]


def test_missing_keys_take_their_defaults() -> None:
    assert TrainingConfig.from_json({}) == TrainingConfig()


@pytest.mark.parametrize(
    ("values", "words"),
    [
        ({"missile": 2}, ["missile", "missiles"]),
        ({"missiles": 0}, ["missiles", "0", "1 to 64"]),
        ({"missiles": True}, ["missiles", "True", "int"]),
        ({"missiles": "2"}, ["missiles", "'2'", "int"]),
        ({"seed": -1}, ["seed", "-1"]),
        ({"seed": 1.5}, ["seed", "1.5"]),
        ({"variant": "sub"}, ["variant", "sub", "wo-pd"]),
        ({"profile": "slow"}, ["profile", "slow", "paper"]),
        ({"scenario": " "}, ["scenario"]),
        ({"name": "two\nlines"}, ["name"]),
        ({"curriculum": 1}, ["curriculum", "1", "bool"]),
        ([], ["list"]),
    ],
)
def test_mistakes_are_named(values: object, words: list[str]) -> None:
    with pytest.raises(ConfigError) as caught:
        TrainingConfig.from_json(values)  # type: ignore[arg-type]
    assert all(word in str(caught.value) for word in words)
    assert "\n" not in str(caught.value) and caught.value.exit_code == 2


@pytest.mark.parametrize(
    ("field", "value"), [("gamma", 1.2), ("batch_size", 0), ("hidden", ()), ("hidden", (0,)), ("gamma", float("nan"))]
)
def test_hyperparameters_out_of_range_are_named(field: str, value: object) -> None:
    with pytest.raises(ConfigError, match=field):
        dataclasses.replace(PROFILES["fast"], **{field: value})


def test_the_agreed_names_exist() -> None:
    assert list(PROFILES) == ["paper", "fast", "smoke"]
    assert list(VARIANTS)[:5] == ["submas", "wo-pd", "wo-pr", "dec-pd", "dec-pr"]
    for variant in VARIANTS:
        assert TrainingConfig(variant=variant).variant == variant  # type: ignore[arg-type]
