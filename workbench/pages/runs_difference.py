"""The difference of configurations: everything that was asked of each run, and the hyperparameters it stands for."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from typing import Any

from layouts.run_difference import MISSING, difference_table
from sim.errors import SubMasError
from workbench.run_files import RunFileError, read_json
from workbench.runs import Run

FROM_THE_CARD = ("scenario_digest", "code_version", "features_digest", "layout_digest")
"""What a policy's card says about how it came to be."""


def difference(runs: Sequence[tuple[Run, str, str]], every_field: bool) -> str:
    """HTML of the configurations of runs, given with their title and ink."""
    described = [fields_of(run) for run, _title, _ink in runs]
    names = dict.fromkeys(name for fields in described for name in fields)
    fields = {name: [each.get(name, MISSING) for each in described] for name in names}
    return difference_table([(title, ink) for _run, title, ink in runs], fields, every_field)


def fields_of(run: Run) -> dict[str, str]:
    """Every field of a run's configuration by name, as text; what is wrong with it where it cannot be read."""
    try:
        config = run.config
    except RunFileError as error:
        return {"problem": str(error)}
    fields = {name: _text(value) for name, value in config.to_json().items()}
    try:
        numbers = dataclasses.asdict(config.hyperparameters)
    except SubMasError as error:
        numbers = {"hyperparameters": str(error)}
    return fields | {name: _text(value) for name, value in numbers.items()} | _card(run)


def _card(run: Run) -> dict[str, str]:
    try:
        card = read_json(run.path / "policy.json")
    except RunFileError:
        return {}
    return {name: _text(card[name]) for name in FROM_THE_CARD if name in card}


def _text(value: Any) -> str:
    if isinstance(value, list | tuple):
        return ", ".join(map(str, value))
    return MISSING if value in ("", None) else str(value)
