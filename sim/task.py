"""A task: a scenario and the missiles that are masked in it (Definition 1, Algorithm 2)."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass

from sim.errors import MaskError
from sim.observation import ObservationLayout
from sim.scenario import Scenario
from sim.scenario_file import load_scenario


@dataclass(frozen=True)
class Task:
    """The engagement of a scenario in which the interceptor carries only the unmasked missiles.

    Definition 1: masking a missile removes it from the observation and from the reward and leaves everything else
    alone: initial states (Eq. 7) and the motion of what remains (Eq. 8) are those of the target task.
    """

    scenario: Scenario
    masked: frozenset[int] = frozenset()

    def __post_init__(self) -> None:
        """Reject masks outside 1..n.

        Raises:
            MaskError: a masked number is not a missile of the scenario.
        """
        _check(self.masked, self.scenario.launch.missiles)

    @property
    def missiles(self) -> tuple[int, ...]:
        """Unmasked missiles, ascending: the subtask set of this task."""
        return tuple(m for m in range(1, self.scenario.launch.missiles + 1) if m not in self.masked)

    @property
    def layout(self) -> ObservationLayout:
        """Columns of this task's observation (Table 1)."""
        return ObservationLayout(self.missiles)

    @property
    def name(self) -> str:
        """`target`, `source-k` when the k highest missiles are masked (Table 1), else `missiles-` and the numbers."""
        if not self.masked:
            return "target"
        if self.missiles == tuple(range(1, len(self.missiles) + 1)):
            return f"source-{len(self.masked)}"
        return "missiles-" + "-".join(str(m) for m in self.missiles)

    def mask(self, missiles: Iterable[int]) -> Task:
        """Algorithm 2: the source task in which these missiles are masked as well."""
        return Task(self.scenario, self.masked | frozenset(missiles))

    def contains(self, source: Task) -> bool:
        """Whether `source` can be made from this task by masking."""
        return self.scenario == source.scenario and self.masked <= source.masked


def parse_mask(text: str, missiles: int) -> frozenset[int]:
    """Masked missiles from text such as `"1,2"`, of an interceptor that carries `missiles`; empty text masks none.

    Raises:
        MaskError: not numbers separated by commas, or a number outside 1..`missiles`.
    """
    try:
        numbers = frozenset(int(part) for part in text.split(",") if part.strip())
    except ValueError:
        raise MaskError(
            f"mask '{text}' is not a list of missiles; write numbers from 1 to {missiles}, as in 1,2"
        ) from None
    _check(numbers, missiles)
    return numbers


def task_for(scenario: str = "default", mask: str = "") -> Task:
    """The task of a named scenario (or a path to a scenario file) with a mask such as `"3,4"`."""
    loaded = load_scenario(scenario)
    return Task(loaded, parse_mask(mask, loaded.launch.missiles))


def _check(masked: frozenset[int], missiles: int) -> None:
    wrong = sorted(m for m in masked if not 1 <= m <= missiles)
    if wrong:
        raise MaskError(f"mask names missile {', '.join(map(str, wrong))}; legal are 1 to {missiles}")
