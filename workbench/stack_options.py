"""Whether trainings are stacked in one process, and on which device, as the command line says it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Final, Literal

from sim.errors import UsageError


@dataclass(frozen=True)
class StackOptions:
    """Whether trainings are stacked in one process, and on which device."""

    device: str = "cpu"
    """Where networks are trained: cpu, or a graphics card, cuda or cuda:1, on which all runs learn together."""
    stacked: bool = False
    """Train all seeds and variants in one process, side by side in stacked tensors (always so on a graphics card)."""
    simulator: Literal["device", "host"] = "device"
    """Stacked only: the simulator beside the networks, on the device, or on the processor (host)."""

    @property
    def together(self) -> bool:
        """Whether the runs are trained by one process."""
        return self.stacked or self.device != "cpu"

    def check(self, engine: str) -> None:
        """Refuse what is not legal or not there; looks for a graphics card only where one is asked for.

        Raises:
            UsageError: naming the option, its value and what is legal.
        """
        if self.simulator != "device" and not self.together:
            raise UsageError("--simulator needs --stacked or --device cuda; a training by itself has its own")
        if not self.together:
            return
        if engine != "local":
            raise UsageError(f"--engine {engine} trains each run by itself; leave --stacked and --device out")
        from agents.stacked.device import checked_device

        checked_device(self.device)


ONE_BY_ONE: Final = StackOptions()
"""A process per run, on the processor."""
