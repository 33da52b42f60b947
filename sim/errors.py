"""Errors that a user may cause: each says in one sentence what is wrong, with which value, and what would be legal."""

from __future__ import annotations


def shorten(text: str, limit: int = 60) -> str:
    """Foreign text cut to a length that fits in a sentence."""
    return text if len(text) <= limit else text[: limit - 1] + "…"


class SubMasError(Exception):
    """Base of every error that is shown to a person as one sentence, without a traceback."""

    exit_code = 1


class UsageError(SubMasError):
    """The request itself is wrong: a mask, a name, a scenario value."""

    exit_code = 2


class ScenarioError(UsageError):
    """A scenario file is missing, damaged, or holds an unknown key or an impossible value."""


class MaskError(UsageError):
    """A subtask mask names a missile that the scenario does not have."""


class ActionError(UsageError):
    """An action is not a finite number."""
