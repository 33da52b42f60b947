"""S17: the viewers show; nothing that comes from one writes a file, starts work or reaches beyond its own scene."""

from __future__ import annotations

import ast
import asyncio
import dataclasses
import re
import socket
from collections.abc import Iterator
from pathlib import Path

import msgspec
import psutil
import pytest
import viser
import viser._messages as messages
from tornado.httpclient import HTTPRequest
from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets
from tornado.web import Application
from tornado.websocket import websocket_connect
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from tests.conftest import Served
from tests.security.hostile import EVERY
from tests.security.session import session
from tests.security.sources import PACKAGES, ROOT, calls, trees
from workbench import viewer_files
from workbench.viser_proxy import LOOKS, ViserRegistry, only_looks, viser_routes

ACTS = re.compile(
    r"add_(button|upload|checkbox|text|number|slider|dropdown|command|modal|form|transform_controls)|on_(click|upload|drag|pointer)"
    r"|on_pointer|on_scene|gui\.add|send_file_download|run_javascript"
)
SERVES = re.compile(r"serve_grpc|serve_web|serve_web_viewer|connect_grpc|rr\.(spawn|connect|serve)|\.spawn\(")


def sources(*folders: str) -> Iterator[tuple[Path, str]]:
    """What each file calls; not its comments and texts, which may speak of it."""
    for path, tree in trees(*folders).items():
        yield path, " ".join(ast.unparse(node.func) for node in calls(tree))


def test_no_scene_has_anything_to_press() -> None:
    users = [(path, called) for path, called in sources(*PACKAGES) if "viser" in path.read_text("utf-8")]
    assert len(users) > 3
    scenes = [(path, called) for path, called in users if "pages" not in path.parts]
    assert [
        (path.name, found[0])
        for path, called in scenes
        if (found := re.findall(rf"\b(?:server|scene|gui|handle)\.\w*{ACTS.pattern}", called))
    ] == []


def test_no_viewer_of_rerun_is_served_by_rerun() -> None:
    assert [path.name for path, called in sources(*PACKAGES) if SERVES.search(called)] == []


def every_message() -> list[type]:
    found, rest = [], [messages.Message]
    while rest:
        kind = rest.pop()
        rest += kind.__subclasses__()
        if not kind.__name__.startswith("_") and kind is not messages.Message:
            found.append(kind)
    return found


def test_of_all_messages_only_looks_are_passed_on() -> None:
    names = {kind.__name__ for kind in every_message()}
    assert names >= LOOKS and len(names) > 100
    passed = {name for name in names if only_looks(msgspec.msgpack.encode({"type": name}))}
    assert passed == LOOKS
    picture = {"type": "GetRenderResponseMessage", "payload": bytes(3_000_000), "render_uuid": "one"}
    assert only_looks(msgspec.msgpack.encode(picture))
    assert not {"GuiUpdateMessage", "FileTransferStartUpload", "ShareUrlRequest", "ScenePointerMessage"} & passed


NO_LOOKS = (
    "text", b"", b"\x00", b"\xc1", b"\x80", b"\x91" * 100_000,
    msgspec.msgpack.encode({"type": ["ViewerCameraMessage"]}), msgspec.msgpack.encode({"kind": "ViewerCameraMessage"}),
    msgspec.msgpack.encode({"type": None}),
    *(msgspec.msgpack.encode({"type": name}) for name in EVERY if "\udc80" not in name),
)  # fmt: skip


@pytest.mark.parametrize("raw", NO_LOOKS, ids=range(len(NO_LOOKS)))
def test_what_is_no_message_is_dropped(raw: str | bytes) -> None:
    assert only_looks(raw) is False


def test_what_a_scene_keeps_of_a_look_is_numbers() -> None:
    # The two that are passed on hold numbers, arrays and a picture, no name, path, address or script.
    fields = {name: str(kind) for each in LOOKS for name, kind in _fields(each).items()}
    assert not [name for name in fields if re.search("path|file|url|script|name|uuid", name) and name != "render_uuid"]


def _fields(name: str) -> dict[str, object]:
    kind = next(kind for kind in every_message() if kind.__name__ == name)
    return {field.name: field.type for field in dataclasses.fields(kind)}


def listening(served: Served) -> dict[int, str]:
    """Port -> address of every listening socket of the server's process tree."""
    root = psutil.Process(served.process.pid)
    sockets = [each for process in (root, *root.children(recursive=True)) for each in process.net_connections("inet")]
    return {each.laddr.port: each.laddr.ip for each in sockets if each.status == psutil.CONN_LISTEN}


def test_with_every_page_open_only_this_machine_can_reach_anything(served: Served) -> None:
    # S1, with the scenes of two flights, whose servers are other sockets.
    with session(served, "/fly?seed=3"), session(served, "/fly?seed=4"):
        assert served.ask("/rerun/").status == 200
        scenes = _scenes(served)
        assert len(scenes) >= 2, "a page that shows a flight has a scene of its own"
        assert set(listening(served).values()) <= {"127.0.0.1", "::1"}
        for port in scenes:
            _assert_nobody_passes_by(port)


def _scenes(served: Served) -> list[int]:
    import time

    for _ in range(300):
        ports = [port for port in listening(served) if port != served.port]
        if len(ports) >= 2:
            return ports
        time.sleep(0.1)
    return ports


def _assert_nobody_passes_by(port: int) -> None:
    """Neither another page of this browser nor a program of this machine speaks to a scene without the front door."""
    for origin in (None, "null", f"http://127.0.0.1:{port}", f"http://localhost:{port}", "http://evil.example"):
        with (
            pytest.raises(InvalidStatus, match="403"),
            connect(f"ws://127.0.0.1:{port}", origin=origin, subprotocols=[f"viser-v{viser.__version__}"], proxy=None),
        ):
            pass
    for path in ("/../../../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/..\\..\\etc/passwd"):
        with socket.create_connection(("127.0.0.1", port), timeout=10) as plain:
            plain.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n".encode())
            assert b"root:" not in plain.recv(65_536)


def test_the_viewer_is_taken_out_of_its_wheel_on_loopback(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    # The wheel's program serves everybody unless it is told otherwise, and a second is enough for a scan.
    told: list[list[str]] = []

    def refuse(command: list[str], **_: object) -> None:
        told.append(command)
        raise OSError("not started")

    monkeypatch.setattr(viewer_files.subprocess, "Popen", refuse)
    with pytest.raises(OSError, match="not started"), viewer_files._wheel_server(tmp_path):
        pass
    (command,) = told
    assert command[command.index("--bind") + 1] == "127.0.0.1"


def test_no_address_of_the_machine_but_loopback_answers(served: Served) -> None:
    others = {
        each.address for cards in psutil.net_if_addrs().values() for each in cards if each.family == socket.AF_INET
    }
    for address in others - {"127.0.0.1"}:
        with pytest.raises(OSError), socket.create_connection((address, served.port), timeout=3):
            pass


def test_a_request_is_a_request() -> None:
    # The upstream of a scene is chosen by us, never by the address that was asked for.
    source = (ROOT / "workbench" / "viser_proxy.py").read_text()
    assert source.count("HTTPRequest(") == 1 and 'f"ws://127.0.0.1:{server.get_port()}"' in source
    assert HTTPRequest("ws://127.0.0.1:1").url == "ws://127.0.0.1:1"


def test_the_camera_of_a_scene_is_heard_through_the_door_and_a_press_is_not() -> None:
    # Where the camera is makes a client of the scene; without it, no picture could be asked for either.
    registry = ViserRegistry()
    heard: list[object] = []

    async def visit() -> None:
        sockets = bind_sockets(0, "127.0.0.1")
        front = HTTPServer(Application(viser_routes(registry)))
        front.add_sockets(sockets)
        name, scene = registry.open()
        scene.on_client_connect(lambda client: heard.append(client.client_id))
        press = scene.gui.add_button("never")
        press.on_click(lambda _event: heard.append("pressed"))
        address = f"ws://127.0.0.1:{sockets[0].getsockname()[1]}/viser/{name}"
        page = await websocket_connect(address, subprotocols=[f"viser-v{viser.__version__}"])
        for message in (
            {"type": "GuiUpdateMessage", "uuid": press._impl.uuid, "updates": {"value": True}},
            {"type": "ViewerCameraMessage", "wxyz": [1.0, 0.0, 0.0, 0.0], "position": [1.0, 2.0, 3.0], "fov": 1.0,
             "near": 0.1, "far": 1e3, "image_height": 9, "image_width": 16, "look_at": [0.0, 0.0, 0.0],
             "up_direction": [0.0, 0.0, 1.0]},
            {"type": "GuiUpdateMessage", "uuid": press._impl.uuid, "updates": {"value": True}},
        ):  # fmt: skip
            await page.write_message(msgspec.msgpack.encode(message), binary=True)
        for _ in range(300):
            if heard:
                break
            await asyncio.sleep(0.1)
        await asyncio.sleep(0.3)
        page.close()
        front.stop()

    asyncio.run(visit())
    registry.close_all()
    assert len(heard) == 1 and "pressed" not in heard
