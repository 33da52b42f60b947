"""What the learner asks of a domain: tasks made of maskable subtasks, and worlds that run them in lanes.

The learning code knows a domain only through these protocols. The paper's domain is `agents.evasion.EVASION`;
another one needs its own `Domain` and nothing else.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from agents.features import ObservationFeatures

FloatArray = NDArray[np.float32]
IntArray = NDArray[np.integer[Any]]
BoolArray = NDArray[np.bool_]

RUNNING: Final = 0
"""Outcome of a lane whose episode is not over."""
GOAL_REACHED: Final = 1
"""Outcome of an episode that reached the final goal; every larger number is a way to fail."""
SUBTASK_SOLVED: Final = 2
"""Fate of a subtask that was met and solved (a missile evaded)."""


class Layout(Protocol):
    """Names and order of the columns of one task's observation (Table 1)."""

    @property
    def names(self) -> tuple[str, ...]:
        """Column names; those of a subtask end in its number, as in `r_3`."""
        ...

    @property
    def size(self) -> int:
        """Number of columns d."""
        ...

    @property
    def digest(self) -> str:
        """Short text that identifies the columns."""
        ...

    def block(self, _subtask: int, /) -> slice:
        """Columns that belong to one subtask alone."""
        ...

    # `source` is a layout of the same domain: a protocol has no simple word for "the same class as mine".
    def shared_columns(self, source: Any) -> Any:
        """Columns of this layout kept in the source's layout, in its order (Ξ, Eq. 6)."""
        ...

    def masked_columns(self, source: Any) -> Any:
        """Columns of this layout that the source lacks (Ψ, Eq. 6)."""
        ...


class SubtaskTask(Protocol):
    """A final goal and several maskable subtasks (Definition 1)."""

    @property
    def name(self) -> str:
        """Name in file names, tables and figures."""
        ...

    @property
    def layout(self) -> Any:
        """`Layout` of the task's observations."""
        ...

    def mask(self, _subtasks: Iterable[int], /) -> Any:
        """Algorithm 2: the source task without these subtasks."""
        ...


class TaskStep(Protocol):
    """What one step tells about every lane; arrays over L lanes."""

    @property
    def observation(self) -> Any:
        """True next observation [L, d]; a finished lane is not reset."""
        ...

    @property
    def reward(self) -> Any:
        """Sum of the reward terms [L]."""
        ...

    @property
    def terminated(self) -> Any:
        """The final goal was reached or missed for good [L]."""
        ...

    @property
    def truncated(self) -> Any:
        """The episode was cut by the step limit [L]."""
        ...


class TaskWorld(Protocol):
    """One task, run in L lanes side by side, without automatic resets."""

    @property
    def lanes(self) -> int:
        """Number of lanes L."""
        ...

    next_episode: int
    """Number of the next episode that `reset` starts when it is given none."""

    @property
    def outcome(self) -> Any:
        """`RUNNING`, `GOAL_REACHED` or a domain's way to fail [L]."""
        ...

    @property
    def killer(self) -> Any:
        """Number of the subtask that ended the episode, 0 for none [L]."""
        ...

    @property
    def fate(self) -> Any:
        """Fate of every subtask of the unmasked task [L, M]; `SUBTASK_SOLVED` counts."""
        ...

    @property
    def steps(self) -> Any:
        """Steps flown in the current episode [L]."""
        ...

    def reset(self, lanes: Any = None, episodes: Any = None) -> Any:
        """Start these lanes (None: all) with these episode numbers; observations of all lanes [L, d]."""
        ...

    def step(self, _actions: Any, /) -> Any:
        """Advance every lane by one decision step; a `TaskStep`."""
        ...

    def state(self) -> Any:
        """Everything that changes during episodes, arrays by name; with `next_episode` all there is to `restore`."""
        ...

    def restore(self, _state: Any, /) -> Any:
        """Go on from a `state` of a world of the same task, lanes and seed; observations of all lanes [L, d]."""
        ...


class Domain(Protocol):
    """A family of tasks: how to build worlds for them and how their observations are read."""

    @property
    def action_limit(self) -> float:
        """Actions lie in [-limit, limit] (radians for a turning angle)."""
        ...

    @property
    def default_block(self) -> tuple[float, ...]:
        """State of a subtask that is not detected (§2.3, Eq. 13)."""
        ...

    @property
    def outcome_names(self) -> Mapping[int, str]:
        """Names of all ways to end an episode, `GOAL_REACHED` first."""
        ...

    def layout(self, subtasks: tuple[int, ...]) -> Any:
        """`Layout` of a task with these subtasks."""
        ...

    def target(self, scenario: str, subtasks: int) -> Any:
        """The task with subtasks 1 … n of a scenario."""
        ...

    def subtasks(self, task: Any) -> tuple[int, ...]:
        """Numbers of the subtasks a task leaves unmasked, ascending."""
        ...

    def masked(self, task: Any) -> tuple[int, ...]:
        """Numbers of the subtasks a task masks, ascending."""
        ...

    def scenario(self, task: Any) -> tuple[str, str]:
        """Name and digest of the scenario behind a task."""
        ...

    def step_s(self, task: Any) -> float:
        """Length of a decision step [s]."""
        ...

    def world(self, task: Any, lanes: int, seed: int) -> Any:
        """A `TaskWorld` for this task."""
        ...

    def features(self, layout: Any) -> ObservationFeatures:
        """How networks read an observation of this layout."""
        ...
