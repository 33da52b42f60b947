"""Tacview recordings: signs and units by hand, and flights read back by a parser that is not ours."""

from __future__ import annotations

import io
import math
import zipfile
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pyacmi import Acmi

from sim.task import Task
from sim.trajectory import BodyTrack, Trajectory, fly
from sim.world import Fate, Outcome
from tests.engagements import changed, straight
from tests.engagements import task as drill
from tests.workbench.flights import ending, unhindered
from workbench.acmi.bodies import vertical_g
from workbench.acmi.check import check_acmi, check_positions
from workbench.acmi.document import acmi_text, zipped_acmi
from workbench.acmi.transform import number_texts, transforms, yaw_deg

ENDINGS = [outcome for outcome in Outcome if outcome.name in ("EXIT", "SHOT_DOWN", "LEFT_FIELD", "TIMEOUT")]
DRILL = drill()
EIGHT = Task(changed(launch={"missiles": 8, "interval_s": 6.0}))
ONE = Task(changed(launch={"missiles": 1}))


def lines(flight: Trajectory) -> list[str]:
    return acmi_text(flight).splitlines()


def read(flight: Trajectory, folder: Path) -> Acmi:
    """The recording as pyacmi understands it."""
    (folder / "flight.acmi").write_text(acmi_text(flight), encoding="utf-8")
    recording = Acmi()
    recording.load_acmi(str(folder / "flight.acmi"))
    return recording


def test_a_place_by_hand() -> None:
    # 1113.2 m are a hundredth of a degree; east is 90, half a radian of left bank is -28.65, 0.1 rad up is 5.73.
    (value,) = transforms(np.array([[1113.2, -2226.4, 8000.0]]), np.zeros(1), np.array([0.1]), np.array([0.5]))
    assert value == "0.01|-0.02|8000|-28.65|5.73|90|1113.2|-2226.4|90"


@pytest.mark.parametrize(
    ("heading_rad", "yaw"),
    [(0.0, 90.0), (math.pi / 2, 0.0), (math.pi, 270.0), (-math.pi / 2, 180.0), (0.75 * math.pi, 315.0)],
)
def test_counter_clockwise_from_east_becomes_clockwise_from_north(heading_rad: float, yaw: float) -> None:
    assert yaw_deg(heading_rad) == pytest.approx(yaw)


def test_a_heading_a_little_left_of_north_is_written_as_zero_not_360() -> None:
    assert yaw_deg(math.pi / 2 + 1e-6) == 0.0


def test_a_missile_has_no_bank() -> None:
    (value,) = transforms(np.array([[0.0, 0.0, 1.0]]), np.zeros(1), np.zeros(1))
    assert value.split("|")[3] == "0"


def test_numbers_are_short_and_zero_has_no_sign() -> None:
    assert number_texts(np.array([-0.001, 100.0, 2.50, -1.0]), 2) == ["0", "100", "2.5", "-1"]
    assert number_texts(np.array([100.0, 0.0]), 0) == ["100", "0"]


def turning(rate_rad_s: float) -> tuple[BodyTrack, np.ndarray]:
    """A level circle at 250 m/s."""
    time_s = np.arange(0.0, 20.0, 0.05)
    level, heading = np.zeros_like(time_s), rate_rad_s * time_s
    return BodyTrack(np.zeros((len(time_s), 3)), heading, level, level, np.full_like(time_s, 250.0)), time_s


def test_level_flight_is_one_g_and_a_turn_at_60_degrees_of_bank_two() -> None:
    assert vertical_g(*turning(0.0)) == pytest.approx(1.0)
    # 1 / cos 60 = 2; the rate of that turn is g tan 60 / V.
    assert vertical_g(*turning(9.80665 * math.tan(math.pi / 3) / 250.0))[5:-5] == pytest.approx(2.0, abs=1e-3)


@pytest.mark.parametrize("outcome", ENDINGS, ids=lambda outcome: outcome.name)
def test_every_ending_makes_a_sound_recording(outcome: Outcome) -> None:
    flight = ending(outcome)
    assert check_acmi(acmi_text(flight)) == []
    assert check_positions(acmi_text(flight), flight) == []


def test_missiles_that_stop_short_in_the_substep_of_a_kill_are_where_they_were() -> None:
    kills = [flight for seed in range(8) if (flight := fly(DRILL, straight, "straight", seed)).killer]
    assert len(kills) >= 3
    for flight in kills:
        assert check_positions(acmi_text(flight), flight) == []


@pytest.mark.parametrize("task", [ONE, EIGHT, replace(EIGHT, masked=frozenset({2, 7}))], ids=["one", "eight", "masked"])
@pytest.mark.parametrize("outcome", [Outcome.EXIT, Outcome.SHOT_DOWN], ids=["exit", "shot_down"])
def test_any_number_of_missiles_makes_a_sound_recording(task: Task, outcome: Outcome) -> None:
    flight = ending(outcome, task)
    launched = [missile.number for missile in flight.missiles if missile.fate is not Fate.UNLAUNCHED]
    text = acmi_text(flight)
    assert check_acmi(text) == check_positions(text, flight) == []
    assert text.count("Event=Timeout") == text.count("Type=Weapon+Missile") == len(launched) > 0


def test_a_thinned_flight_makes_a_sound_recording() -> None:
    for every in (7, 100, 10**6):
        assert check_acmi(acmi_text(ending(Outcome.SHOT_DOWN).thin(every))) == []


def test_another_reader_finds_every_body_where_it_was(tmp_path: Path) -> None:
    flight = ending(Outcome.EXIT)
    recording = read(flight, tmp_path)
    tracks = {"a1": flight.evader, "b1": flight.interceptor} | {f"c{m.number}": m for m in flight.missiles}
    for ident, track in tracks.items():
        for index in range(0, len(flight.time_s), 500):
            if not np.isfinite(track.position_m[index]).all():
                continue
            body, time_s = recording.objects[ident], round(float(flight.time_s[index]), 3)
            found = [body.u(time_s), body.v(time_s), body.altitude(time_s)]
            assert found == pytest.approx(track.position_m[index], abs=0.01)
            degrees = [body.longitude(time_s), body.latitude(time_s)]
            assert degrees == pytest.approx(track.position_m[index, :2] / 111_320.0, abs=1e-6)
            assert body.tas(time_s) == pytest.approx(track.speed_m_s[index], abs=0.06)


def test_another_reader_finds_who_fired_what_and_when_it_ended(tmp_path: Path) -> None:
    flight = ending(Outcome.EXIT)
    recording = read(flight, tmp_path)
    assert recording.file_version == 2.2
    assert recording.title == f"{flight.policy} on target\\, seed {flight.seed}"
    for missile in flight.missiles:
        body = recording.objects[f"c{missile.number}"]
        assert body.is_missile
        assert body.parent() == "b1"
        assert body.locked_target() == "a1"
        assert body.removed_at == pytest.approx(missile.end_s)
    assert recording.objects["a1"].is_plane
    assert recording.objects["a1"].removed_at == pytest.approx(flight.duration_s)
    assert "Waypoint" in recording.objects["e1"].tags
    assert recording.objects["e1"].u() == flight.task.scenario.battlefield.length_m / 2


def test_the_return_is_told_as_it_is_paid(tmp_path: Path) -> None:
    flight = ending(Outcome.EXIT)
    evader = read(flight, tmp_path).objects["a1"]
    assert float(evader.get_value("Return")) == pytest.approx(flight.episode_return, abs=0.01)
    assert float(evader.get_value("Return", 3.0)) == pytest.approx(-0.3)
    assert float(evader.get_value("Reward", 3.0)) == pytest.approx(-0.1)
    assert float(evader.get_value("Return", 0.0)) == 0.0


def test_mach_is_speed_by_the_speed_of_sound_at_that_height(tmp_path: Path) -> None:
    flight = ending(Outcome.EXIT)
    recording = read(flight, tmp_path)
    for ident in ("a1", "b1", "c1"):
        body, time_s = recording.objects[ident], flight.missiles[0].launch_s + 5.0
        sound_m_s = math.sqrt(1.4 * 287.053 * (288.15 - 0.0065 * body.altitude(time_s)))
        assert body.mach(time_s) == pytest.approx(body.tas(time_s) / sound_m_s, abs=1e-3)


@pytest.mark.parametrize("launch", [{"radar_range_m": 20e3}, {"radar_half_angle_rad": 0.3}], ids=["range", "angle"])
def test_the_lock_is_there_while_the_evader_is_in_the_radar(launch: dict[str, float], tmp_path: Path) -> None:
    flight = unhindered()
    flight = replace(flight, task=replace(flight.task, scenario=changed(launch=launch)))
    hunter, modes = read(flight, tmp_path).objects["b1"], set()
    for index in range(0, len(flight.time_s), 10):
        offset = flight.evader.position_m[index] - flight.interceptor.position_m[index]
        heading = float(flight.interceptor.heading_rad[index])
        ahead = offset[0] * math.cos(heading) + offset[1] * math.sin(heading)
        off_nose = math.acos(ahead / math.hypot(offset[0], offset[1]))
        near = math.dist(offset, (0, 0, 0)) <= launch.get("radar_range_m", 80e3)
        mode = float(hunter.get_value("LockedTargetMode", round(float(flight.time_s[index]), 3)))
        assert mode == float(near and off_nose <= launch.get("radar_half_angle_rad", 1.05))
        modes.add(mode)
    assert modes == {0.0, 1.0}


def test_a_kill_is_a_timeout_a_destruction_an_explosion_and_removals() -> None:
    flight = ending(Outcome.SHOT_DOWN)
    told = lines(flight)
    killer = next(missile for missile in flight.missiles if missile.fate is Fate.HIT)
    kills = [line for line in told if line.startswith("0,Event=Timeout") and line.endswith("Outcome:Kill")]
    assert len(kills) == 1
    wanted = ["a1,Health=0", "0,Event=Destroyed|a1|", "f1,T=", f"-c{killer.number}", "-a1", "-f1"]
    places = [next(i for i, line in enumerate(told) if line.startswith(start)) for start in wanted]
    assert places == sorted(places)
    assert f"LeftArea|c{killer.number}" not in "".join(told)
    assert told[-2:] == [f"#{flight.duration_s + 2.0:.3f}", "-f1"]


@pytest.mark.parametrize("outcome", [Outcome.EXIT, Outcome.LEFT_FIELD], ids=["exit", "left_field"])
def test_who_leaves_is_not_destroyed(outcome: Outcome) -> None:
    told = lines(ending(outcome))
    assert "0,Event=LeftArea|a1|" in told
    assert told[-1] == "-a1"
    assert not [line for line in told if "Destroyed" in line or "Explosion" in line]


@pytest.mark.parametrize("outcome", ENDINGS, ids=lambda outcome: outcome.name)
def test_every_event_is_told_at_its_time(outcome: Outcome) -> None:
    flight, time_s = ending(outcome), 0.0
    told = {}
    for line in lines(flight):
        if line.startswith("#"):
            time_s = float(line[1:])
        elif line.startswith("0,Event="):
            told.setdefault(line.replace("\\,", ","), time_s)
    for event in flight.events:
        times = [when for line, when in told.items() if event.text in line]
        assert min(abs(when - event.time_s) for when in times) <= 0.05


def test_near_missiles_there_are_ten_frames_a_second() -> None:
    flight = ending(Outcome.EXIT)
    frames = np.array([float(line[1:]) for line in lines(flight) if line.startswith("#")])
    first, last = flight.missiles[0].launch_s, flight.missiles[0].end_s
    inside = frames[(frames >= first) & (frames <= last)]
    assert len(inside) == pytest.approx(10.0 * (last - first), rel=0.05)
    assert np.diff(frames).max() <= 0.3


def test_equal_flights_give_equal_bytes() -> None:
    assert acmi_text(unhindered()) == acmi_text(unhindered())
    assert zipped_acmi(unhindered()) == zipped_acmi(unhindered())


def test_the_archive_holds_the_text_and_another_reader_opens_it(tmp_path: Path) -> None:
    flight = unhindered()
    with zipfile.ZipFile(io.BytesIO(zipped_acmi(flight))) as archive:
        assert [name for name in archive.namelist() if name.endswith(".acmi")] == archive.namelist()
        assert archive.read(archive.namelist()[0]).decode() == acmi_text(flight)
    (tmp_path / "flight.zip.acmi").write_bytes(zipped_acmi(flight))
    recording = Acmi()
    recording.load_acmi(str(tmp_path / "flight.zip.acmi"))
    assert set(recording.objects) == {"a1", "b1", "e1", "e2", "e3"}


@pytest.mark.parametrize("name", ["a,b|c\\", "line\nbreak", "zwei\x1b[31m", "0,Event=Destroyed|a1"])
def test_the_name_of_a_policy_cannot_break_a_recording(name: str) -> None:
    flight = replace(unhindered(), policy=name)
    assert check_acmi(acmi_text(flight)) == []
    assert len(lines(flight)) == len(lines(unhindered()))


def test_a_place_that_is_no_number_is_left_out() -> None:
    flight = unhindered()
    position_m = flight.evader.position_m.copy()
    position_m[-3:] = np.nan
    broken = replace(flight, evader=replace(flight.evader, position_m=position_m), outcome=Outcome.TIMEOUT)
    assert "nan" not in acmi_text(broken)
    assert check_acmi(acmi_text(broken)) == []
