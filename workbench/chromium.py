"""Which Chromium there is: for browser tests, and for films and pictures of flights."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
HEADLESS_FLAGS = (
    "--no-first-run",
    "--disable-quic",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--use-gl=angle",  # WebGL without a graphics card
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    # Without a card a browser paints plain canvases itself. Through WebGL's software each stroke waits for two threads:
    # after a map of thousands of fields the next page of a busy machine came up after fifty seconds instead of three.
    "--disable-accelerated-2d-canvas",
)
MISSING = "no Chromium found; install it (Debian: apt-get install chromium), or set CHROMIUM to the program's path"


def find_chromium() -> Path | None:
    """The program named by `$CHROMIUM`, else one that is installed, else the one that Playwright has downloaded."""
    if chosen := os.environ.get("CHROMIUM"):
        return Path(chosen) if os.access(chosen, os.X_OK) else None
    for name in NAMES:
        if found := shutil.which(name):
            return Path(found)
    return _downloaded_by_playwright()


def _downloaded_by_playwright() -> Path | None:
    folder = Path(os.environ.get("PLAYWRIGHT_BROWSERS_PATH") or Path.home() / ".cache/ms-playwright")
    programs = sorted(folder.glob("chromium-*/chrome-linux*/chrome"))
    return programs[-1] if programs else None


def headless_flags() -> list[str]:
    """Flags for a Chromium nobody looks at; only root, for whom it would not start, goes without sandbox."""
    return [*HEADLESS_FLAGS, *(["--no-sandbox"] if hasattr(os, "geteuid") and os.geteuid() == 0 else [])]
