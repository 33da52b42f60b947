"""Make sure that the browser tests have a Chromium: one that is there, else Debian's, else Playwright's own."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys

from workbench.chromium import MISSING, find_chromium

APT = ["apt-get", "-qq", "-o", "Dpkg::Use-Pty=0"]


def _attempts() -> list[list[str]]:
    attempts = [[sys.executable, "-m", "playwright", "install", "chromium"]]
    if shutil.which("apt-get") and os.geteuid() == 0:
        attempts.insert(0, [*APT, "update"])
        attempts.insert(1, [*APT, "install", "--yes", "--no-install-recommends", "chromium"])
    return attempts


def main() -> int:
    """0 when there is a Chromium at the end."""
    for command in [] if find_chromium() else _attempts():
        print("$", " ".join(command), file=sys.stderr)
        environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
        subprocess.run(command, env=environment, stdin=subprocess.DEVNULL, stdout=sys.stderr, check=False)
        if find_chromium():
            break
    if find_chromium() is None:
        print(MISSING, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
