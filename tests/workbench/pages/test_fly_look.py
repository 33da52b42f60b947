"""How the Fly page is looked at: in its address, read, checked, written again."""

from __future__ import annotations

import pytest

from workbench.pages.fly_look import USUAL, FlyLook, frame_values, read_look


def test_the_usual_look_leaves_the_address_empty() -> None:
    assert not any(FlyLook().to_query().values())
    assert read_look({}) == (FlyLook(), [])


def test_what_is_written_is_read_again() -> None:
    look = FlyLook(
        camera="free", eye=(1.0, -2.5, 30.0, 0.0, 0.0, 8.0), drawn=(USUAL - {"labels", "readouts"}) | {"energy"},
        one_field=True, over=True, whole=True, tab="control", speed=1,
    )  # fmt: skip
    assert read_look(look.to_query()) == (look, [])
    assert look.additions.energy
    assert not look.additions.labels
    assert "readouts" not in frame_values(look)["drawn"]


def test_only_a_free_camera_has_a_place_of_its_own() -> None:
    assert read_look({"camera": "top", "eye": "1,2,3,4,5,6"})[0].eye == ()


@pytest.mark.parametrize(
    ("name", "value", "word"),
    [
        ("camera", "<script>", "'<script>'"),
        ("curves", "both", "side, over"),
        ("span", "x", "missiles, whole"),
        ("tab", "secrets", "azimuth"),
        ("speed", "1e9", "1, 10, 30, 60"),
        ("hide", "labels,walls", "'walls' to hide"),
        ("show", "x" * 500, "to show"),
    ],
)
def test_a_wrong_value_is_one_sentence_and_the_rest_is_kept(name: str, value: str, word: str) -> None:
    look, problems = read_look({"field": "one", name: value})
    assert look.one_field
    assert len(problems) == 1
    assert word in problems[0]
    assert len(problems[0]) < 200


@pytest.mark.parametrize("eye", ["1,2,3", "a,b,c,d,e,f", "nan,0,0,0,0,0", "1e9,0,0,0,0,0"])
def test_a_camera_is_never_sent_nowhere(eye: str) -> None:
    look, problems = read_look({"camera": "free", "eye": eye})
    assert look.eye == ()
    assert "six numbers" in problems[0]
