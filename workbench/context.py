"""What every page of one running server shares: the runs, the recordings and the live 3-D scenes."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from workbench.recordings import Recordings
from workbench.runs import RunStore
from workbench.viser_proxy import ViserRegistry


@dataclass(frozen=True)
class AppContext:
    """Made once by the server and handed to each page."""

    store: RunStore
    recordings: Recordings = field(default_factory=Recordings)
    viser: ViserRegistry = field(default_factory=ViserRegistry)

    @classmethod
    def of(cls, runs: Path) -> AppContext:
        """The context of a server for the runs folder `runs`."""
        return cls(RunStore(runs))
