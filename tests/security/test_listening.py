"""S1: whatever is running, only this machine can reach it."""

from __future__ import annotations

import psutil

from tests.conftest import Served


def test_every_listening_socket_of_the_process_tree_is_loopback(served: Served) -> None:
    assert served.ask("/rerun/").status == 200  # the viewer's files are being fetched from the wheel, or were
    root = psutil.Process(served.process.pid)
    sockets = [socket for process in (root, *root.children(recursive=True)) for socket in _listening(process)]
    assert sockets
    assert {socket.laddr.ip for socket in sockets} <= {"127.0.0.1", "::1"}


def _listening(process: psutil.Process) -> list[psutil._common.pconn]:
    return [socket for socket in process.net_connections("inet") if socket.status == psutil.CONN_LISTEN]
