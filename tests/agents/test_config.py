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


def test_runs_from_before_mask_and_order_are_written_as_they_were() -> None:
    assert not {"mask", "order"} & set(TrainingConfig(curriculum=True).to_json())
    config = TrainingConfig(curriculum=True, mask="2", order="1,4,3")
    assert TrainingConfig.from_json(json.loads(json.dumps(config.to_json()))) == config


def test_the_stages_follow_the_order_and_the_mask() -> None:
    # Algorithm 3: the first of the list is masked first and met last.
    assert TrainingConfig(curriculum=True).stages == ((1,), (1, 2), (1, 2, 3), (1, 2, 3, 4))
    assert TrainingConfig(curriculum=True, order="1,3,4,2").stages == ((2,), (2, 4), (2, 3, 4), (1, 2, 3, 4))
    masked = TrainingConfig(curriculum=True, mask="2", order="1, 4, 3")
    assert (masked.order, masked.stages) == ("1,4,3", ((3,), (3, 4), (1, 3, 4)))
    assert TrainingConfig(mask="3,1").stages == ((2, 4),)


def test_one_training_is_one_record() -> None:
    assert TrainingConfig(curriculum=True, order="4,3,2,1") == TrainingConfig(curriculum=True)
    assert TrainingConfig(mask="4, 3") == TrainingConfig(missiles=2)
    assert TrainingConfig(mask="4,2,4") == TrainingConfig(missiles=3, mask="2")


def test_who_learns_a_masked_task_from_scratch_gets_the_epochs_of_the_chain_to_it() -> None:
    assert TrainingConfig(variant="td3", mask="1,2").hyperparameters.epochs == 2 * PROFILES["fast"].epochs


@pytest.mark.parametrize(
    ("values", "sentence"),
    [
        ({"mask": "1,x"}, "mask '1,x' is not a list of missiles"),
        ({"mask": "5"}, "mask names missile 5; legal are 1 to 4"),
        ({"mask": "0"}, "mask names missile 0"),
        ({"mask": "1,2,3,4"}, "leaves nothing to learn"),
        ({"mask": 2}, "mask is 2; a str is needed"),
        ({"order": "4,3,2,1"}, "a single stage has none"),
        ({"curriculum": True, "order": "4,3,2"}, "each of the missiles 1,2,3,4 once"),
        ({"curriculum": True, "order": "4,3,2,2"}, "once"),
        ({"curriculum": True, "mask": "1", "order": "4,3,2,1"}, "each of the missiles 2,3,4 once"),
        ({"curriculum": True, "order": "4;3"}, "is not a list of missiles"),
        ({"curriculum": True, "order": ","}, "is not a list of missiles"),
    ],
)
def test_a_mask_or_an_order_that_makes_no_task_is_named(values: dict[str, object], sentence: str) -> None:
    with pytest.raises(ConfigError, match=sentence):
        TrainingConfig.from_json(values)
