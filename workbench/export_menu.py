"""The menu that saves the flights of a page as files; long work is another process, and shows how long it takes."""

from __future__ import annotations

import asyncio
import json
import sys
import tempfile
import time
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

from layouts.letters import letters
from sim.errors import SubMasError
from sim.trajectory import Trajectory
from workbench.branch import branch_of
from workbench.export_job import Order
from workbench.export_name import export_name
from workbench.exports import TOGETHER, encode

DRAWN = frozenset({".gif", ".mp4"})
"""Formats that take many seconds: made by a process of their own, which flies the same engagements again."""

ALL = "all"
CHOICES = (
    (".html", "Replay, for any browser", "html"),
    (".gif", "Animation", "gif"),
    (".mp4", "Film", "mp4"),
    (".rrd", "Recording for Rerun", "rrd"),
    (".zip.acmi", "Recording for Tacview", "acmi"),
    (".parquet", "Table with all its bits", "parquet"),
    (".csv", "Table", "csv"),
    (".png", "Picture", "png"),
    (".svg", "Drawing", "svg"),
)
"""Suffix, words and format name of every entry: first what holds all flights, then what holds one."""


class ExportMenu(JSComponent):
    """A button with the formats; what is chosen is made and handed to the browser, which saves it."""

    choices = param.List(default=[{"suffix": s, "all": s in TOGETHER, "words": w, "kind": k} for s, w, k in CHOICES])
    who = param.List(default=[], item_type=str, doc="letters of the flights that can be saved one by one")
    asked = param.List(default=[], doc="suffix, a letter or `all`, and a number that counts; set by the browser")
    busy = param.String(default="", doc="what is being made, or why it was not; empty when there is nothing to say")
    share = param.Number(default=-1.0, doc="how much of it is done, 0 to 1; below 0 when nothing is being made")
    file = param.Dict(default={}, doc="`name` and `data` of the file to save")

    _esm = Path(__file__).with_suffix(".js")
    _stylesheets: ClassVar[list[str]] = [Path(__file__).with_suffix(".css").read_text("utf-8")]

    def offer(self, a: Trajectory, b: Trajectory, query: Mapping[str, str], runs: Path) -> None:
        """The flights to save from now on, without a branch, and how the page's address asks for them."""
        self._both, self._query, self._runs = (a, b), dict(query), runs
        self.offer_branch(None)

    def offer_branch(self, branch: Trajectory | None) -> None:
        """The branch beside them; None when there is none any more."""
        shown = [*self._both, *([branch] if branch else [])]
        self._flights = dict(zip(letters(shown), shown, strict=True))
        self.who = list(self._flights)

    @param.depends("asked", watch=True)
    async def _make(self) -> None:
        if not self.who or not self.asked or self.share >= 0.0:
            return
        suffix, who = str(self.asked[0]), str(self.asked[1])
        whose = {ALL} if suffix in TOGETHER else self._flights.keys()
        if suffix not in {choice[0] for choice in CHOICES} or who not in whose:
            return
        chosen = list(self._flights.values()) if who == ALL else [self._flights[who]]
        name = export_name(chosen, "" if who == ALL else who, suffix)
        self.param.update(busy=f"Making {suffix} …", share=0.0)
        try:
            made = self._drawn(suffix) if suffix in DRAWN else asyncio.to_thread(_encoded, chosen, suffix)
            self.param.update(file={"name": name, "data": await made}, busy="")
        except SubMasError as error:
            self.busy = f"{error}."
        finally:
            self.share = -1.0

    async def _drawn(self, suffix: str) -> bytes:
        with tempfile.TemporaryDirectory() as folder:
            out = Path(folder) / f"flight{suffix}"
            branch = next(filter(None, map(branch_of, self._flights.values())), None)
            order = Order(self._query, asdict(branch) if branch else None, str(self._runs), str(out))
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


def _encoded(flights: list[Trajectory], suffix: str) -> bytes:
    return encode(flights[0], suffix, *flights[1:])
