"""S12, S13, S15: every value of an address or a configuration has its range; beyond it is a sentence or a default."""

from __future__ import annotations

import dataclasses
import math
import random
import string
from collections.abc import Callable, Mapping
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from agents.config import TrainingConfig
from sim.errors import SubMasError, UsageError
from tests.security.hostile import EVERY
from workbench.branch_text import read_branch
from workbench.pages import compare_settings, fly_look, fly_settings, fly_start, runs_settings
from workbench.policies import resolve_policy
from workbench.run_index.index import RunIndex
from workbench.run_index.query import RunSearch
from workbench.runs import RunStore
from workbench.seeds import parse_seeds

POLICIES = ["submas-target", "expert-dragging", "expert-navigation", "random"]
SCENARIOS = ["default", "six-missiles", "short-range"]
NUMBERS = (
    "-1",
    "0",
    "1e308",
    "1e999",
    "nan",
    "inf",
    "-inf",
    "0x10",
    "1_000",
    "９",
    "9" * 5000,
    "1.5",
    "",
    " 1 ",
    "+1",
    "1e-400",
)
LISTS = (",", "1,2", ",".join(["1"] * 10_000), "1,,2", "0-999999999", "5-1", "1-", "-", "4,4,4", "1;2", "[1]", "1,2\n")
PYTHON = (
    "__import__('os').system('x')",
    "index > 0 and @pd.eval('1')",
    "1=1; DROP TABLE run",
    "' OR '1'='1",
    "%' --",
    "*",
    "a*b?[c]",
)
VALUES = (*EVERY, *NUMBERS, *LISTS, *PYTHON)
READERS: dict[str, Callable[[Mapping[str, str]], Any]] = {
    "fly": lambda query: fly_settings.read_settings(
        query, POLICIES, SCENARIOS, fly_settings.default_settings(POLICIES)
    ),
    "start": fly_start.read_start,
    "look": fly_look.read_look,
    "compare": lambda query: compare_settings.read_settings(query, POLICIES, SCENARIOS),
    "runs": runs_settings.read_settings,
}
NAMES = sorted(
    {"a", "b", "mask", "seed", "episode", "shot", "t", "policies", "tasks", "scenario", "episodes", "task", "policy",
     "against", "q", "sort", "view", "group", "open", "show", "run", "baseline", "curves", "x", "stages", "smooth",
     "fields", "camera", "eye", "theme", "branch", "tab", "speed", "orders"}
)  # fmt: skip


@pytest.mark.parametrize("reader", READERS)
def test_no_value_of_an_address_is_more_than_a_default_and_a_sentence(reader: str) -> None:
    for name in NAMES:
        for value in VALUES:
            text = value.encode("utf-8", "replace").decode()
            bounded(READERS[reader]({name: text}))


def test_many_values_at_once_are_no_different() -> None:
    chance = random.Random("addresses")
    for _ in range(300):
        query = {name: chance.choice(VALUES) for name in chance.sample(NAMES, 8)}
        query["".join(chance.choices(string.printable, k=5))] = chance.choice(VALUES)
        for read in READERS.values():
            bounded(read(query))


def bounded(found: Any) -> None:
    """No number of what was read is without bounds, and no text longer than a view can need."""
    if isinstance(found, float):
        assert math.isfinite(found) and abs(found) < 1e15
    elif isinstance(found, int):
        assert abs(found) <= fly_settings.SEED_MAX
    elif isinstance(found, str):
        assert len(found) <= 11_000
    elif isinstance(found, Mapping):
        for each in found.values():
            bounded(each)
    elif isinstance(found, list | tuple | frozenset | set):
        assert len(found) <= 64
        for each in found:
            bounded(each)
    elif dataclasses.is_dataclass(found):
        for field in dataclasses.fields(found):
            bounded(getattr(found, field.name))


@pytest.mark.parametrize("name", [field.name for field in dataclasses.fields(TrainingConfig)])
def test_a_launch_takes_settings_in_their_ranges_and_nothing_else(name: str) -> None:
    # S12: what a page or a command asks for is this record, so that no text of it can become a command or a file.
    wrong: tuple[object, ...] = (
        *VALUES,
        None,
        [],
        {},
        1.5,
        -1,
        -(2**63),
        2**63,
        10**300,
        float("nan"),
        float("inf"),
        True,
        b"x",
        ["x"],
        {"x": 1},
    )
    for value in wrong:
        try:
            config = TrainingConfig.from_json({name: value})
        except UsageError as error:
            assert len(str(error)) < 11_000
        else:
            assert type(getattr(config, name)) in (str, bool, int)
            assert config.name.isprintable() and len(config.name) <= 200
            assert 1 <= config.missiles <= 64 and 0 <= config.seed < 2**31


@pytest.mark.parametrize("key", ["command", "argv", "env", "__class__", "hyperparameters", "out", ""])
def test_a_launch_takes_no_other_key(key: str) -> None:
    with pytest.raises(UsageError, match="unknown key"):
        TrainingConfig.from_json({key: "x"})


def test_seeds_and_branches_are_bounded() -> None:
    for value in VALUES:
        for read in (parse_seeds, partial(read_branch, policies=POLICIES, max_steps=1200)):
            try:
                found = read(value)
            except SubMasError as error:
                assert "\n" not in str(error) or "\n" in value
            else:
                assert not isinstance(found, list) or len(found) <= 1000


def test_policies_by_name_open_no_other_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    store = RunStore(tmp_path / "runs")
    for value in VALUES:
        if value == "random":
            continue
        for spec in (value, value + ".safetensors"):
            with pytest.raises(SubMasError):
                resolve_policy(spec, store)
    assert list(tmp_path.iterdir()) == []


def test_a_search_works_nothing_out(tmp_path: Path) -> None:
    # S13: what is typed is found as it is typed, or not.
    store = RunStore(tmp_path)
    for name in ("plain", "50% off", "a_b"):
        store.create(TrainingConfig(profile="smoke", missiles=1, name=name))
    index = RunIndex(tmp_path)
    index.look()
    for value in VALUES:
        text = value.encode("utf-8", "replace").decode()
        found = index.find(RunSearch(text=text))
        assert len(found) <= 3
    assert [len(index.find(RunSearch(text=text))) for text in ("50%", "%", "_", "a_b", "' OR '1'='1")] == [
        1,
        1,
        1,
        1,
        0,
    ]
    assert index.count(RunSearch()) == 3
