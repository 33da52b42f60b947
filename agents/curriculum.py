"""Curricula: creating source tasks, ordering them, learning along the order (§2.2, §3.2; Algorithms 1 and 3)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

from agents.task import SubtaskTask


@dataclass(frozen=True)
class Curriculum:
    """A sequenced curriculum ℂ = (𝒱, ℰ, 𝒯): a chain of tasks that ends in the target task."""

    tasks: tuple[Any, ...]
    """Vertices v₀ (the target) to v_n (the easiest source task), each a `SubtaskTask`."""

    @property
    def edges(self) -> tuple[tuple[int, int], ...]:
        """Directed edges ⟨i, i - 1⟩: task i is trained before task i - 1."""
        return tuple((i, i - 1) for i in range(1, len(self.tasks)))

    @property
    def target(self) -> Any:
        """The sink of the chain."""
        return self.tasks[0]

    @property
    def easiest(self) -> Any:
        """The source of the chain: the task without any subtask."""
        return self.tasks[-1]


def create_tasks(target: SubtaskTask, subtasks: Sequence[int]) -> tuple[Any, ...]:
    """Every source task of a target: Algorithm 1, line 1 (createTasks), by Algorithm 2 for each mask.

    There are 2ⁿ - 1 of them, one for each non-empty set of masked subtasks, the hardest first (§3.2.2).
    """
    sizes = range(1, len(subtasks) + 1)
    return tuple(target.mask(masked) for size in sizes for masked in combinations(subtasks, size))


def build_curriculum(target: SubtaskTask, ordered_subtasks: Sequence[int]) -> Curriculum:
    """The linear chain of tasks that masks one more subtask at a time: Algorithm 3, §3.2.2.

    Args:
        target: the task to be solved in the end.
        ordered_subtasks: its subtasks τ₁ … τ_n, the most complex first; τ₁ is masked first and met last.
    """
    tasks: list[Any] = [target]
    for subtask in ordered_subtasks:
        tasks.append(tasks[-1].mask([subtask]))  # Algorithm 2
    return Curriculum(tuple(tasks))


def learn_with_curriculum(
    target: SubtaskTask, ordered_subtasks: Sequence[int], learn: Callable[[Curriculum], Any]
) -> Any:
    """Generate a curriculum and use it: Algorithm 1, §2.2.

    Lines 1 and 2 are one step here: of all tasks that `create_tasks` could make, Algorithm 3 makes only the chain.

    Args:
        target: the task to be solved.
        ordered_subtasks: its subtasks, the most complex first.
        learn: trains along the chain (line 3) and returns the policy for the target task.
    """
    return learn(build_curriculum(target, ordered_subtasks))
