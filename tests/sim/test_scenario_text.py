"""Scenarios as text: what is written reads back as the same scenario, whatever its numbers and its name."""

from __future__ import annotations

import dataclasses
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from sim.errors import ScenarioError
from sim.scenario import Scenario
from sim.scenario_file import OPTIONAL, SECTIONS, load_scenario, parse_scenario, scenario_text
from tests.engagements import DRILL, changed

NAMES = [
    '"quoted"', "back\\slash \\n", "two\nlines\r\n", "\t\x00\x1b[31m\x7f\x85\u2028", "Δψ 導弾 🛩", "",
    "'" * 3, '"' * 3, "# no",
]  # fmt: skip


def test_the_shipped_default_survives_its_own_text() -> None:
    assert read_back(load_scenario()) == load_scenario()


@pytest.mark.parametrize("seed", range(100))
def test_every_legal_scenario_survives_being_written(seed: int) -> None:
    scenario = random_scenario(np.random.default_rng(seed))
    again = read_back(scenario)
    assert again == scenario
    assert again.digest == scenario.digest


@pytest.mark.parametrize("text", NAMES)
def test_any_name_survives_being_written_and_only_a_printable_line_is_read(text: str) -> None:
    named = dataclasses.replace(DRILL, name=text, description=text + text)
    assert tomllib.loads(scenario_text(named))["name"] == text
    if text.isprintable():
        again = read_back(named)
        assert (again.name, again.description) == (text, text + text)
    else:
        with pytest.raises(ScenarioError, match="name must be one line of at most 100 printable characters"):
            read_back(named)


def test_what_is_off_is_not_written_and_what_is_on_is() -> None:
    assert not re.search(r"^\[(variation|sensor)\]", scenario_text(DRILL), re.MULTILINE)
    text = scenario_text(changed(sensor={"drop_out": 0.25}))
    assert "[variation]" not in text
    assert "[sensor]\n" in text
    assert "drop_out = 0.25\n" in text


def test_sections_are_written_in_their_order() -> None:
    written = [line[1:-1] for line in scenario_text(DRILL).splitlines() if line.startswith("[")]
    assert written == [section for section in SECTIONS if section not in OPTIONAL]


def test_numbers_of_numpy_are_written_as_plain_ones() -> None:
    text = scenario_text(changed(missile={"fuse_m": np.float64(12.5)}, launch={"missiles": np.int64(3)}))
    assert "fuse_m = 12.5\n" in text
    assert "missiles = 3\n" in text


def test_a_name_that_no_file_can_hold() -> None:
    with pytest.raises(ScenarioError, match=r"'a\\udcff' cannot be written to a scenario file"):
        scenario_text(dataclasses.replace(DRILL, name="a\udcff"))


def read_back(scenario: Scenario) -> Scenario:
    """What a file with the scenario's text is read as."""
    return parse_scenario(tomllib.loads(scenario_text(scenario)), "text")


def random_scenario(draws: np.random.Generator) -> Scenario:
    """A legal scenario with every number drawn from its whole range; in half of them what may be off is off."""
    sections = [name for name in SECTIONS if name not in OPTIONAL or draws.random() < 0.5]
    values = {
        name: {field.name: random_number(draws, field) for field in dataclasses.fields(SECTIONS[name])}
        for name in sections
    }
    field, start, missile = values["battlefield"], values["start"], values["missile"]
    # What numbers must be to each other: inside the field, in order, less than the whole.
    field["exit_half_width_m"] = min(field["exit_half_width_m"], field["width_m"] / 2)
    field["exit_y_m"] = (field["width_m"] / 2 - field["exit_half_width_m"]) * float(draws.uniform(-0.99, 0.99))
    start["evader_x_low_m"], start["evader_x_high_m"] = sorted(draws.uniform(-0.5, 0.499, 2) * field["length_m"])
    between = sorted((start["interceptor_x_low_m"], start["interceptor_x_high_m"]))
    start["interceptor_x_low_m"], start["interceptor_x_high_m"] = between
    start["y_spread_m"] = min(start["y_spread_m"], field["width_m"] / 2)
    start["altitude_spread_m"] = min(start["altitude_spread_m"], 0.9 * start["altitude_m"])
    missile["propellant_kg"] = min(missile["propellant_kg"], 0.9 * missile["mass_kg"])
    missile["arm_s"] = max(missile["arm_s"], values["rules"]["step_s"])
    return parse_scenario({"name": "any", "description": "drawn", **values}, "drawn")


def random_number(draws: np.random.Generator, field: dataclasses.Field) -> float | int:
    """A number between a field's bounds, in one of eight cases a bound itself."""
    low, high = field.metadata["low"], field.metadata["high"]
    if field.type == "int":
        return int(draws.integers(low, high, endpoint=True))
    return float(draws.choice([low, high]) if draws.random() < 1 / 8 else draws.uniform(low, high))


def test_the_example_of_the_manual_writes_a_scenario(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    manual = (Path(__file__).parents[2] / "docs/calibration.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"^```python\n(.*?)^```", manual, re.MULTILINE | re.DOTALL)
    monkeypatch.chdir(tmp_path)
    exec(compile(example, "docs/calibration.md", "exec"), {})
    slow = changed(load_scenario(), missile={"thrust_n": 9000.0})
    assert load_scenario("slow.toml") == dataclasses.replace(slow, name="slow")
