"""Scenarios: frozen, and identified by their numbers alone."""

from __future__ import annotations

import dataclasses

import pytest

from sim.scenario_file import SECTIONS
from tests.engagements import DRILL, changed

NUMBERS = [(section, field) for section, cls in SECTIONS.items() for field in dataclasses.fields(cls)]


def test_scenarios_cannot_be_changed() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        DRILL.missile.fuse_m = 1.0  # type: ignore[misc]


def test_the_digest_is_over_numbers_and_not_over_names() -> None:
    renamed = dataclasses.replace(DRILL, name="other", description="the same numbers")
    assert renamed.digest == DRILL.digest
    assert len(DRILL.digest) == 12


def test_the_digest_changes_with_every_single_number() -> None:
    digests = {DRILL.digest}
    for section, field in NUMBERS:
        value = getattr(getattr(DRILL, section), field.name)
        digests.add(changed(**{section: {field.name: value + (1 if field.type == "int" else 0.125)}}).digest)
    assert len(digests) == 1 + len(NUMBERS)
