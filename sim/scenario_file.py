"""Scenario files: TOML tables read, checked key by key, and turned into a `Scenario`; and scenarios as such text."""

from __future__ import annotations

import dataclasses
import json
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

from sim.assets import asset_path
from sim.errors import ScenarioError, shorten
from sim.scenario import (
    Aircraft,
    Battlefield,
    Launch,
    Missile,
    Reward,
    Rules,
    Scenario,
    Sensor,
    Start,
    Variation,
)

SECTIONS: dict[str, type] = {
    "battlefield": Battlefield, "evader": Aircraft, "interceptor": Aircraft, "launch": Launch, "missile": Missile,
    "rules": Rules, "reward": Reward, "start": Start, "variation": Variation, "sensor": Sensor,
}  # fmt: skip
OPTIONAL = {"variation", "sensor"}
"""Sections a file may leave out, as it may leave out their keys: what is not said is off."""
SIZE_LIMIT = 32 * 1024
"""Largest scenario file that is read [bytes]."""
LINE_LIMIT = 1200
"""Longest line of one [bytes]: the time to read a key of dots grows with the square of their number."""
PATH_LIMIT = 200
"""Characters of a path that are repeated in a sentence."""
TEXT_LIMITS = {"name": 100, "description": 1000}
"""Longest texts of a scenario [characters]."""


def scenario_names() -> list[str]:
    """Names of the shipped scenarios, sorted."""
    return sorted(path.stem for path in asset_path("scenarios").glob("*.toml"))


def load_scenario(name: str = "default") -> Scenario:
    """The shipped scenario of that name, or the one in the file of that path.

    Raises:
        ScenarioError: no such scenario, or the file is damaged; names the key, the value and the legal range.
    """
    shown = shorten(name, PATH_LIMIT)
    path = Path(name) if name.endswith(".toml") else asset_path("scenarios", f"{name}.toml")
    try:
        if not path.is_file():
            raise FileNotFoundError
        with path.open("rb") as file:
            content = file.read(SIZE_LIMIT + 1)
    except FileNotFoundError:
        known = ", ".join(scenario_names())
        raise ScenarioError(f"no scenario '{shown}'; there are {known}, or a path to a .toml file") from None
    except (OSError, ValueError) as error:  # ValueError: a zero byte or half a surrogate pair in the name
        reason = getattr(error, "strerror", None) or error
        raise ScenarioError(f"scenario '{shown}' cannot be read: {reason}") from None
    if len(content) > SIZE_LIMIT:
        raise ScenarioError(f"scenario file {path} is larger than {SIZE_LIMIT // 1024} kB, no scenario is")
    if any(len(line) > LINE_LIMIT for line in content.splitlines()):
        raise ScenarioError(f"scenario file {path} has a line longer than {LINE_LIMIT} bytes, no scenario has")
    return _load(content, str(path))


@cache
def _load(content: bytes, origin: str) -> Scenario:
    # Kept by content, so that an edited file is read anew.
    try:
        table = tomllib.loads(content.decode())
    except (ValueError, RecursionError) as error:  # damaged TOML or UTF-8, numbers of thousands of digits, nests
        raise ScenarioError(f"scenario file {origin} is not TOML: {shorten(str(error), 200)}") from None
    return parse_scenario(table, origin)


def parse_scenario(table: dict[str, Any], origin: str) -> Scenario:
    """A scenario from nested tables as in a file; `origin` is named in errors.

    Raises:
        ScenarioError: a key is unknown or missing, or a value has the wrong type or lies outside its range.
    """
    _check_keys(table, {"name", "description", *SECTIONS}, origin, OPTIONAL)
    for key, limit in TEXT_LIMITS.items():
        if not isinstance(table[key], str):
            raise ScenarioError(f"{origin}: {key} must be text, not {_shown(table[key])}")
        if len(table[key]) > limit or not table[key].isprintable():
            raise ScenarioError(f"{origin}: {key} must be one line of at most {limit} printable characters")
    sections = {key: _section(SECTIONS[key], table[key], f"{origin}: {key}") for key in SECTIONS if key in table}
    scenario = Scenario(name=table["name"], description=table["description"], **sections)
    _check_relations(scenario, origin)
    return scenario


def scenario_text(scenario: Scenario) -> str:
    """The scenario as the text of a TOML file: `parse_scenario` of what it holds is equal to it.

    Raises:
        ScenarioError: name or description hold half a surrogate pair, which no file can hold.
    """
    parts = [f"name = {_quoted(scenario.name)}\ndescription = {_quoted(scenario.description)}\n"]
    for name in SECTIONS:
        section = getattr(scenario, name)
        if name in OPTIONAL and section == type(section)():
            continue
        lines = [_line(field, getattr(section, field.name)) for field in dataclasses.fields(section)]
        parts.append("".join([f"[{name}]\n", *lines]))
    return "\n".join(parts)


def _line(field: dataclasses.Field, value: float | int) -> str:
    # repr is the shortest text that reads back as the same number; NumPy's numbers would name their type in it.
    return f"{field.name} = {int(value) if field.type == 'int' else float(value)!r}\n"


def _quoted(text: str) -> str:
    try:
        text.encode()
    except UnicodeEncodeError:
        raise ScenarioError(f"{text!a} cannot be written to a scenario file; use Unicode characters only") from None
    # TOML reads JSON's strings, except that it wants the delete character escaped as well.
    return json.dumps(text, ensure_ascii=False).replace("\x7f", "\\u007f")


def _section(cls: type, table: Any, origin: str) -> Any:
    if not isinstance(table, dict):
        raise ScenarioError(f"{origin} must be a table, not {_shown(table)}")
    fields = {field.name: field for field in dataclasses.fields(cls)}
    optional = {name for name, field in fields.items() if field.default is not dataclasses.MISSING}
    _check_keys(table, set(fields), origin, optional)
    return cls(**{key: _number(value, fields[key], f"{origin}.{key}") for key, value in table.items()})


def _check_keys(table: dict[str, Any], legal: set[str], origin: str, optional: set[str]) -> None:
    unknown, missing = sorted(set(table) - legal), sorted(legal - set(table) - optional)
    if unknown:
        raise ScenarioError(f"{origin}: unknown key '{shorten(unknown[0])}'; legal are {', '.join(sorted(legal))}")
    if missing:
        raise ScenarioError(f"{origin}: key '{missing[0]}' is missing")


def _number(value: Any, field: dataclasses.Field, origin: str) -> float | int:
    low, high = field.metadata["low"], field.metadata["high"]
    whole = field.type == "int"
    legal = f"a {'whole ' if whole else ''}number from {low:g} to {high:g}"
    if isinstance(value, bool) or not isinstance(value, int if whole else (int, float)):
        raise ScenarioError(f"{origin} is {_shown(value)}; legal is {legal}")
    if not low <= value <= high:  # NaN lies in no range
        raise ScenarioError(f"{origin} is {_shown(value)}; legal is {legal}")
    return int(value) if whole else float(value)


def _shown(value: Any) -> str:
    """A wrong value as it is said: cut where it would fill a screen, its kind where it is too deep to be written."""
    try:
        return shorten(repr(value))
    except RecursionError:
        return f"a {type(value).__name__}"


def _check_relations(scenario: Scenario, origin: str) -> None:
    start, missile, field, rules = scenario.start, scenario.missile, scenario.battlefield, scenario.rules
    relations = (
        (start.evader_x_low_m <= start.evader_x_high_m, "start.evader_x_low_m exceeds start.evader_x_high_m"),
        (
            start.interceptor_x_low_m <= start.interceptor_x_high_m,
            "start.interceptor_x_low_m exceeds interceptor_x_high_m",
        ),
        (-field.length_m / 2 <= start.evader_x_low_m, "start.evader_x_low_m lies left of the battlefield"),
        (start.evader_x_high_m < field.length_m / 2, "start.evader_x_high_m lies at or beyond the exit edge"),
        (start.y_spread_m <= field.width_m / 2, "start.y_spread_m exceeds half the battlefield's width"),
        (missile.propellant_kg < missile.mass_kg, "missile.propellant_kg is not below missile.mass_kg"),
        (
            abs(field.exit_y_m) + field.exit_half_width_m <= field.width_m / 2,
            "the exit gate reaches beyond the right edge",
        ),
        (start.altitude_spread_m < start.altitude_m, "start.altitude_spread_m is not below start.altitude_m"),
        # Else a missile could be spent in the very step in which it was fired and never be seen, against Eq. (12).
        (missile.arm_s >= rules.step_s, "missile.arm_s is below rules.step_s"),
    )
    for holds, sentence in relations:
        if not holds:
            raise ScenarioError(f"{origin}: {sentence}")
