"""How the Fly page is looked at, as its address says it: camera, what is drawn, how curves are shown, speed."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from typing import Any

from layouts.scene_bodies import Additions

CAMERAS = ("overview", "top", "chase-a", "chase-b", "chase-branch", "free")
ADDITIONS = tuple(field.name for field in fields(Additions))
READOUTS = "readouts"
DRAWN = (READOUTS, *ADDITIONS)
"""What a person can add to the replay and take away, by its name in the address."""
USUAL = frozenset({READOUTS, *(field.name for field in fields(Additions) if field.default)})
TABS = ("azimuth", "range", "speed", "control", "reward", "map", "rerun")
SPEEDS = (1, 10, 30, 60)
"""Seconds of flight per second of watching that a person may choose."""

EYE_LIMIT_KM = 5000.0


@dataclass(frozen=True)
class FlyLook:
    """Camera, what is drawn, and how curves are shown."""

    camera: str = "overview"
    eye: tuple[float, ...] = ()
    """Of a free camera: where it is and what it looks at, x, y, z each [km]; empty when it was not moved yet."""
    drawn: frozenset[str] = USUAL
    """Of `DRAWN`."""
    one_field: bool = False
    """Both flights on one battlefield."""
    over: bool = False
    """Both flights in one figure."""
    whole: bool = False
    """Curves of whole flights instead of the time in which missiles fly."""
    tab: str = TABS[0]
    speed: int = 30

    @property
    def additions(self) -> Additions:
        """What is drawn in the scene."""
        return Additions(**{name: name in self.drawn for name in ADDITIONS})

    def to_query(self) -> dict[str, str]:
        """Values of the address; what is as usual is empty, and left out of it."""
        return {
            "camera": self.camera if self.camera != CAMERAS[0] else "",
            "eye": ",".join(f"{value:.1f}" for value in self.eye) if self.camera == "free" else "",
            "hide": ",".join(name for name in DRAWN if name in USUAL - self.drawn),
            "show": ",".join(name for name in DRAWN if name in self.drawn - USUAL),
            "field": "one" if self.one_field else "",
            "curves": "over" if self.over else "",
            "span": "whole" if self.whole else "",
            "tab": self.tab if self.tab != TABS[0] else "",
            "speed": str(self.speed) if self.speed != FlyLook.speed else "",
        }


def read_look(query: Mapping[str, str]) -> tuple[FlyLook, list[str]]:
    """The look of an address, and a sentence for each value that was wrong and is ignored."""
    problems: list[str] = []

    def choice(name: str, known: tuple[str, ...], default: str) -> str:
        value = query.get(name, "")
        if value and value not in known:
            wrong = f"{name.capitalize()} '{value[:60]}'"
            problems.append(f"{wrong} is not one of {', '.join(known)}, so {default} is taken.")
        return value if value in known else default

    look = FlyLook(
        camera=choice("camera", CAMERAS, CAMERAS[0]),
        one_field=choice("field", ("one", "two"), "two") == "one",
        over=choice("curves", ("side", "over"), "side") == "over",
        whole=choice("span", ("missiles", "whole"), "missiles") == "whole",
        tab=choice("tab", TABS, TABS[0]),
        speed=int(choice("speed", tuple(map(str, SPEEDS)), str(FlyLook.speed))),
    )
    hidden, shown = (_names(query.get(name, ""), name, problems) for name in ("hide", "show"))
    look = replace(look, drawn=(USUAL - hidden) | shown)
    return (replace(look, eye=_eye(query.get("eye", ""), problems)) if look.camera == "free" else look), problems


def frame_values(look: FlyLook) -> dict[str, Any]:
    """The look as the values of a `FlightFrame`."""
    drawn = [name for name in DRAWN if name in look.drawn]
    return {"camera": look.camera, "eye": list(look.eye), "drawn": drawn, "overlay": look.one_field}


def looked(frame: Any) -> dict[str, Any]:
    """The values of a `FlightFrame`, which a browser has set, as fields of a look; unknown ones are left out."""
    camera = frame.camera if frame.camera in CAMERAS else CAMERAS[0]
    drawn = frozenset(frame.drawn) & set(DRAWN)
    return {"camera": camera, "eye": tuple(frame.eye), "drawn": drawn, "one_field": bool(frame.overlay)}


def _names(text: str, name: str, problems: list[str]) -> frozenset[str]:
    names = frozenset(filter(None, text.split(",")))
    if unknown := sorted(names - set(DRAWN)):
        problems.append(f"There is no '{unknown[0][:60]}' to {name}; there are {', '.join(DRAWN)}.")
    return names & set(DRAWN)


def _eye(text: str, problems: list[str]) -> tuple[float, ...]:
    if not text:
        return ()
    try:
        eye = tuple(float(part) for part in text.split(","))
    except ValueError:
        eye = ()
    if len(eye) == 6 and all(math.isfinite(value) and abs(value) <= EYE_LIMIT_KM for value in eye):
        return eye
    problems.append(f"Eye '{text[:60]}' is not six numbers of kilometres, so the camera starts at the overview.")
    return ()
