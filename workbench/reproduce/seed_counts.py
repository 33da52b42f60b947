"""How many trainings of each algorithm: baselines are dearer than SubMas-RL, ablations less telling."""

from __future__ import annotations

from dataclasses import dataclass

from workbench.reproduce.protocol import BASELINES


@dataclass(frozen=True)
class SeedCounts:
    """Trainings of each algorithm; N of them have the seeds 0 to N-1."""

    ablations: int
    """Of each ablation of Table 3; what `--seeds` says."""
    submas: int
    baselines: int
    """Of each of TD3, SAC and PPO."""

    @classmethod
    def each(cls, count: int) -> SeedCounts:
        """The same number of every algorithm, as in the paper."""
        return cls(count, count, count)

    def of(self, variant: str) -> int:
        """Trainings of one algorithm."""
        if variant == "submas":
            return self.submas
        return self.baselines if variant in BASELINES else self.ablations

    @property
    def options(self) -> str:
        """The options of `workbench reproduce` that say so."""
        words = [f"--seeds {self.ablations}"]
        words += [f"--seeds-submas {self.submas}"] if self.submas != self.ablations else []
        words += [f"--seeds-baselines {self.baselines}"] if self.baselines != self.ablations else []
        return " ".join(words)
