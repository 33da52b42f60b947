"""Live scenes are reached through the front door, and only through it."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator

import pytest
import viser
from tornado.httpclient import AsyncHTTPClient, HTTPClientError
from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets
from tornado.web import Application
from tornado.websocket import websocket_connect
from websockets.exceptions import InvalidStatus
from websockets.sync.client import connect

from workbench.viser_proxy import ViserRegistry, viser_routes

PROTOCOL = f"viser-v{viser.__version__}"


@pytest.fixture(scope="module")
def registry() -> Iterator[ViserRegistry]:
    scenes = ViserRegistry()
    yield scenes
    scenes.close_all()
    assert not scenes


@pytest.fixture(scope="module")
def scene(registry: ViserRegistry) -> str:
    name, server = registry.open()
    server.scene.add_label("/evader", "evader")
    return name


async def _front(registry: ViserRegistry) -> tuple[HTTPServer, str]:
    sockets = bind_sockets(0, "127.0.0.1")
    server = HTTPServer(Application(viser_routes(registry)))
    server.add_sockets(sockets)
    return server, f"127.0.0.1:{sockets[0].getsockname()[1]}"


def test_a_scene_is_passed_on(registry: ViserRegistry, scene: str) -> None:
    async def visit() -> None:
        server, host = await _front(registry)
        page = await AsyncHTTPClient().fetch(f"http://{host}/viser/{scene}/")
        assert b"<html" in page.body
        socket = await websocket_connect(f"ws://{host}/viser/{scene}", subprotocols=[PROTOCOL])
        assert socket.selected_subprotocol == PROTOCOL
        assert isinstance(await asyncio.wait_for(socket.read_message(), 10), bytes)
        socket.close()
        while await asyncio.wait_for(socket.read_message(), 10) is not None:
            pass
        server.stop()
        await server.close_all_connections()

    asyncio.run(visit())


def test_an_unknown_scene_is_not_found(registry: ViserRegistry) -> None:
    async def visit() -> None:
        server, host = await _front(registry)
        with pytest.raises(HTTPClientError, match="404"):
            await AsyncHTTPClient().fetch(f"http://{host}/viser/abcdefgh/")
        with pytest.raises(HTTPClientError, match="404"):
            await websocket_connect(f"ws://{host}/viser/abcdefgh")
        server.stop()

    asyncio.run(visit())


@pytest.mark.parametrize("origin", [None, "null", "http://127.0.0.1:5006", "http://localhost", "http://evil.example"])
def test_nobody_passes_the_front_door_by(registry: ViserRegistry, scene: str, origin: str | None) -> None:
    address = f"ws://127.0.0.1:{registry[scene].get_port()}"
    with (
        pytest.raises(InvalidStatus, match="403"),
        connect(address, origin=origin, subprotocols=[PROTOCOL], proxy=None),
    ):
        pass


def test_the_public_tunnel_is_never_opened(registry: ViserRegistry, scene: str) -> None:
    assert registry[scene].request_share_url() is None


def test_a_closed_scene_is_gone(registry: ViserRegistry) -> None:
    name, _server = registry.open()
    registry.close(name)
    registry.close(name)
    assert name not in registry
