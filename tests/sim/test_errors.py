"""Errors for people carry the exit code that the command line promises."""

from __future__ import annotations

from sim.errors import MaskError, ScenarioError, SubMasError, UsageError


def test_a_failure_is_1_and_a_mistake_of_the_user_is_2() -> None:
    assert SubMasError.exit_code == 1
    assert {error.exit_code for error in (UsageError, ScenarioError, MaskError)} == {2}


def test_every_error_can_be_caught_as_one() -> None:
    assert all(issubclass(error, SubMasError) for error in (UsageError, ScenarioError, MaskError))
