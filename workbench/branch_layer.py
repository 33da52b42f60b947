"""What the 3-D replay shows of a branch: a flight that is being flown by hand just now, or one that is over."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from layouts.branch_bodies import LiveBodies
from layouts.branch_scene import add_branch
from layouts.letters import branch_letter
from layouts.motion import Motion
from layouts.scene import FlightScene
from layouts.scene_bodies import Additions
from layouts.theme import BRANCH, Mode, ground
from sim.scenario import Battlefield
from sim.trajectory import Trajectory
from workbench.branch_stick import Stick

if TYPE_CHECKING:
    import viser


@dataclass(frozen=True)
class Flown:
    """A branch that has been flown."""

    flight: Trajectory
    from_s: float
    """When it leaves its original."""


class BranchLayer:
    """A `workbench.flight_view.Layer`; set what it shows, then have the view draw it."""

    def __init__(self) -> None:
        self._shown: Flown | Stick | None = None
        self._on = 0
        self._battlefield: Battlefield | None = None
        self._root, self._builds = "", 0
        self._scene: FlightScene | None = None
        self._live: LiveBodies | None = None

    @property
    def evader(self) -> Motion | None:
        """Whom the camera follows."""
        if self._live is not None:
            return self._live.evader
        return self._scene.evaders[0] if self._scene and self._scene.evaders else None

    def flown(self, flight: Trajectory, from_s: float, on: int) -> None:
        """Show a branch of flight number `on` that is over."""
        self._shown, self._on = Flown(flight, from_s), on

    def flying(self, stick: Stick, battlefield: Battlefield, on: int) -> None:
        """Show a branch of flight number `on` that a person flies."""
        self._shown, self._battlefield, self._on = stick, battlefield, on

    def nothing(self) -> None:
        """Show nothing."""
        self._shown = None

    def build(self, server: viser.ViserServer, scene: FlightScene, mode: Mode, root: str, additions: Additions) -> None:
        """Draw it into a scene, in place of what was drawn before."""
        server.scene.remove_by_name(self._root)
        self._builds += 1
        # A new name each time: viser keeps the place of a name that comes back.
        self._root = f"{root}/branch_{self._builds}"
        self._scene = self._live = None
        if isinstance(self._shown, Flown):
            flight, from_s = self._shown.flight, self._shown.from_s
            letter = branch_letter("AB"[self._on])
            self._scene = add_branch(server, scene, self._on, flight, from_s, BRANCH, mode, self._root, letter)
            self._scene.paint(additions)
        elif self._shown is not None and self._battlefield is not None:
            server.scene.add_frame(self._root, show_axes=False)
            place = (self._battlefield, scene.offsets_km[self._on])
            self._live = LiveBodies(server, self._root, BRANCH, ground(mode), place)

    def show(self, time_s: float, additions: Additions) -> None:
        """Place it as it is at this time [s]; what is flown live is never shown before or after what was flown."""
        if self._scene is not None:
            self._scene.show(time_s, additions)
        elif self._live is not None and isinstance(self._shown, Stick):
            now = min(max(time_s, self._shown.start_s), self._shown.time_s)
            self._live.show(now, self._shown.poses(now))
