"""The engagement of Fig. 12: both policies win it, and what is said of the beam is what was flown."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import numpy as np
import pytest

from agents.expert import DraggingExpert
from agents.policy import bind
from sim.task import task_for
from sim.trajectory import MissileTrack, Trajectory, fly
from tests.workbench.reproduce.samples import flight, made
from workbench.reproduce import azimuth_flights
from workbench.reproduce.azimuth_flights import beam_share, flight_of, shared_flights
from workbench.reproduce.pictures import draw
from workbench.reproduce.protocol import REPORT_SEED


@pytest.fixture(scope="module")
def dragged() -> Trajectory:
    task = task_for(mask="3,4")
    return fly(task, bind(DraggingExpert(), task), "expert-dragging", REPORT_SEED, 0)


def track(number: int, range_m: list[float], azimuth_deg: list[float], template: MissileTrack) -> MissileTrack:
    return dataclasses.replace(template, number=number, range_m=np.array(range_m), azimuth_rad=np.radians(azimuth_deg))


def test_the_share_is_that_of_the_closest_missile(dragged: Trajectory) -> None:
    # Five times; nothing flies at the first, then the closest is at 80, 90, -100 and 20 degrees: three of four.
    nan, template = math.nan, dragged.missiles[0]
    missiles = (
        track(1, [nan, 10.0, 10.0, 30.0, nan], [nan, 80.0, 90.0, 0.0, nan], template),
        track(2, [nan, nan, 20.0, 20.0, 5.0], [nan, nan, 0.0, -100.0, 20.0], template),
    )
    assert beam_share(dataclasses.replace(dragged, missiles=missiles)) == 0.75


def test_the_expert_flies_across_the_line_of_sight(dragged: Trajectory) -> None:
    assert beam_share(dragged) > 0.8


def test_a_flight_is_kept_from_before_the_first_launch_until_after_the_last_end(dragged: Trajectory) -> None:
    kept = flight_of("expert", dragged)
    launches = [missile.launch_s for missile in dragged.missiles if math.isfinite(missile.launch_s)]
    ends = [missile.end_s for missile in dragged.missiles if math.isfinite(missile.end_s)]
    assert kept.time_s[0] == pytest.approx(min(launches) - 5.0, abs=0.3)
    assert kept.time_s[-1] == pytest.approx(max(ends) + 5.0, abs=0.3)
    assert np.diff(kept.time_s) == pytest.approx(0.25)
    first = kept.missiles[0]
    index = round(len(kept.time_s) / 3)
    at = int(np.argmin(np.abs(dragged.time_s - kept.time_s[index])))
    assert first.azimuth_deg[index] == pytest.approx(np.degrees(dragged.missiles[0].azimuth_rad[at]), abs=0.06)
    assert first.azimuth_deg[0] is None  # before its launch


def test_both_win_the_engagement_that_is_shown() -> None:
    tried: list[int] = []
    flights = shared_flights(tried.append)
    assert [one.variant for one in flights] == ["submas", "expert"]
    assert {(one.seed, one.episode) for one in flights} == {(REPORT_SEED, tried[-1])}
    assert {one.outcome for one in flights} == {"exit"}
    assert {missile.fate for one in flights for missile in one.missiles} == {"evaded"}


def test_without_a_shared_win_there_is_no_flight_and_no_picture(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    monkeypatch.setattr(azimuth_flights, "PILOTS", {"submas": "random", "expert": "random"})
    monkeypatch.setattr(azimuth_flights, "MOST_EPISODES", 2)
    assert shared_flights() == ()
    assert not draw(dataclasses.replace(made("fig12"), flights=()), tmp_path / "fig12.png")


def test_the_picture_breaks_curves_that_wrap(tmp_path: Path) -> None:
    from layouts.paper_azimuth import azimuth_figure
    from layouts.paper_panels import AzimuthPanel

    kept = flight("submas")
    angles = {m.number: np.array([np.nan if a is None else a for a in m.azimuth_deg]) for m in kept.missiles}
    axes = azimuth_figure([AzimuthPanel("(a)", np.array(kept.time_s), angles)], "caption").axes[0]
    drawn = {line.get_label(): np.asarray(line.get_ydata(), float) for line in axes.lines}
    for values in (drawn["missile 1"], drawn["missile 2"]):
        assert not (np.abs(np.diff(values)) > 180.0).any()
    assert np.isnan(drawn["missile 2"]).sum() > np.isnan(angles[2]).sum()
    assert draw(made("fig12"), tmp_path / "fig12.png")
