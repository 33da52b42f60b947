"""Result sets on disk: small, comparable line by line, replaced whole, distrusted when read."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import pytest

from tests.workbench.reproduce.samples import made
from workbench.reproduce.protocol import ITEMS, Item
from workbench.reproduce.result_file import ResultSetError, load, save, to_text
from workbench.reproduce.stage_curves import points_per_curve


@pytest.mark.parametrize("item", ITEMS)
def test_what_is_written_is_read(item: Item, tmp_path: Path) -> None:
    result = made(item)
    assert save(result, tmp_path / "new" / "a.json")
    assert load(tmp_path / "new" / "a.json") == result


def test_how_often_a_training_was_resumed_is_written_and_read(tmp_path: Path) -> None:
    # R22: what a number rests on; trainings that nothing interrupted are written as before.
    result = made("table4", seeds=2)
    resumed = dataclasses.replace(result.trainings[0], resumes=3)
    result = dataclasses.replace(result, trainings=(resumed, *result.trainings[1:]))
    save(result, tmp_path / "a.json")
    assert load(tmp_path / "a.json") == result
    assert to_text(result).count('"resumes":3') == to_text(result).count('"resumes"') == 1
    assert '"resumes"' not in to_text(made("table4"))


@pytest.mark.parametrize("item", ["table4", "fig8", "fig9"])
def test_ten_seeds_make_a_small_file(item: Item) -> None:
    curves = {"table4": 0, "fig8": 200, "fig9": 40}[item]
    full = made(item, seeds=10, points=points_per_curve([300] * curves), success=lambda *_: 0.948)
    assert len(full.curves) == curves
    assert len(to_text(full).encode()) < 200_000


def test_another_number_is_another_line() -> None:
    one = made("table4")
    changed = dataclasses.replace(one.numbers[7], success_rate=0.97, success_ci95=(0.95, 0.98))
    other = dataclasses.replace(one, numbers=(*one.numbers[:7], changed, *one.numbers[8:]))
    lines = zip(to_text(one).splitlines(), to_text(other).splitlines(), strict=True)
    assert sum(a != b for a, b in lines) == 1


def test_an_equal_file_is_left_alone(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    assert save(made("fig9"), path)
    before = path.stat().st_mtime_ns
    assert not save(made("fig9"), path)
    assert path.stat().st_mtime_ns == before
    assert save(made("fig9", seeds=2), path)
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.json"]


def test_no_file_is_no_result(tmp_path: Path) -> None:
    assert load(tmp_path / "a.json") is None


def broken(change: str) -> str:
    values = json.loads(to_text(made("table4", seeds=2)))
    match change:
        case "schema":
            values["schema"] = 99
        case "item":
            values["item"] = "fig1"
        case "unknown key":
            values["numbers"][0]["more"] = 1
        case "missing key":
            del values["numbers"][0]["episodes"]
        case "no numbers":
            values["numbers"] = 3
        case "impossible":
            values["numbers"][0]["success_rate"] = 1.5
        case "a list":
            values = [values]
    return json.dumps(values)


@pytest.mark.parametrize(
    "change", ["schema", "item", "unknown key", "missing key", "no numbers", "impossible", "a list"]
)
def test_a_damaged_file_is_said_to_be(change: str, tmp_path: Path) -> None:
    path = tmp_path / "table4.json"
    path.write_text(broken(change))
    with pytest.raises(ResultSetError, match="damaged or of another version"):
        load(path)


def test_the_sound_file_is_read(tmp_path: Path) -> None:
    # The control of the test above: without a change nothing is wrong.
    path = tmp_path / "table4.json"
    path.write_text(broken("nothing"))
    assert load(path) == made("table4", seeds=2)


def test_half_a_file_and_a_huge_one_are_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "a.json"
    path.write_text(to_text(made("fig9"))[:500])
    with pytest.raises(ResultSetError, match="damaged"):
        load(path)
    monkeypatch.setattr("workbench.reproduce.result_file.SIZE_LIMIT", 100)
    with pytest.raises(ResultSetError, match="larger than"):
        load(path)


def test_a_folder_that_cannot_be_made_is_one_sentence(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(ResultSetError, match="cannot be made"):
        save(made("fig9"), tmp_path / "file" / "a.json")
