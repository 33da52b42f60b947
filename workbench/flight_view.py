"""The 3-D replay of one page session: a live viser scene behind the front door, its cameras and its frame."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

import numpy as np
import panel as pn
import param
from panel.custom import JSComponent

from layouts.cameras import FIELD_OF_VIEW_RAD, chase, overview
from layouts.motion import Motion
from layouts.scene import Additions, FlightScene, build_scene
from layouts.theme import POLICY_A, POLICY_B, Mode, ground, hexadecimal
from sim.trajectory import Trajectory
from workbench.scene_photo import PhotoError, photograph

if TYPE_CHECKING:
    import viser

    from workbench.viser_proxy import ViserRegistry

CHASE = {"chase-a": 0, "chase-b": 1}
CHASE_LAYER = "chase-branch"
FREE = "free"
USUAL = tuple(field.name for field in fields(Additions) if field.default)
EYE_AFTER_MS = 500


class Layer(Protocol):
    """Something more in the scene, drawn after the flights and again whenever they are."""

    @property
    def evader(self) -> Motion | None:
        """Whom the camera of the layer follows."""
        ...

    def build(self, server: viser.ViserServer, scene: FlightScene, mode: Mode, root: str, additions: Additions) -> None:
        """Draw it into a scene, in place of what it drew before; all names begin with `root`."""
        ...

    def show(self, time_s: float, additions: Additions) -> None:
        """Place it as it is at this time [s]."""
        ...


class FlightFrame(JSComponent):
    """The frame around viser's page, with camera buttons; reports whether the page is dark."""

    address = param.String(doc="address of the scene's page, on this server")
    camera = param.String(
        default="overview", doc="overview, top, chase-a, chase-b, chase-branch or free; set by the browser"
    )
    eye = param.List(default=[], doc="of a free camera that was moved: its place and what it looks at, x, y, z [km]")
    drawn = param.List(default=[], item_type=str, doc="what is drawn besides the bodies; set by the browser")
    look = param.Integer(default=0, doc="counts camera buttons pressed, so that pressing one again resets it")
    overlay = param.Boolean(default=False, doc="both flights on one battlefield; set by the browser")
    branch = param.Boolean(default=False, doc="whether there is a branch to follow")
    dark = param.Boolean(default=True, doc="whether the page is dark; set by the browser")
    ground = param.String(doc="colour behind the scene, #rrggbb")
    due = param.Integer(default=0, doc="counts flights whose scene waits until the page is painted")
    painted = param.Integer(default=0, doc="the last of them after which the page was painted; set by the browser")
    photo = param.Integer(default=0, doc="counts pictures asked for; set by the browser")
    picture = param.Dict(default={}, doc="`number` of the picture asked for, and its PNG as `data` or a `problem`")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]


class FlightView:
    """Scene, cameras and frame of one session; `close` when the session ends."""

    def __init__(self, registry: ViserRegistry, **frame: Any) -> None:
        """Start a scene of its own; `frame` are first values of the frame: camera, eye, overlay, drawn."""
        self._registry = registry
        self._name, self._server = registry.open()
        self._open = True
        self._scene: FlightScene | None = None
        self._flights: Sequence[Trajectory] = ()
        self._waiting: tuple[Sequence[Trajectory], float] = (), 0.0
        self._time_s = 0.0
        self._builds = 0
        self.layer: Layer | None = None
        self._server.gui.configure_theme(dark_mode=True, show_logo=False, show_share_button=False)
        self._server.on_client_connect(self._greet)
        self._page, self._moved = pn.state.curdoc, False
        self.frame = FlightFrame(sizing_mode="stretch_width", margin=0, **{"drawn": list(USUAL), **frame})
        self.frame.param.watch(lambda *_events: self._build(), ["dark", "overlay"])
        self.frame.param.watch(lambda *_events: self._aim_all(), ["camera", "look"])
        self.frame.param.watch(lambda *_events: (self._redraw(), self.draw_layer()), "drawn")
        self.frame.param.watch(self._photograph, "photo")
        self.frame.param.watch(self._load_waiting, "painted")

    def load_when_painted(self, flights: Sequence[Trajectory], time_s: float) -> None:
        """Show these flights at this time [s] once the browser has painted what it was told before.

        The scene is heavy, and neither curves nor read-outs should wait for it.
        """
        self._waiting = flights, time_s
        self.frame.due += 1

    def _load_waiting(self, event: Any) -> None:
        if event.new == self.frame.due:
            flights, time_s = self._waiting
            self.load(flights)
            self.show(time_s)

    def load(self, flights: Sequence[Trajectory]) -> None:
        """Replace what is shown by these flights."""
        first = not self._flights
        self._flights = flights
        self._build(keep_camera=not first)
        self.frame.address = f"/viser/{self._name}/"

    def show(self, time_s: float) -> None:
        """Move everything to this time [s]; cameras that follow somebody move along."""
        self._time_s = time_s
        if self._scene is None:
            return
        self._scene.show(time_s, self.additions)
        if self.layer is not None:
            self.layer.show(time_s, self.additions)
        if self.frame.camera in (*CHASE, CHASE_LAYER):
            self._aim_all()

    def close(self) -> None:
        """Stop the session's viser server."""
        self._open = False
        self._registry.close(self._name)

    def _build(self, keep_camera: bool = False) -> None:
        if not self._flights:
            return
        self._builds += 1
        mode = self._mode
        self.frame.ground = hexadecimal(ground(mode).background)
        colours = [POLICY_A, POLICY_B][: len(self._flights)]
        self._scene = build_scene(
            self._server, self._flights, colours, mode, self.frame.overlay, f"/build_{self._builds}"
        )
        self._redraw()
        self.draw_layer()
        if not keep_camera:
            self._aim_all()

    @property
    def additions(self) -> Additions:
        """What is drawn besides the bodies."""
        return Additions(**{field.name: field.name in self.frame.drawn for field in fields(Additions)})

    @property
    def _mode(self) -> Mode:
        return "dark" if self.frame.dark else "light"

    def _redraw(self) -> None:
        if self._scene is not None:
            self._scene.paint(self.additions)
            self._scene.show(self._time_s, self.additions)

    def draw_layer(self) -> None:
        """Draw the layer into the present scene, as when it has something new to show."""
        if self._scene is not None and self.layer is not None:
            self.layer.build(self._server, self._scene, self._mode, f"/build_{self._builds}", self.additions)
            self.layer.show(self._time_s, self.additions)

    async def _photograph(self, event: Any) -> None:
        try:
            background = ground(self._mode).background
            made = {"data": await asyncio.to_thread(photograph, self._server, background, lambda: self._open)}
        except PhotoError as error:
            made = {"problem": f"{error}."}
        self.frame.picture = {"number": event.new, **made}

    def _aim_all(self) -> None:
        for client in self._server.get_clients().values():
            self._aim(client)

    def _greet(self, client: viser.ClientHandle) -> None:
        if self.frame.camera == FREE and len(self.frame.eye) == 6:
            with client.atomic():
                client.camera.fov = FIELD_OF_VIEW_RAD
                client.camera.position, client.camera.look_at = np.array(self.frame.eye).reshape(2, 3)
        else:
            self._aim(client, force=True)
        client.camera.on_update(self._notice)

    def _notice(self, camera: viser.CameraHandle) -> None:
        """A free camera was moved: say so in the frame, soon; viser calls this from a thread of its own."""
        page = self._page
        if self.frame.camera != FREE or page is None or self._moved:
            return
        self._moved = True

        def report() -> None:
            self._moved = False
            if self.frame.camera == FREE:
                self.frame.eye = [round(float(value), 1) for value in (*camera.position, *camera.look_at)]

        def soon() -> None:
            page.add_timeout_callback(report, EYE_AFTER_MS)

        page.add_next_tick_callback(soon)

    def _aim(self, client: viser.ClientHandle, force: bool = False) -> None:
        if self._scene is None or (self.frame.camera == FREE and not force):
            return
        scene, camera = self._scene, client.camera
        with client.atomic():
            camera.fov = FIELD_OF_VIEW_RAD
            followed = self._followed(scene)
            if followed is not None:
                camera.position, camera.look_at = chase(followed, self._time_s)
            else:
                camera.position, camera.look_at = overview(
                    scene.width_km, scene.depth_km, camera.aspect, top=self.frame.camera == "top"
                )

    def _followed(self, scene: FlightScene) -> Motion | None:
        """Whom the camera follows."""
        if self.frame.camera == CHASE_LAYER:
            return self.layer.evader if self.layer else None
        number = CHASE.get(self.frame.camera, len(scene.evaders))
        return scene.evaders[number] if number < len(scene.evaders) else None
