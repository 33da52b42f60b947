"""Scenario files: what is refused, in which words; what is read."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import pytest

from sim.assets import asset_path
from sim.errors import ScenarioError
from sim.scenario_file import OPTIONAL, SECTIONS, load_scenario, parse_scenario, scenario_names
from tests.engagements import DRILL

NUMBERS = [(section, field) for section, cls in SECTIONS.items() for field in dataclasses.fields(cls)]


def table() -> dict[str, Any]:
    """The drill as a scenario file holds it."""
    return dataclasses.asdict(DRILL)


def refusal(changes: dict[str, Any]) -> str:
    """The sentence with which the drill is refused once `section.key` is set to a value."""
    values = table()
    for path, value in changes.items():
        section, _, key = path.partition(".")
        if key:
            values[section][key] = value
        else:
            values[section] = value
    with pytest.raises(ScenarioError) as error:
        parse_scenario(values, "drill.toml")
    return str(error.value)


def test_the_drill_itself_is_legal() -> None:
    assert parse_scenario(table(), "drill.toml") == DRILL


@pytest.mark.parametrize(
    ("path", "value", "sentence"),
    [
        ("missile.fuse_m", 0.4, "drill.toml: missile.fuse_m is 0.4; legal is a number from 0.5 to 1000"),
        ("missile.fuse_m", 1001, "drill.toml: missile.fuse_m is 1001; legal is a number from 0.5 to 1000"),
        ("missile.fuse_m", math.nan, "drill.toml: missile.fuse_m is nan; legal is a number from 0.5 to 1000"),
        ("missile.fuse_m", math.inf, "drill.toml: missile.fuse_m is inf; legal is a number from 0.5 to 1000"),
        ("missile.fuse_m", -math.inf, "drill.toml: missile.fuse_m is -inf; legal is a number from 0.5 to 1000"),
        ("missile.fuse_m", 10**400, f"drill.toml: missile.fuse_m is 1{'0' * 58}…; legal is a number from 0.5 to 1000"),
        ("missile.fuse_m", True, "drill.toml: missile.fuse_m is True; legal is a number from 0.5 to 1000"),
        ("missile.fuse_m", "12", "drill.toml: missile.fuse_m is '12'; legal is a number from 0.5 to 1000"),
        ("missile.fuse_m", [12], "drill.toml: missile.fuse_m is [12]; legal is a number from 0.5 to 1000"),
        ("launch.missiles", 2.5, "drill.toml: launch.missiles is 2.5; legal is a whole number from 1 to 8"),
        ("launch.missiles", 0, "drill.toml: launch.missiles is 0; legal is a whole number from 1 to 8"),
        ("launch.missiles", 9, "drill.toml: launch.missiles is 9; legal is a whole number from 1 to 8"),
        ("launch.missiles", True, "drill.toml: launch.missiles is True; legal is a whole number from 1 to 8"),
        ("rules.substeps", 20.0, "drill.toml: rules.substeps is 20.0; legal is a whole number from 1 to 1000"),
        ("rules", 3, "drill.toml: rules must be a table, not 3"),
        ("name", 3, "drill.toml: name must be text, not 3"),
        ("description", None, "drill.toml: description must be text, not None"),
        ("weather", {}, "drill.toml: unknown key 'weather'; legal are battlefield, description, evader, interceptor, "
         "launch, missile, name, reward, rules, sensor, start, variation"),
        ("rules.wind_m_s", 3.0, "drill.toml: rules: unknown key 'wind_m_s'; legal are max_steps, outside_steps, "
         "step_s, substeps"),
    ],
)  # fmt: skip
def test_a_wrong_value_is_named_with_what_is_legal(path: str, value: Any, sentence: str) -> None:
    assert refusal({path: value}) == sentence


@pytest.mark.parametrize(("section", "field"), NUMBERS, ids=lambda part: getattr(part, "name", part))
def test_every_number_is_checked_against_its_range(section: str, field: dataclasses.Field) -> None:
    # Nobody may add a number that can be infinite, missing or of the wrong kind.
    path, low, high = f"{section}.{field.name}", field.metadata["low"], field.metadata["high"]
    assert low < high
    step = 1 if field.type == "int" else (high - low) / 10
    for wrong in (low - step, high + step, math.nan, math.inf, True, "1", None):
        assert refusal({path: wrong}).startswith(f"drill.toml: {path} is ")
    if section in OPTIONAL:
        return
    values = table()
    del values[section][field.name]
    with pytest.raises(ScenarioError) as error:
        parse_scenario(values, "drill.toml")
    assert str(error.value) == f"drill.toml: {section}: key '{field.name}' is missing"


@pytest.mark.parametrize("section", sorted(OPTIONAL))
def test_what_may_be_left_out_is_off_and_leaves_the_digest_alone(section: str) -> None:
    plain, off, on = table(), table(), table()
    fields = [field.name for field in dataclasses.fields(SECTIONS[section])]
    del plain[section]
    off[section] = dict.fromkeys(fields, 0.0)
    on[section] = {fields[0]: 0.1}
    digests = [parse_scenario(values, "drill.toml").digest for values in (plain, off, on)]
    assert digests[0] == digests[1] != digests[2]


def test_an_edited_file_is_read_anew(tmp_path: Path) -> None:
    path = tmp_path / "mine.toml"
    text = asset_path("scenarios", "default.toml").read_text(encoding="utf-8")
    path.write_text(text, encoding="utf-8")
    before = load_scenario(str(path))
    path.write_text(text.replace("interval_s = 20.0", "interval_s = 25.0"), encoding="utf-8")
    assert (before.launch.interval_s, load_scenario(str(path)).launch.interval_s) == (20.0, 25.0)


@pytest.mark.parametrize("section", [*sorted(set(SECTIONS) - OPTIONAL), "name", "description"])
def test_a_missing_section_is_named(section: str) -> None:
    values = table()
    del values[section]
    with pytest.raises(ScenarioError) as error:
        parse_scenario(values, "drill.toml")
    assert str(error.value) == f"drill.toml: key '{section}' is missing"


@pytest.mark.parametrize(
    ("changes", "sentence"),
    [
        ({"start.evader_x_low_m": -20e3}, "start.evader_x_low_m exceeds start.evader_x_high_m"),
        ({"start.interceptor_x_high_m": 1e3}, "start.interceptor_x_low_m exceeds interceptor_x_high_m"),
        ({"start.evader_x_low_m": -36e3}, "start.evader_x_low_m lies left of the battlefield"),
        ({"start.evader_x_high_m": 35e3}, "start.evader_x_high_m lies at or beyond the exit edge"),
        ({"start.y_spread_m": 25.1e3}, "start.y_spread_m exceeds half the battlefield's width"),
        ({"missile.propellant_kg": 160.0}, "missile.propellant_kg is not below missile.mass_kg"),
        ({"battlefield.exit_y_m": -21e3}, "the exit gate reaches beyond the right edge"),
        ({"battlefield.exit_half_width_m": 26e3}, "the exit gate reaches beyond the right edge"),
        ({"start.altitude_m": 1500.0}, "start.altitude_spread_m is not below start.altitude_m"),
    ],
)
def test_numbers_that_contradict_each_other(changes: dict[str, Any], sentence: str) -> None:
    assert refusal(changes) == f"drill.toml: {sentence}"


def test_a_file_that_is_not_toml(tmp_path: Path) -> None:
    path = tmp_path / "broken.toml"
    path.write_text("name = ")
    with pytest.raises(ScenarioError, match=r"scenario file .*broken\.toml is not TOML: Invalid value"):
        load_scenario(str(path))


def test_a_number_too_long_to_be_read(tmp_path: Path) -> None:
    # Python itself refuses whole numbers of more than 4300 digits; no line of a scenario is nearly as long.
    path = tmp_path / "long.toml"
    path.write_text("name = 1" + "0" * 5000)
    with pytest.raises(ScenarioError, match=r"long\.toml has a line longer than 1200 bytes"):
        load_scenario(str(path))


def test_a_file_that_is_not_text(tmp_path: Path) -> None:
    path = tmp_path / "binary.toml"
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(ScenarioError, match=r"binary\.toml is not TOML"):
        load_scenario(str(path))


@pytest.mark.parametrize("name", ["nowhere", "nowhere.toml", "", "default.toml/x"])
def test_a_scenario_that_does_not_exist_is_answered_with_those_that_do(name: str) -> None:
    with pytest.raises(ScenarioError) as error:
        load_scenario(name)
    offered = ", ".join(scenario_names())
    assert str(error.value) == f"no scenario '{name}'; there are {offered}, or a path to a .toml file"


def test_a_folder_is_no_scenario(tmp_path: Path) -> None:
    (tmp_path / "folder.toml").mkdir()
    with pytest.raises(ScenarioError, match="no scenario"):
        load_scenario(str(tmp_path / "folder.toml"))


def test_a_scenario_of_ones_own_is_read_from_its_path(tmp_path: Path) -> None:
    text = asset_path("scenarios", "default.toml").read_text().replace('name = "default"', 'name = "mine"')
    path = tmp_path / "mine.toml"
    path.write_text(text)
    assert load_scenario(str(path)).name == "mine"


@pytest.mark.parametrize("name", scenario_names())
def test_shipped_scenarios_are_legal_and_named_as_their_file(name: str) -> None:
    scenario = load_scenario(name)
    assert scenario.name == name
    assert len(scenario.description) > 20


@pytest.mark.parametrize("name", scenario_names())
def test_shipped_scenarios_keep_the_papers_rules(name: str) -> None:
    # §2.3: one step is one second, at most 1200; more than 10 steps outside is a loss; 400, 50, -400, -0.1.
    scenario = load_scenario(name)
    assert (scenario.rules.step_s, scenario.rules.max_steps, scenario.rules.outside_steps) == (1.0, 1200, 10)
    assert dataclasses.astuple(scenario.reward) == (400.0, 50.0, -400.0, -0.1)


def test_the_default_scenario_has_the_papers_four_missiles() -> None:
    assert load_scenario().launch.missiles == 4


@pytest.mark.parametrize("name", scenario_names())
def test_missiles_of_shipped_scenarios_arm_after_more_than_a_step(name: str) -> None:
    # Eq. (12): a missile that could hit in the step of its launch would pay while the observation shows it absent.
    scenario = load_scenario(name)
    assert scenario.missile.arm_s > scenario.rules.step_s
    assert scenario.missile.burn_s > scenario.rules.step_s


@pytest.mark.parametrize("name", scenario_names())
def test_every_number_of_a_shipped_scenario_says_where_it_comes_from(name: str) -> None:
    # The unit is in the key; a source, or the word "chosen" and why, stands beside the number or beside its section.
    bare, section = [], ""
    for line in asset_path("scenarios", f"{name}.toml").read_text().splitlines():
        if line.startswith("["):
            section = line
        elif "=" in line and not line.startswith(("#", "name", "description")) and "#" not in line + section:
            bare.append(line)
    assert not bare


def test_whole_numbers_are_read_as_metres_too() -> None:
    values = table() | {"battlefield": dataclasses.asdict(DRILL.battlefield) | {"length_m": 70_000}}
    length = parse_scenario(values, "drill.toml").battlefield.length_m
    assert isinstance(length, float)
    assert length == 70e3
