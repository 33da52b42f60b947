"""A world that is driven where its arrays lie: nothing is copied to the host between two decision steps."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from sim.observation import BLOCK, OWN_NAMES, ObservationLayout
from sim.start import initial_states
from sim.world import World


class DeviceWorld(World):
    """The same lanes as `World`'s, bit for bit. Write `turns`, call `advance`, read the other arrays.

    Observations are the truth: what imperfect sensors make of it is modelled on the host, by `World` alone.
    The arrays are Warp's and belong to the world; rows beyond its lanes fill up the last group and mean nothing.
    """

    @property
    def turns(self) -> Any:
        """Turning angles of the next step [rad], float `[rows / 16, 16]`."""
        return self._action

    @property
    def truth(self) -> Any:
        """Observations of all missiles of the scenario, masked or not, float `[rows, 7 + 2 M]`."""
        return self._observation

    @property
    def terms(self) -> Any:
        """Reward terms of the last step, float `[rows, M + 2]`."""
        return self._terms

    @property
    def outcomes(self) -> Any:
        """`Outcome` of every lane, int `[rows / 16, 16]`."""
        return self._state.outcome

    def advance(self) -> None:
        """Fly one decision step with the angles in `turns`, on the current stream of the device.

        Unlike `World.step` it does not look at them; an angle that is not finite ends its lane as NOT_FINITE.
        """
        self._launch_step()

    def restart(self, lanes: NDArray[np.integer]) -> None:
        """Start these lanes with the next unused episodes, as `reset` does, without bringing back observations."""
        numbers = self._number(len(lanes))
        self._episode[lanes] = numbers
        self._begin(lanes, initial_states(self.task.scenario, self.seed, numbers))


def truth_columns(layout: ObservationLayout) -> list[int]:
    """Columns of `truth` that a layout shows, in its order."""
    own, missiles = range(len(OWN_NAMES)), layout.missiles
    return [*own, *(len(OWN_NAMES) + BLOCK * (missile - 1) + column for missile in missiles for column in range(BLOCK))]
