"""The menu that saves the flights of a page as files; long work is another process, and shows how long it takes."""

from __future__ import annotations

import asyncio
import json
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

from sim.errors import SubMasError
from sim.trajectory import Trajectory
from workbench.exports import TOGETHER, encode

DRAWN = frozenset({".gif", ".mp4"})
"""Formats that take many seconds: made by a process of their own, which flies the same engagements again."""

CHOICES = (
    (".html", "AB", "Replay of both, for any browser", "html"),
    (".gif", "AB", "Animation of both", "gif"),
    (".mp4", "AB", "Film of both", "mp4"),
    (".rrd", "AB", "Recording of both for Rerun", "rrd"),
    *((suffix, who, f"{who} · {words}", suffix[1:]) for who in "AB" for suffix, words in (
        (".zip.acmi", "recording for Tacview"), (".parquet", "table with all its bits"), (".csv", "table"),
        (".png", "picture"), (".svg", "drawing"),
    )),
)  # fmt: skip
"""Suffix, flights, words and format name of every entry."""


@dataclass(frozen=True)
class Order:
    """What a process of its own shall fly and draw."""

    a: str
    b: str
    masked: tuple[int, ...]
    seed: int
    scenario: str
    runs: str
    out: str


class ExportMenu(JSComponent):
    """A button with the formats; what is chosen is made and handed to the browser, which saves it."""

    choices = param.List(default=[{"suffix": s, "who": w, "words": t, "kind": k} for s, w, t, k in CHOICES])
    asked = param.List(default=[], doc="suffix, flights and a number that counts; set by the browser")
    busy = param.String(default="", doc="what is being made, or why it was not; empty when there is nothing to say")
    share = param.Number(default=-1.0, doc="how much of it is done, 0 to 1; below 0 when nothing is being made")
    file = param.Dict(default={}, doc="`name` and `data` of the file to save")
    ready = param.Boolean(default=False, doc="whether flights are shown that can be saved")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]

    def offer(self, a: Trajectory, b: Trajectory, specs: tuple[str, str], runs: Path, scenario: str) -> None:
        """The flights to save from now on, who flies them and where their scenario is."""
        self._flights, self._specs, self._runs, self._scenario = (a, b), specs, runs, scenario
        self.ready = True

    @param.depends("asked", watch=True)
    async def _make(self) -> None:
        if not self.ready or not self.asked or self.share >= 0.0:
            return
        suffix, who = str(self.asked[0]), str(self.asked[1])
        if (suffix, who) not in {(one[0], one[1]) for one in CHOICES}:
            return
        self.param.update(busy=f"Making {suffix} …", share=0.0)
        try:
            data = await (self._drawn(suffix) if suffix in DRAWN else asyncio.to_thread(self._encoded, suffix, who))
            self.param.update(busy="", file={"name": f"flight-{self._flights[0].seed}{suffix}", "data": data})
        except SubMasError as error:
            self.busy = f"{error}."
        finally:
            self.share = -1.0

    def _encoded(self, suffix: str, who: str) -> bytes:
        a, b = self._flights
        if suffix in TOGETHER:
            return encode(a, suffix, b)
        return encode(a if who == "A" else b, suffix)

    async def _drawn(self, suffix: str) -> bytes:
        with tempfile.TemporaryDirectory() as folder:
            out, task = Path(folder) / f"flight{suffix}", self._flights[0].task
            masked, seed = tuple(sorted(task.masked)), self._flights[0].seed
            order = Order(*self._specs, masked, seed, self._scenario, str(self._runs), str(out))
            command = [sys.executable, "-m", "workbench.export_job", json.dumps(asdict(order))]
            process = await asyncio.create_subprocess_exec(
                *command, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.PIPE
            )
            try:
                await self._follow(process, suffix)
                complaint = await process.stderr.read() if process.stderr else b""
                if await process.wait() != 0 or not out.is_file():
                    lines = complaint.decode(errors="replace").strip().splitlines()
                    raise SubMasError(lines[-1] if lines else f"the {suffix} could not be made")
                return out.read_bytes()
            finally:
                if process.returncode is None:
                    process.kill()

    async def _follow(self, process: asyncio.subprocess.Process, suffix: str) -> None:
        begin: Any = None
        while process.stdout and (line := await process.stdout.readline()):
            done, total = (int(word) for word in line.split())
            begin = begin or time.monotonic()
            left_s = (time.monotonic() - begin) / max(done - 1, 1) * (total - done)
            left = f", about {left_s:.0f} s left" if done > 1 else ""
            words = f"Drawing {suffix}: {100 * done // total} %{left}"
            self.param.update(busy=words, share=done / total)
