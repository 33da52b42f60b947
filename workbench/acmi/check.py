"""Is an ACMI 2.2 text sound? Tacview forgives most mistakes in silence; its pictures and its shot log do not."""

from __future__ import annotations

import math
from collections import Counter

import numpy as np

from sim.trajectory import Trajectory
from workbench.acmi.bodies import EVADER, INTERCEPTOR, flown, missile_id
from workbench.acmi.read import logical_lines, places, properties, transform_fields

CLASSES = ("Air", "Ground", "Sea", "Weapon", "Sensor", "Navaid", "Misc")
EVENTS = ("Message", "Bookmark", "Debug", "LeftArea", "Destroyed", "TakenOff", "Landed", "Timeout")
REFERENCES = ("Parent", "LockedTarget")
TOLERANCE_M = 1.0


def check_acmi(text: str) -> list[str]:
    """What is wrong with a recording, a sentence each, in the order of its lines; empty when it is sound."""
    check = _Check()
    lines = list(logical_lines(text))
    check.header(lines)
    for number, line in lines[2:]:
        check.line(number, line)
    check.end()
    return check.problems


def check_positions(text: str, flight: Trajectory) -> list[str]:
    """Bodies that a recording, read with straight lines between its frames, puts more than 1 m from their place."""
    written, problems = places(text), []
    tracks = {EVADER: flight.evader, INTERCEPTOR: flight.interceptor}
    for ident, track in (tracks | {missile_id(m.number): m for m in flight.missiles}).items():
        seen = flown(track)
        if not len(seen):
            continue
        if ident not in written:
            problems.append(f"object {ident} is missing")
            continue
        time_s, found = written[ident]
        read = np.stack([np.interp(flight.time_s[seen], time_s, column) for column in found.T], axis=1)
        for name, columns in (("longitude and latitude", (0, 1, 4)), ("U and V", (2, 3, 4))):
            error_m = np.linalg.norm(read[:, columns] - track.position_m[seen], axis=1)
            if not error_m.max() <= TOLERANCE_M:
                at = flight.time_s[seen][int(np.nan_to_num(error_m, nan=math.inf).argmax())]
                problems.append(f"object {ident} is {error_m.max():.1f} m off at {at:.2f} s by {name}")
    return problems


class _Check:
    """Reads a recording once, as Tacview does, and remembers what lives."""

    def __init__(self) -> None:
        self.problems: list[str] = []
        self._time_s = -math.inf
        self._types: dict[int, str] = {}
        self._parents: dict[int, int] = {}
        self._removed: set[int] = set()
        self._destroyed: dict[int, int] = {}
        self._killed: dict[int, int] = {}
        self._outcomes: Counter[int] = Counter()
        """Timeout outcomes of this frame, by launcher, whose missile has not been removed yet."""

    def header(self, lines: list[tuple[int, str]]) -> None:
        texts = [line for _number, line in lines[:3]] + [""] * 3
        if texts[0] != "FileType=text/acmi/tacview":
            self._say(1, f"'{texts[0]}' must be FileType=text/acmi/tacview")
        if not texts[1].startswith("FileVersion=2."):
            self._say(2, f"'{texts[1]}' must be FileVersion=2.2")
        if not texts[2].startswith("0,ReferenceTime="):
            self._say(3, f"'{texts[2]}' must be the ReferenceTime")

    def line(self, number: int, line: str) -> None:
        if line.startswith("#"):
            self._frame(number, line[1:])
            return
        removal = line.startswith("-")
        name, given = properties(line.removeprefix("-"))
        ident = self._ident(number, name)
        if ident is None:
            return
        if removal:
            self._remove(number, ident)
        elif ident == 0:
            if "Event" in given:
                self._event(number, given["Event"])
        else:
            self._object(number, ident, given)

    def end(self) -> None:
        self._settle(0)
        for ident in self._types.keys() - self._removed:
            kind = self._types[ident]
            if kind.startswith("Weapon"):
                self._say(0, f"weapon {ident:x} has no Timeout outcome and is never removed")
            elif kind == "Misc+Explosion":
                self._say(0, f"explosion {ident:x} is never removed")
        for target, number in self._killed.items():
            if target not in self._destroyed:
                self._say(number, f"object {target:x} is killed but no Destroyed event tells of it")
        for target, number in (self._killed | self._destroyed).items():
            if target not in self._removed:
                self._say(number, f"object {target:x} is destroyed but never removed")

    def _say(self, number: int, sentence: str) -> None:
        self.problems.append(f"line {number}: {sentence}" if number else sentence)

    def _ident(self, number: int, name: str) -> int | None:
        try:
            return int(name, 16)
        except ValueError:
            self._say(number, f"id '{name}' is not hexadecimal")
            return None

    def _frame(self, number: int, text: str) -> None:
        time_s = _number(text)
        if not math.isfinite(time_s):
            self._say(number, f"frame '{text}' is not a time")
        elif time_s < self._time_s:
            self._say(number, f"frame {text} lies before the frame at {self._time_s:g}")
        elif time_s > self._time_s:
            self._settle(number)
            self._time_s = time_s

    def _settle(self, number: int) -> None:
        for launcher, left in self._outcomes.items():
            if left:
                self._say(number, f"launcher {launcher:x} has {left} Timeout outcome without a weapon removed with it")
        self._outcomes.clear()

    def _remove(self, number: int, ident: int) -> None:
        if not self._lives(number, ident, "removed"):
            return
        self._removed.add(ident)
        if self._types[ident].startswith("Weapon"):
            launcher = self._parents.get(ident, 0)
            if not self._outcomes[launcher]:
                self._say(number, f"weapon {ident:x} is removed without a Timeout outcome")
            else:
                self._outcomes[launcher] -= 1

    def _lives(self, number: int, ident: int, what: str) -> bool:
        if ident in self._types and ident not in self._removed:
            return True
        when = "after its removal" if ident in self._removed else "before it was created"
        self._say(number, f"object {ident:x} is {what} {when}")
        return False

    def _object(self, number: int, ident: int, given: dict[str, str]) -> None:
        if ident in self._removed:
            self._say(number, f"object {ident:x} is updated after its removal")
        elif ident not in self._types:
            self._create(number, ident, given)
        for name, value in given.items():
            if name == "T":
                self._transform(number, ident, value)
            elif name in REFERENCES and (other := self._ident(number, value)):
                self._lives(number, other, f"used as {name}")
            elif not math.isfinite(_number(value, otherwise=0.0)):
                self._say(number, f"{name} of object {ident:x} is {value}")

    def _create(self, number: int, ident: int, given: dict[str, str]) -> None:
        if "T" not in given or "Type" not in given:
            self._say(number, f"object {ident:x} is used before it was created: its first line needs T and Type")
        kind = self._types[ident] = given.get("Type", "")
        tags = kind.split("+")
        if kind and (tags[0] not in CLASSES or not all(tag.isalnum() for tag in tags)):
            self._say(number, f"type '{kind}' of object {ident:x} is not tags joined by +, beginning with a class")
        if tags[0] == "Weapon":
            if "Parent" not in given:
                self._say(number, f"weapon {ident:x} has no Parent")
            else:
                self._parents[ident] = self._ident(number, given["Parent"]) or 0

    def _transform(self, number: int, ident: int, value: str) -> None:
        try:
            fields = transform_fields(value)
        except ValueError as error:
            self._say(number, f"T of object {ident:x}: {error}")
            return
        if not all(math.isfinite(field) for field in fields.values()):
            self._say(number, f"T of object {ident:x} is {value}")

    def _event(self, number: int, value: str) -> None:
        kind, *parts = value.split("|")
        if kind not in EVENTS:
            self._say(number, f"event '{kind}' is unknown; legal are {', '.join(EVENTS)}")
        elif kind == "Timeout":
            self._timeout(number, dict(part.split(":", 1) for part in parts if ":" in part))
        elif kind not in ("Bookmark", "Debug"):
            ident = self._ident(number, parts[0] if parts else "")
            if ident is not None and self._lives(number, ident, f"named in {kind}") and kind == "Destroyed":
                self._destroyed[ident] = number

    def _timeout(self, number: int, given: dict[str, str]) -> None:
        launcher = self._ident(number, given.get("SourceId", "")) or 0
        target = self._ident(number, given.get("TargetId", "")) or 0
        for ident in (launcher, target):
            self._lives(number, ident, "named in Timeout")
        self._outcomes[launcher] += 1
        if given.get("Outcome") not in ("Kill", "Miss"):
            self._say(number, f"outcome '{given.get('Outcome', '')}' is unknown; legal are Kill and Miss")
        if given.get("Outcome") == "Kill":
            self._killed[target] = number


def _number(text: str, otherwise: float = math.nan) -> float:
    try:
        return float(text)
    except ValueError:
        return otherwise
