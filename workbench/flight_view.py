"""The 3-D replay of one page session: a live viser scene behind the front door, its cameras and its frame."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

import numpy as np
import param
from numpy.typing import NDArray
from panel.custom import JSComponent

from layouts.motion import Motion
from layouts.scene import FlightScene, build_scene
from layouts.theme import POLICY_A, POLICY_B
from sim.trajectory import Trajectory

if TYPE_CHECKING:
    import viser

    from workbench.viser_proxy import ViserRegistry

FIELD_OF_VIEW_RAD = math.radians(38.0)
CHASE_BEHIND_KM = 42.0
CHASE_ABOVE_KM = 17.0
CHASE_AHEAD_KM = 12.0
OVERVIEW_PITCH_RAD = math.radians(56.0)
CHASE = {"chase-a": 0, "chase-b": 1}


class FlightFrame(JSComponent):
    """The frame around viser's page, with camera buttons; reports whether the page is dark."""

    address = param.String(doc="address of the scene's page, on this server")
    camera = param.String(default="overview", doc="overview, top, chase-a or chase-b; set by the browser")
    look = param.Integer(default=0, doc="counts camera buttons pressed, so that pressing one again resets it")
    overlay = param.Boolean(default=False, doc="both flights on one battlefield; set by the browser")
    dark = param.Boolean(default=True, doc="whether the page is dark; set by the browser")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]


class FlightView:
    """Scene, cameras and frame of one session; `close` when the session ends."""

    def __init__(self, registry: ViserRegistry) -> None:
        self._registry = registry
        self._name, self._server = registry.open()
        self._scene: FlightScene | None = None
        self._flights: Sequence[Trajectory] = ()
        self._time_s = 0.0
        self._builds = 0
        self._server.gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False)
        self._server.on_client_connect(self._aim)
        self.frame = FlightFrame(sizing_mode="stretch_width", margin=0)
        self.frame.param.watch(lambda *_events: self._build(), ["dark", "overlay"])
        self.frame.param.watch(lambda *_events: self._aim_all(), ["camera", "look"])

    def load(self, flights: Sequence[Trajectory]) -> None:
        """Replace what is shown by these flights."""
        first = not self._flights
        self._flights = flights
        self._build(keep_camera=not first)
        # Only now: the frame is heavy, and the curves should not wait for it.
        self.frame.address = f"/viser/{self._name}/"

    def show(self, time_s: float) -> None:
        """Move everything to this time [s]; cameras that follow somebody move along."""
        self._time_s = time_s
        if self._scene is None:
            return
        self._scene.show(time_s)
        if self.frame.camera in CHASE:
            self._aim_all()

    def close(self) -> None:
        """Stop the session's viser server."""
        self._registry.close(self._name)

    def _build(self, keep_camera: bool = False) -> None:
        if not self._flights:
            return
        self._builds += 1
        mode = "dark" if self.frame.dark else "light"
        colours = [POLICY_A, POLICY_B][: len(self._flights)]
        self._scene = build_scene(
            self._server, self._flights, colours, mode, self.frame.overlay, f"/build_{self._builds}"
        )
        self._scene.show(self._time_s)
        if not keep_camera:
            self._aim_all()

    def _aim_all(self) -> None:
        for client in self._server.get_clients().values():
            self._aim(client)

    def _aim(self, client: viser.ClientHandle) -> None:
        if self._scene is None:
            return
        scene, camera = self._scene, client.camera
        number = CHASE.get(self.frame.camera)
        with client.atomic():
            camera.fov = FIELD_OF_VIEW_RAD
            if number is not None and number < len(scene.evaders):
                camera.position, camera.look_at = chase(scene.evaders[number], self._time_s)
            else:
                camera.position, camera.look_at = overview(scene, camera.aspect, top=self.frame.camera == "top")


def overview(scene: FlightScene, aspect: float, top: bool = False) -> tuple[NDArray, NDArray]:
    """Camera position and target [km] that show all battlefields in a view of this width over height."""
    tilt = math.radians(89.5) if top else OVERVIEW_PITCH_RAD
    half_view = math.tan(FIELD_OF_VIEW_RAD / 2)
    near = scene.depth_km / 2 * math.cos(tilt)  # the front edge is closer than the middle, and so looks wider
    wide = scene.width_km * 1.03 / 2 / (half_view * max(aspect, 0.5)) + near
    high = (scene.depth_km * math.sin(tilt) + 34.0) * 1.02 / 2 / half_view + near * 0.5
    distance = max(wide, high)
    target = np.array([0.0, 0.0, 8.0 if top else 12.0])
    return target + distance * np.array([0.0, -math.cos(tilt), math.sin(tilt)]), target


def chase(evader: Motion, time_s: float) -> tuple[NDArray, NDArray]:
    """Camera position and target [km] behind and above an evader, along the way it has come lately."""
    here = evader.position(time_s)
    # Looking back over half a minute keeps the camera calm while the evader turns hard.
    along = evader.position(time_s + 4.0) - evader.position(max(time_s - 26.0, float(evader.time_s[0])))
    along[2] = 0.0
    length = float(np.linalg.norm(along))
    direction = along / length if length > 1e-6 else np.array([1.0, 0.0, 0.0])
    up = np.array([0.0, 0.0, 1.0])
    return here - direction * CHASE_BEHIND_KM + up * CHASE_ABOVE_KM, here + direction * CHASE_AHEAD_KM
