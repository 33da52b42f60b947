#!/usr/bin/env python3
"""Take the pictures of docs/gallery: `python scripts/gallery.py RUNS`, a folder with finished runs.

Every page as it is at 1440 × 900 with those runs, and an index of the pictures. A server of its own shows copies of
the runs, so that nothing in RUNS is touched.
"""

from __future__ import annotations

import shutil
import sys
import tempfile
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from workbench.bench.page import browsing, ensure_browser, serving
from workbench.reproduce.places import ROOT
from workbench.runs import Run, RunStore

if TYPE_CHECKING:
    from playwright.sync_api import Page

GALLERY = ROOT / "docs" / "gallery"
SETTLE_MS = 3000
"""Pictures in three dimensions and curves move into place."""


@dataclass(frozen=True)
class Shot:
    """One picture."""

    name: str
    address: str
    """`{first}` and `{all}` become run ids."""
    ready: str
    """What must stand before the picture is taken."""
    words: str
    scroll_px: int = 0


SHOTS = (
    Shot(
        "fly", "fly?t=370&camera=chase-a", ".cover.gone", "Fly: what was learned beside the expert, while missiles fly"
    ),
    Shot("fly-light", "fly?t=372&theme=default", ".cover.gone", "Fly on a light page, the whole field"),
    Shot("fly-curves", "fly?t=372&curves=over", ".cover.gone", "Azimuth curves of both policies over each other", 620),
    Shot("curriculum", "curriculum?mask=3,4", ".stage", "Curriculum: two missiles masked, and what is left"),
    Shot("live", "live?run={first}", "[aria-label=Trainings]", "Live: a curriculum, stage by stage"),
    Shot("runs", "runs?group=variant&show={all}", ".sheet .row", "Runs: grouped, with curves over each other"),
    Shot("compare", "compare", "a.shot", "Compare: Fig. 13 for any policies and tasks"),
    Shot("compare-closely", "compare", "a.shot", "Each engagement of a comparison is a click from Fly", 560),
    Shot("paper", "paper", "[data-verdict]", "Paper: which of the paper's points hold here"),
    Shot("paper-table-4", "paper?section=table4", ".part", "Table 4, ours beside the paper's"),
)


def finished(store: RunStore) -> list[Run]:
    """Runs that have a policy to show, oldest first."""
    good = [run for run in store.list() if not run.problem and run.state.state == "finished"]
    return sorted(good, key=lambda run: run.id)


def take(page: Page, base: str, runs: list[Run]) -> Iterator[tuple[Shot, bytes]]:
    """Open one address after the other and photograph it."""
    ids = {"first": runs[0].id, "all": ",".join(run.id for run in runs[:4])}
    for shot in SHOTS:
        page.goto(base + shot.address.format(**ids))
        page.locator(shot.ready).first.wait_for(state="attached")
        page.wait_for_timeout(SETTLE_MS)
        if shot.scroll_px:
            page.mouse.move(700, 880)  # below the replay, whose wheel zooms
            page.mouse.wheel(0, shot.scroll_px)
            page.wait_for_timeout(SETTLE_MS / 3)
        yield shot, page.screenshot()


def write_index() -> None:
    """docs/gallery/README.md: all pictures under each other."""
    lines = ["# Gallery", "", "Made by `python scripts/gallery.py RUNS`.", ""]
    for shot in SHOTS:
        lines += [f"## {shot.words}", "", f"![{shot.words}]({shot.name}.png)", ""]
    (GALLERY / "README.md").write_text("\n".join(lines[:-1]) + "\n", "utf-8")


def main(arguments: list[str]) -> int:
    """Copy the runs, serve them, photograph; returns the exit code."""
    runs = finished(RunStore(Path(arguments[0]))) if len(arguments) == 1 and Path(arguments[0]).is_dir() else []
    if not runs:
        print("usage: python scripts/gallery.py RUNS, a folder with finished runs", file=sys.stderr)
        return 2
    chromium = ensure_browser()
    GALLERY.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="workbench-gallery-") as folder:
        for run in runs:
            shutil.copytree(run.path, Path(folder) / "runs" / run.id, ignore=shutil.ignore_patterns("checkpoints"))
        with serving(Path(folder)) as server, browsing(chromium) as page:
            page.goto(server.link)
            for shot, picture in take(page, server.link.partition("?")[0], runs):
                (GALLERY / f"{shot.name}.png").write_bytes(picture)
                print(f"{shot.name}.png")
    write_index()
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
