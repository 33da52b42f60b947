"""The validator of Tacview recordings goes red for every single rule."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from sim.world import Outcome
from tests.workbench.flights import ending
from workbench.acmi.check import check_acmi, check_positions
from workbench.acmi.document import acmi_text

SOUND = """FileType=text/acmi/tacview
FileVersion=2.2
0,ReferenceTime=2026-01-01T12:00:00Z
0,Title=two shots\\, one kill
// a comment
#0.00
a1,T=-0.4|0.01|8000|0|0|90|-44528|1113.2|90,Type=Air+FixedWing,Name=F-16C,Health=1
b1,T=0.4|0|8000|0|0|270|44528|0|270,Type=Air+FixedWing,Name=F-16C,LockedTarget=a1
e1,T=0.9|0|0,Type=Navaid+Static+Waypoint,Name=Exit
#40.00
c1,T=0.3|0|8000|0|0|270|33396|0|270,Type=Weapon+Missile,Name=AIM-120C,Parent=b1,LockedTarget=a1
0,Event=Message|b1|Fox 3
#41.00
a1,T=-0.39|||-62||12|-43414.8||12,TAS=281.2
c2,T=0.3|0|8000|0|0|270|33396|0|270,Type=Weapon+Missile,Name=AIM-120C,Parent=b1
#86.40
0,Event=Timeout|SourceId:b1|AmmoType:FOX3|AmmoCount:1|TargetId:a1|Outcome:Miss
0,Event=LeftArea|c1|
-c1
#90.00
0,Event=Timeout|SourceId:b1|AmmoType:FOX3|AmmoCount:1|TargetId:a1|Outcome:Kill
a1,Health=0
0,Event=Destroyed|a1|
f1,T=-0.3|0.01|8000,Type=Misc+Explosion,Radius=20
-c2
-a1
0,Event=Bookmark|all over
#92.00
-f1
"""


def test_a_sound_recording_has_no_problems() -> None:
    assert check_acmi(SOUND) == []
    assert check_acmi("\ufeff" + SOUND) == []


MISS = "0,Event=Timeout|SourceId:b1|AmmoType:FOX3|AmmoCount:1|TargetId:a1|Outcome:Miss\n"
BROKEN = [
    ("FileType=text/acmi/tacview\n", "", "line 1: 'FileVersion=2.2' must be FileType"),
    ("FileVersion=2.2\n", "FileVersion=1.4\n", "line 2: 'FileVersion=1.4' must be"),
    ("0,ReferenceTime=2026-01-01T12:00:00Z\n", "", "line 3: "),
    ("#41.00", "#39.99", "frame 39.99 lies before the frame at 40"),
    ("#41.00", "#soon", "frame 'soon' is not a time"),
    ("#41.00", "#nan", "frame 'nan' is not a time"),
    ("#40.00\nc1,", "#40.00\nc1,TAS=500\nc1,", "object c1 is used before it was created"),
    (",Type=Air+FixedWing,Name=F-16C,Health=1", "", "object a1 is used before it was created"),
    ("LockedTarget=a1\ne1", "LockedTarget=a2\ne1", "object a2 is used as LockedTarget before it was created"),
    ("-f1\n", "-f1\n-f2\n", "object f2 is removed before it was created"),
    ("0,Event=LeftArea|c1|", "0,Event=LeftArea|c9|", "object c9 is named in LeftArea before it was created"),
    ("#92.00\n", "#92.00\na1,TAS=0\n", "object a1 is updated after its removal"),
    ("-f1\n", "-f1\n-f1\n", "object f1 is removed after its removal"),
    ("#92.00\n", "#92.00\n0,Event=Message|a1|ghost\n", "object a1 is named in Message after its removal"),
    ("|||-62||12|", "|nan||-62||12|", "T of object a1 is -0.39|nan||-62||12"),
    ("TAS=281.2", "TAS=nan", "TAS of object a1 is nan"),
    ("TAS=281.2", "TAS=-inf", "TAS of object a1 is -inf"),
    ("T=-0.39|||-62||12|-43414.8||12", "T=-0.39|||-62", "T of object a1: has 4 fields, legal are 3, 5, 6 and 9"),
    ("T=-0.39|", "T=west|", "T of object a1: could not convert"),
    (",Parent=b1\n", "\n", "weapon c2 has no Parent"),
    (",Parent=b1\n", ",Parent=d4\n", "object d4 is used as Parent before it was created"),
    ("Weapon+Missile,Name=AIM-120C,Parent=b1\n", "Missile,Parent=b1\n", "type 'Missile' of object c2 is not tags"),
    ("Weapon+Missile,Name=AIM-120C,Parent=b1\n", "Weapon + Missile,Parent=b1\n", "type 'Weapon + Missile' of obj"),
    ("0,Event=LeftArea|c1|\n-c1\n", "", "launcher b1 has 1 Timeout outcome without a weapon"),
    (MISS, MISS + MISS, "launcher b1 has 1 Timeout outcome without a weapon"),
    (MISS, "", "weapon c1 is removed without a Timeout outcome"),
    ("Outcome:Miss", "Outcome:Near", "outcome 'Near' is unknown; legal are Kill and Miss"),
    (MISS, MISS.replace("b1", "b2"), "object b2 is named in Timeout before it was created"),
    ("0,Event=Destroyed|a1|\n", "", "object a1 is killed but no Destroyed event tells of it"),
    ("-a1\n", "", "object a1 is destroyed but never removed"),
    ("-f1\n", "", "explosion f1 is never removed"),
    ("Event=LeftArea|c1|", "Event=Explosion|c1|", "event 'Explosion' is unknown"),
    ("c2,", "xyz,", "id 'xyz' is not hexadecimal"),
]


@pytest.mark.parametrize(("part", "broken", "sentence"), BROKEN, ids=[sentence for *_, sentence in BROKEN])
def test_one_broken_line_is_one_named_problem(part: str, broken: str, sentence: str) -> None:
    assert part in SOUND
    assert any(sentence in problem for problem in check_acmi(SOUND.replace(part, broken, 1)))


def test_a_weapon_that_never_ends_is_a_problem() -> None:
    endless = SOUND.replace(MISS, "").replace("0,Event=LeftArea|c1|\n-c1\n", "")
    assert check_acmi(endless) == ["weapon c1 has no Timeout outcome and is never removed"]


def test_a_continued_line_is_one_line() -> None:
    assert check_acmi(SOUND.replace("0,Title=two shots\\, one kill", "0,Title=two shots\\\n#not a frame")) == []


def test_a_body_that_is_elsewhere_is_found() -> None:
    flight = ending(Outcome.EXIT)
    moved = flight.evader.position_m + np.array([0.0, 30.0, 0.0])
    elsewhere = dataclasses.replace(flight, evader=dataclasses.replace(flight.evader, position_m=moved))
    problems = check_positions(acmi_text(flight), elsewhere)
    assert [problem.partition(".")[0] for problem in problems] == ["object a1 is 30"] * 2


def test_a_mistake_in_one_of_the_two_coordinates_is_found() -> None:
    flight = ending(Outcome.EXIT)
    u = f"|{flight.evader.position_m[0, 0]:.2f}".rstrip("0") + "|"
    text = acmi_text(flight)
    assert u in text
    (problem,) = check_positions(text.replace(u, "|0|", 1), flight)
    assert problem.startswith("object a1 is")
    assert problem.endswith("at 0.00 s by U and V")


def test_a_body_that_is_not_there_is_missed() -> None:
    flight = ending(Outcome.EXIT)
    without = "\n".join(line for line in acmi_text(flight).splitlines() if not line.startswith("b1,"))
    assert check_positions(without, flight) == ["object b1 is missing"]


def test_frames_too_far_apart_cost_accuracy() -> None:
    flight = ending(Outcome.EXIT)
    coarse = acmi_text(flight.thin(200))
    assert check_positions(coarse, flight)
