"""What every page of one running server shares: runs and their index, recordings, live 3-D scenes, comparisons."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from workbench.comparison.queue import ComparisonQueue
from workbench.recordings import Recordings
from workbench.run_index.index import RunIndex
from workbench.runs import RunStore
from workbench.viser_proxy import ViserRegistry


@dataclass(frozen=True)
class AppContext:
    """Made once by the server and handed to each page."""

    store: RunStore
    recordings: Recordings = field(default_factory=Recordings)
    viser: ViserRegistry = field(default_factory=ViserRegistry)
    index: RunIndex = field(init=False)
    """Of the runs of `store`; not opened before it is asked."""
    comparisons: ComparisonQueue = field(init=False)
    """What is flown for the Compare page."""

    def __post_init__(self) -> None:
        """Give the runs their index and their queue."""
        object.__setattr__(self, "index", RunIndex(self.store.root))
        object.__setattr__(self, "comparisons", ComparisonQueue(self.store.root))

    @classmethod
    def of(cls, runs: Path) -> AppContext:
        """The context of a server for the runs folder `runs`."""
        return cls(RunStore(runs))
