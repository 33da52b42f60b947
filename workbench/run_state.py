"""How a run stands: the content of `state.json`."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

from workbench.run_files import RunFileError

STATES = ("queued", "running", "stalled", "paused", "stopped", "finished", "failed", "interrupted")
ACTIVE = ("queued", "running", "stalled")
RESUMABLE = ("paused", "stopped", "failed", "interrupted")
PATIENCE_S = 600.0
"""How long a training may take for its first epoch before it counts as stalled."""
TEXT_LIMIT = 2000


@dataclass(frozen=True)
class RunState:
    """Where a run is, what it reached, and why it ended."""

    state: str
    """One of STATES. Two are never written: a run whose process died is shown as "interrupted", one whose process lives
    and has given no sign for too long as "stalled"."""
    stage: int = 0
    """Stage being learned, from 0."""
    stages: int = 1
    """Number of stages of the whole run."""
    task: str = ""
    """Name of the stage's task, for example "source-3"."""
    progress: float = 0.0
    """Share of the whole run that is done, 0..1."""
    eta_s: float | None = None
    """Estimated time until the run ends [s]."""
    created: str = ""
    """When the run was asked for, ISO 8601."""
    started: str = ""
    """When its process began, ISO 8601."""
    updated: str = ""
    """When this state was written, ISO 8601."""
    wall_s: float = 0.0
    """Time the process has worked, by a monotonic clock [s]."""
    pid: int | None = None
    """Process that works on the run; means something only while the run's lock is held."""
    error: str = ""
    """Why the run failed, in one sentence."""
    best_success_rate: float | None = None
    """Best held-out success rate of the latest stage, 0..1."""
    resumes: int = 0
    """How often the run was resumed."""
    beat_s: float | None = None
    """When its process last gave a sign, by the machine's monotonic clock [s], which never jumps."""
    patience_s: float = PATIENCE_S
    """After how long without a sign it counts as stalled [s]."""
    engine: str = ""
    """Who looks after the run: empty for processes of this machine, "ray" for a cluster. A cluster's run belongs to one
    command, which holds its lock from the queue to the end."""
    node: str = ""
    """Where a cluster's run works, in words."""
    retries: int = 0
    """How often its engine had to begin again, because a process or a node died."""

    @property
    def active(self) -> bool:
        """Whether the run still goes on or will."""
        return self.state in ACTIVE

    @property
    def claimed(self) -> bool:
        """Whether somebody holds the run's lock, if this is still true: else it is interrupted."""
        return self.state == "running" or (self.state == "queued" and bool(self.engine))

    @property
    def where(self) -> str:
        """On which node of a cluster the run works or worked, and how often it was begun again; empty for one here."""
        if not self.engine:
            return ""
        again = f", begun again {self.retries} time{'s' * (self.retries != 1)}" if self.retries else ""
        return f"{self.node or 'waits for a node'}{again}"

    @property
    def resumable(self) -> bool:
        """Whether the run ended before its end and can go on."""
        return self.state in RESUMABLE

    def silent(self, now_s: float) -> bool:
        """Whether its process should have given a sign by `now_s` on the monotonic clock."""
        return self.beat_s is not None and now_s - self.beat_s > self.patience_s

    def to_json(self) -> dict[str, Any]:
        """The content of `state.json`."""
        return dataclasses.asdict(self)

    @staticmethod
    def from_json(value: dict[str, Any]) -> RunState:
        """The state in `state.json`; keys of later versions are ignored.

        Raises:
            RunFileError: an unknown state or a value of the wrong type.
        """
        if value.get("state") not in STATES:
            raise RunFileError(f"state.json: state {str(value.get('state'))[:40]!r} is none of {', '.join(STATES)}")
        known = {field.name: _checked(field.name, value[field.name]) for field in _FIELDS if field.name in value}
        return RunState(**known)


_FIELDS = dataclasses.fields(RunState)
_TYPES: dict[str, tuple[type, ...]] = {
    "int": (int,),
    "float": (int, float),
    "str": (str,),
    "int | None": (int, type(None)),
    "float | None": (int, float, type(None)),
}
_FIELD_TYPES = {field.name: _TYPES[str(field.type)] for field in _FIELDS}


def _checked(name: str, value: Any) -> Any:
    if isinstance(value, bool) or not isinstance(value, _FIELD_TYPES[name]):
        raise RunFileError(f"state.json: {name} is {str(value)[:40]!r}, expected {' or '.join(_names(name))}")
    return value[:TEXT_LIMIT] if isinstance(value, str) else value


def _names(name: str) -> list[str]:
    return ["nothing" if kind is type(None) else kind.__name__ for kind in _FIELD_TYPES[name]]
