"""Tasks and masks: names, containment, and what a person may type."""

from __future__ import annotations

import pytest

from sim.errors import MaskError, ScenarioError
from sim.scenario_file import load_scenario
from sim.task import Task, parse_mask, task_for
from tests.engagements import DRILL, MASKS, changed, task


@pytest.mark.parametrize(
    ("masked", "name"),
    [
        ((), "target"),
        ((4,), "source-1"),
        ((3, 4), "source-2"),
        ((2, 3, 4), "source-3"),
        ((1, 2, 3, 4), "source-4"),
        ((1,), "missiles-2-3-4"),
        ((1, 3), "missiles-2-4"),
        ((1, 2, 3), "missiles-4"),
    ],
)
def test_names(masked: tuple[int, ...], name: str) -> None:
    assert task(*masked).name == name


def test_all_sixteen_tasks_have_different_names() -> None:
    assert len({Task(DRILL, masked).name for masked in MASKS}) == 16


@pytest.mark.parametrize(
    ("text", "masked"),
    [("", set()), ("1", {1}), ("1,2", {1, 2}), (" 2 , 4 ", {2, 4}), ("4,4", {4}), ("4,2,3", {2, 3, 4}), ("1,", {1})],
)
def test_masks_that_a_person_types(text: str, masked: set[int]) -> None:
    assert parse_mask(text, 4) == masked


@pytest.mark.parametrize("text", ["a", "1 2", "1;2", "1.5", "one", "0x1", "1-3", "--mask"])
def test_a_mask_that_is_no_list_of_numbers(text: str) -> None:
    with pytest.raises(MaskError) as error:
        parse_mask(text, 4)
    assert str(error.value) == f"mask '{text}' is not a list of missiles; write numbers from 1 to 4, as in 1,2"


@pytest.mark.parametrize(("text", "named"), [("5", "5"), ("0", "0"), ("-1", "-1"), ("9,1,7", "7, 9")])
def test_a_mask_that_names_missiles_there_are_not(text: str, named: str) -> None:
    with pytest.raises(MaskError) as error:
        parse_mask(text, 4)
    assert str(error.value) == f"mask names missile {named}; legal are 1 to 4"


def test_legal_missiles_are_those_of_the_scenario() -> None:
    assert parse_mask("6", 6) == {6}
    with pytest.raises(MaskError, match="legal are 1 to 2"):
        Task(changed(launch={"missiles": 2}), frozenset({3}))


def test_containment_is_a_partial_order_over_masks() -> None:
    tasks = [Task(DRILL, masked) for masked in MASKS]
    for a in tasks:
        assert a.contains(a)
        for b in tasks:
            assert a.contains(b) == (set(b.missiles) <= set(a.missiles))


def test_tasks_of_different_scenarios_contain_nothing_of_each_other() -> None:
    assert not task().contains(task(4, scenario=changed(missile={"fuse_m": 5.0})))


def test_masking_more_keeps_what_was_masked() -> None:
    assert task(4).mask([2]).masked == {2, 4}
    assert task(4).mask([4]) == task(4)


def test_masking_a_missile_that_is_not_there_is_refused() -> None:
    with pytest.raises(MaskError, match="mask names missile 7; legal are 1 to 4"):
        task().mask([7])


def test_task_for_reads_scenario_and_mask() -> None:
    assert task_for("default", "3,4") == Task(load_scenario("default"), frozenset({3, 4}))


def test_task_for_an_unknown_scenario() -> None:
    with pytest.raises(ScenarioError, match="no scenario 'nowhere'"):
        task_for("nowhere")


def test_tasks_are_values() -> None:
    assert len({task(4), task().mask([4]), task(3)}) == 2
