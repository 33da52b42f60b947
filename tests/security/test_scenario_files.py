"""S9, S11, S13: a scenario file is exactly a scenario or one sentence, and is cheap to refuse."""

from __future__ import annotations

import os
import random
import time
import tomllib
import tracemalloc
from pathlib import Path

import pytest

from sim.assets import asset_path
from sim.errors import ScenarioError
from sim.scenario_file import SIZE_LIMIT, load_scenario, parse_scenario
from workbench import cli

GOOD = asset_path("scenarios", "default.toml").read_text()
FUZZ = int(os.environ.get("FUZZ", "400"))
MEMORY_LIMIT_BYTES = 50_000_000
TIME_LIMIT_S = 10.0
"""Generous, as machines differ: what is meant is that nothing takes for ever."""


def replaced(line_start: str, line: str) -> str:
    """The default scenario with the first line that begins so replaced."""
    lines = GOOD.splitlines()
    at = next(number for number, each in enumerate(lines) if each.startswith(line_start))
    return "\n".join([*lines[:at], line, *lines[at + 1 :]])


HOSTILE: dict[str, str | bytes] = {
    "nothing": "",
    "a program": "#!/bin/sh\nrm -rf /\n",
    "no text": b"\xff\xfe\x00" * 30,
    "zero bytes": b"\x00" * 1000,
    "nested lists": "a = " + "[" * 50_000,
    "closed nested lists": "a = " + "[" * 20_000 + "]" * 20_000,
    "nested tables": "a" + ".a" * 15_000 + " = 1",
    "nested tables on many lines": "".join("a" + ".a" * 590 + f".b{line} = 1\n" for line in range(26)),
    "nested tables of many names": "".join(f"{chr(97 + line)}" + ".a" * 590 + " = 1\n" for line in range(26)),
    "inline tables": "a = " + "{a = " * 10_000 + "1" + "}" * 10_000,
    "many digits": replaced("length_m", "length_m = " + "9" * 10_000),
    "a large number": replaced("length_m", "length_m = 1e308"),
    "a number beyond all": replaced("length_m", "length_m = 1e999"),
    "infinity": replaced("length_m", "length_m = inf"),
    "NaN": replaced("length_m", "length_m = nan"),
    "a negative size": replaced("length_m", "length_m = -1.0"),
    "a true": replaced("length_m", "length_m = true"),
    "a date": replaced("length_m", "length_m = 1979-05-27"),
    "a text": replaced("length_m", "length_m = \"__import__('os').system('x')\""),
    "a list of lists": replaced("length_m", "length_m = [" + "[1]," * 5000 + "]"),
    "missiles without end": replaced("missiles", "missiles = 1000000000"),
    "a key twice": GOOD.replace("[battlefield]\n", "[battlefield]\nlength_m = 1.0\n", 1),
    "an unknown key": GOOD + "\n[evil]\nrun = 'x'\n",
    "a long key": GOOD + "\n[" + "k" * 10_000 + "]\n",
    "many keys": GOOD + "".join(f"\nkey{number} = 1" for number in range(2000)),
    "a name that steers": replaced("name", r'name = "\u001b]0;title\u0007"'),
    "a name turned round": replaced("name", r'name = "a\u202eb"'),
    "a name of two lines": replaced("name", r'name = "a\nb"'),
    "a long name": replaced("name", f'name = "{"x" * 101}"'),
    "a long description": replaced("description", f'description = "{"x" * 1001}"'),
    "too large": GOOD + "#" * SIZE_LIMIT,
}


@pytest.mark.parametrize("name", HOSTILE)
def test_a_hostile_file_is_one_sentence(name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, content = tmp_path / "hostile.toml", HOSTILE[name]
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    tracemalloc.start()
    began_s = time.monotonic()
    try:
        with pytest.raises(ScenarioError) as caught:
            load_scenario(str(path))
        assert tracemalloc.get_traced_memory()[1] < MEMORY_LIMIT_BYTES
    finally:
        tracemalloc.stop()
    assert time.monotonic() - began_s < TIME_LIMIT_S
    assert len(str(caught.value)) < 2 * len(str(path)) + 500
    assert cli.main(["fly", "random", "--scenario", str(path)]) == 2
    told = capsys.readouterr()
    assert told.out == "" and told.err.count("\n") == 1 and str(path) in told.err


@pytest.mark.parametrize("word", ["nan", "inf", "-inf", "true", '"1"'])
def test_no_number_of_a_scenario_may_be_anything_but_a_number(word: str) -> None:
    # One by one: what compares several numbers would refuse some of them by chance.
    sections = tomllib.loads(GOOD)
    value = tomllib.loads(f"value = {word}")["value"]
    numbers = [(name, key) for name, table in sections.items() if isinstance(table, dict) for key in table]
    assert len(numbers) > 50
    for name, key in numbers:
        wrong = {**sections, name: {**sections[name], key: value}}
        with pytest.raises(ScenarioError, match=rf"^somewhere: {name}\.{key} is .*; legal is a "):
            parse_scenario(wrong, "somewhere")


@pytest.mark.parametrize(
    "name",
    ["../../etc/passwd", "/etc/passwd", "..", "", "default/../default", "x" * 5000 + ".toml", "a\x00.toml",
     "\udc80.toml", "~root/x.toml", "CON", "*", "default.toml\n"],
    ids=repr,
)  # fmt: skip
def test_a_name_opens_no_other_file(name: str) -> None:
    with pytest.raises(ScenarioError):
        load_scenario(name)


@pytest.mark.parametrize("kind", ["folder", "pipe", "device", "unreadable"])
def test_what_is_no_plain_file_is_one_sentence_and_nobody_waits(kind: str, tmp_path: Path) -> None:
    path = tmp_path / "odd.toml"
    if kind == "folder":
        path.mkdir()
    elif kind == "pipe":
        os.mkfifo(path)
    elif kind == "device":
        path.symlink_to("/dev/zero")
    else:
        path.write_text(GOOD)
        path.chmod(0)
        if os.access(path, os.R_OK):
            pytest.skip("the superuser reads everything")
    with pytest.raises(ScenarioError, match=r"odd\.toml"):
        load_scenario(str(path))


def mutated(chance: random.Random) -> str:
    """The default scenario with a few lines changed, doubled, dropped or joined."""
    lines = GOOD.splitlines()
    for _ in range(chance.choice((1, 1, 2, 5))):
        place = chance.randrange(len(lines))
        kind = chance.randrange(4)
        if kind == 0:
            key = lines[place].partition("=")[0]
            values = ("-1", "1e999", "nan", '"x"', "[]", "{}", "true", "0", "1e-320", "99999999999999999999", "'''", "")
            lines[place] = f"{key}= {chance.choice(values)}"
        elif kind == 1:
            lines.pop(place)
        elif kind == 2:
            lines.insert(place, chance.choice(lines))
        else:
            at = chance.randrange(len(lines[place]) + 1)
            lines[place] = lines[place][:at] + chance.choice("\x00\x1b\u202e\"'[]{}=.#\\\n0") + lines[place][at:]
    return "\n".join(lines)


def test_mutations_are_scenarios_or_one_sentence(tmp_path: Path) -> None:
    path, chance = tmp_path / "fuzz.toml", random.Random(f"scenarios {FUZZ}")
    refused = 0
    for _ in range(FUZZ):
        path.write_text(mutated(chance))
        try:
            scenario = load_scenario(str(path))
        except ScenarioError:
            refused += 1
        else:
            assert scenario.name.isprintable() and scenario.battlefield.length_m > 0.0
    assert FUZZ / 2 < refused < FUZZ


@pytest.mark.parametrize("table", [{}, {"name": 1}, {"name": {}, "description": [[]]}], ids=repr)
def test_tables_that_are_none(table: dict[str, object]) -> None:
    with pytest.raises(ScenarioError):
        parse_scenario(table, "somewhere")
