"""Evaluations as processes of their own: each number is what the command beside it prints."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from workbench.launcher import environment
from workbench.reproduce.plan import Wanted

ENTRY: tuple[str, ...] = ("-m", "workbench")
"""What Python runs in front of `evaluate …`."""

FigureKey = tuple[str, str, int, int]
"""Policy (its digest, or its name if it is a rule), task, evaluation seed and episodes: equal keys, equal figures."""


@dataclass(frozen=True)
class Evaluation:
    """One call of `workbench evaluate`."""

    wanted: Wanted
    policy: str
    """POLICY as the command takes it here."""
    shown: str
    """POLICY as a reader would write it."""
    digest: str
    """Digest of the policy file; empty for a rule."""
    episodes: int

    @property
    def key(self) -> FigureKey:
        """Under which its figures are known."""
        return figure_key(self.digest or self.shown, self.wanted, self.episodes)

    @property
    def command(self) -> str:
        """The command line for a reader."""
        return " ".join(["workbench", *self.arguments(self.shown)])

    def arguments(self, policy: str) -> list[str]:
        """Arguments of `workbench`."""
        mask = ["--mask", ",".join(map(str, self.wanted.mask))] if self.wanted.mask else []
        numbers = ["--episodes", str(self.episodes), "--seed", str(self.wanted.evaluation_seed)]
        return ["evaluate", policy, *mask, *numbers]


def figure_key(policy: str, wanted: Wanted, episodes: int) -> FigureKey:
    """Key of the figures of a policy's digest or name."""
    return policy, wanted.task, wanted.evaluation_seed, episodes


@dataclass(frozen=True)
class Flown:
    """An evaluation that has ended."""

    evaluation: Evaluation
    figures: dict[str, Any] | None
    """What the command printed; None when it failed."""
    error: str = ""
    wall_s: float = 0.0
    """Time it took [s]."""


class Evaluator:
    """Runs evaluations side by side."""

    def __init__(self) -> None:
        self._working: list[tuple[Evaluation, subprocess.Popen[str], float]] = []

    @property
    def keys(self) -> set[FigureKey]:
        """What is being flown now."""
        return {evaluation.key for evaluation, _, _ in self._working}

    def start(self, evaluation: Evaluation) -> None:
        """Begin one."""
        command = [sys.executable, *ENTRY, *evaluation.arguments(evaluation.policy), "--json"]
        # A session of its own: Ctrl-C is for whoever reads the terminal. One thread: beside trainings more are slower.
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
            env=environment(), start_new_session=True,
        )  # fmt: skip
        self._working.append((evaluation, process, time.monotonic()))

    def ended(self) -> Sequence[Flown]:
        """Those that have ended since the last call."""
        over = [one for one in self._working if one[1].poll() is not None]
        self._working = [one for one in self._working if one not in over]
        return [_flown(evaluation, process, time.monotonic() - began_s) for evaluation, process, began_s in over]

    def stop(self) -> None:
        """End what is being flown."""
        for _, process, _ in self._working:
            process.kill()
            process.communicate()
        self._working.clear()


def _flown(evaluation: Evaluation, process: subprocess.Popen[str], wall_s: float) -> Flown:
    output, errors = process.communicate()
    try:
        if process.returncode == 0:
            return Flown(evaluation, json.loads(output), wall_s=wall_s)
    except ValueError:
        errors = f"it printed no JSON: {output[:200]}"
    last = errors.strip().splitlines()[-1:] or [f"exit code {process.returncode}"]
    return Flown(evaluation, None, f"evaluation of {evaluation.shown} failed: {last[0].removeprefix('workbench: ')}")
