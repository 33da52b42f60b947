"""A run trained by the fake learner within the test's own process, so that its disk can be made to fail."""

from __future__ import annotations

import contextlib
import dataclasses
import json
from typing import Any

from tests.reliability.fake_training import learn
from workbench.recorder import RunRecorder
from workbench.run_files import RunFileError
from workbench.runs import Run, RunStore

Rows = list[dict[str, Any]]
STAMPS = ("time", "wall_s")


def train(run: Run, store: RunStore) -> None:
    """What a training process does, from its start or from its last checkpoint."""
    recorder = RunRecorder(run, dataclasses.replace(run.state, state="running", error=""))
    run.write_state(recorder.state)
    try:
        learn(run, store, recorder, recorder.resume())
    except (RunFileError, OSError) as error:
        with contextlib.suppress(RunFileError):
            recorder.end("failed", str(error))
        raise
    recorder.end("finished")


def revive(run: Run) -> None:
    """As the launcher does before a resume; whatever the run died of, its state must be readable."""
    state = run.state
    run.write_state(dataclasses.replace(state, state="running", resumes=state.resumes + 1))


def metrics(run: Run) -> Rows:
    """Rows of metrics without times."""
    return [{name: value for name, value in row.items() if name not in STAMPS} for row in run.metrics()]


def events(run: Run) -> Rows:
    """Events without times, and without those that say that the run was resumed."""
    told = [{name: value for name, value in event.items() if name not in STAMPS} for event in run.events()]
    return [event for event in told if event["kind"] != "resumed"]


def files(run: Run) -> list[str]:
    """Every file of a run."""
    return sorted(str(path.relative_to(run.path)) for path in run.path.rglob("*") if path.is_file())


def content(run: Run) -> str:
    """The state that stays, as text."""
    state = run.state.to_json()
    return json.dumps({name: state[name] for name in ("state", "progress", "best_success_rate", "stage", "error")})
