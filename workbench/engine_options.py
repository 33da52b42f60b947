"""Where to work, as the command line says it: the options that `train`, `resume`, `reproduce` and studies share."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final

from sim.errors import UsageError

ENGINES: Final = ("local", "ray")
FOLDERS: Final = ("auto", "shared", "streamed")
RETRIES_LIMIT: Final = 100


@dataclass(frozen=True)
class EngineOptions:
    """Where to work, as the command line says it."""

    engine: str = "local"
    """Where the work is done: local, by processes of this machine, or ray, on a Ray cluster (docs/cluster.md)."""
    ray_address: str = ""
    """With --engine ray: HOST:PORT of the cluster, or auto for the one of this machine (default: one started here)."""
    cpus_per_run: float = 1.0
    """With --engine ray: cores that each run takes; a training works with one thread."""
    gpus_per_run: float = 0.0
    """With --engine ray: graphics cards that each run takes; 0.25 lets four runs share one."""
    run_folders: str = "auto"
    """With --engine ray: shared, if every node sees the folder of the runs; streamed back; or auto, found out."""
    retries: int = 3
    """With --engine ray: how often a run may begin again at its last checkpoint because a process or node died."""

    def check(self) -> None:
        """Refuse what is not legal.

        Raises:
            UsageError: naming the option, its value and what is legal.
        """
        if self.engine not in ENGINES:
            raise UsageError(f"--engine is '{self.engine}'; legal are {', '.join(ENGINES)}")
        if self.engine == "local" and self != LOCAL:
            raise UsageError(
                "--ray-address, --cpus-per-run, --gpus-per-run, --run-folders and --retries need --engine ray"
            )
        if self.run_folders not in FOLDERS:
            raise UsageError(f"--run-folders is '{self.run_folders}'; legal are {', '.join(FOLDERS)}")
        if not 0.01 <= self.cpus_per_run <= 1024:
            raise UsageError(f"--cpus-per-run is {self.cpus_per_run:g}; legal are 0.01 to 1024")
        if not 0 <= self.gpus_per_run <= 64:
            raise UsageError(f"--gpus-per-run is {self.gpus_per_run:g}; legal are 0 to 64")
        if not 0 <= self.retries <= RETRIES_LIMIT:
            raise UsageError(f"--retries is {self.retries}; legal are 0 to {RETRIES_LIMIT}")


LOCAL: Final = EngineOptions()
"""Processes of this machine."""
