"""`workbench serve`: the pages, at an address on this machine."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from workbench.server import serve


@dataclass(frozen=True)
class Args:
    """Serve the pages on this machine (127.0.0.1) and open them in the browser.

    The printed address holds a token that changes at every start.
    From another machine: ssh -L 5006:localhost:5006 HOST.
    """

    port: int = 5006
    """Port to listen on; 0 takes any free one."""
    runs: Path = Path("runs")
    """Folder of the runs."""
    host: str = "127.0.0.1"
    """Always this machine: any other address is refused with the way to reach the pages from elsewhere."""
    no_browser: bool = False
    """Only print the address."""


def run(args: Args) -> int:
    """Serve until interrupted."""
    return serve(args.runs, args.port, browser=not args.no_browser, host=args.host)
