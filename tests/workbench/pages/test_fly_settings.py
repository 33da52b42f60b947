"""The address of the Fly page: read, checked, written again."""

from __future__ import annotations

import pytest

from sim.scenario_file import scenario_names
from workbench.pages.fly_settings import SEED_MAX, FlySettings, default_settings, read_settings

POLICIES = ["submas-target", "expert-navigation", "expert-dragging"]
DEFAULTS = default_settings(POLICIES)


def _read(**query: str) -> tuple[FlySettings, list[str]]:
    return read_settings(query, POLICIES, scenario_names(), DEFAULTS)


def test_the_trained_policy_flies_beside_the_dragging_expert() -> None:
    assert (DEFAULTS.a, DEFAULTS.b) == ("submas-target", "expert-dragging")


def test_without_trained_policies_navigation_flies() -> None:
    assert default_settings(["expert-navigation", "expert-dragging"]).a == "expert-navigation"


def test_what_is_written_is_read_again() -> None:
    settings = FlySettings("expert-navigation", "submas-target", frozenset({2, 5}), 17, 123.5, "six-missiles")
    assert _read(**settings.to_query()) == (settings, [])


def test_an_empty_address_has_no_problems() -> None:
    assert _read() == (DEFAULTS, [])


@pytest.mark.parametrize(
    ("name", "value", "word"),
    [
        ("a", "<script>", "'<script>'"),
        ("b", "/etc/passwd", "'/etc/passwd'"),
        ("scenario", "nowhere", "Scenario 'nowhere' is not known here"),
        ("scenario", "assets/scenarios/default.toml", "so default is taken"),
        ("mask", "1,9", "1 to 4"),
        ("mask", "x", "missiles from 1"),
        ("seed", "-1", "whole number"),
        ("seed", "1e3", "whole number"),
        ("seed", "²", "whole number"),
        ("seed", str(SEED_MAX + 1), "whole number"),
        ("t", "nan", "seconds"),
        ("t", "-5", "seconds"),
        ("t", "inf", "seconds"),
        ("t", "soon", "seconds"),
    ],
)
def test_a_wrong_value_becomes_one_sentence_and_the_default(name: str, value: str, word: str) -> None:
    settings, problems = _read(**{name: value})
    assert settings == DEFAULTS
    assert len(problems) == 1
    assert word in problems[0]
    assert problems[0].endswith(".")


def test_a_mask_is_checked_against_the_missiles_of_its_scenario() -> None:
    settings, problems = _read(scenario="six-missiles", mask="5,6")
    assert settings.masked == {5, 6}
    assert problems == []
    assert "missiles from 1 to 2" in _read(scenario="short-range", mask="3")[1][0]


def test_long_nonsense_is_cut() -> None:
    _settings, problems = _read(a="x" * 5000)
    assert len(problems[0]) < 200


def test_several_wrong_values_are_all_named_and_the_good_ones_kept() -> None:
    settings, problems = _read(a="nobody", mask="3", seed="no")
    assert settings.masked == {3}
    assert len(problems) == 2
