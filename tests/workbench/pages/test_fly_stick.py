"""Take the stick on the Fly page, without a browser."""

from __future__ import annotations

import asyncio
from collections.abc import Awaitable, Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import viser

from layouts.theme import BRANCH
from sim.world import Outcome
from tests.layouts.sample import sample_flight
from workbench.branch import Branch
from workbench.branch_text import branch_text, read_branch
from workbench.context import AppContext
from workbench.pages import fly, fly_stick
from workbench.pages.fly import FlyPage
from workbench.pages.fly_stick import FlyStick
from workbench.pages.fly_stick_card import branch_card
from workbench.pages.fly_stick_dial import dial_sight, whole_heading
from workbench.pages.fly_stick_live import LAG_S
from workbench.recordings import Recordings
from workbench.runs import RunStore
from workbench.viser_proxy import ViserRegistry

QUERY = {"a": "expert-navigation", "b": "expert-dragging", "seed": "2", "mask": "3,4"}


class OneScene(ViserRegistry):
    """Gives every page the same viser server; starting one per test would be slow."""

    def __init__(self, server: viser.ViserServer) -> None:
        super().__init__()
        self.server = server

    def open(self) -> tuple[str, viser.ViserServer]:
        return "scene", self.server


class Ticker:
    """A periodic callback that the test calls."""

    def stop(self) -> None:
        """Nothing runs."""


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


@pytest.fixture
def noted(monkeypatch: pytest.MonkeyPatch) -> dict[str, str]:
    """What the page wrote into its address."""
    values: dict[str, str] = {}
    monkeypatch.setattr(fly_stick, "write_query", lambda **changes: values.update(changes))
    return values


class Scheduled:
    """Stands in for the session's event loop: what is scheduled runs one after the other, in turn."""

    def __init__(self) -> None:
        self.waiting: list[Callable[[], Any]] = []
        self.busy = True

    def __call__(self, callback: Callable[[], Awaitable[None] | None], **_options: Any) -> None:
        self.waiting.append(callback)
        if not self.busy:
            self.run()

    def run(self) -> None:
        """Do what waits, and from now on what comes."""
        self.busy = True
        while self.waiting:
            callback = self.waiting.pop(0)
            if asyncio.iscoroutinefunction(getattr(callback, "func", callback)):
                asyncio.run(callback())
            else:
                callback()
        self.busy = False


@pytest.fixture
def opened(
    tmp_path: Path, server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch, noted: dict[str, str]
) -> Callable[..., FlyPage]:
    """Opens the page at an address and waits until it has flown."""
    state = fly.pn.state
    monkeypatch.setattr(state, "onload", lambda _callback: None)
    monkeypatch.setattr(state, "add_periodic_callback", lambda *_arguments, **_options: Ticker())

    def open_page(**query: str) -> FlyPage:
        for module in (fly, fly_stick):
            monkeypatch.setattr(module, "read_query", lambda: QUERY | query)
        scheduled = Scheduled()
        monkeypatch.setattr(state, "execute", scheduled)
        page = FlyPage(AppContext(RunStore(tmp_path / "runs"), Recordings(tmp_path / "rrd"), OneScene(server)))
        asyncio.run(page._fly())
        scheduled.run()
        return page

    return open_page


def _stick(page: FlyPage, time_s: float = 0.0, of: str = "A") -> FlyStick:
    page._clock.time = time_s
    page._stick.widgets.of.value = of
    return page._stick


def test_the_other_policy_flies_on_and_is_told_of(opened: Callable[..., FlyPage], noted: dict[str, str]) -> None:
    page = opened()
    stick = _stick(page, 330.4, "B")  # missiles have been fired before
    assert stick.widgets.who.value == "expert-navigation"
    assert not stick.widgets.moment.over
    stick.widgets.take.clicks += 1
    assert noted["branch"] == "B,330,expert-navigation"
    card = stick.widgets.card.object
    assert "B′" in card
    assert "from 5:30 Navigation (expert)" in card
    rows = [row for row in page._events.events if row["who"] == "B′"]
    assert rows
    assert (rows[0]["kind"], rows[0]["time"]) == ("branch", 330.0)
    assert all(row["time"] > 330.0 for row in rows[1:])
    assert page._export.who == ["A", "B", "B′"]
    assert {row["who_colour"] for row in rows} == {BRANCH}
    assert {mark["who"] for mark in page._clock.marks} == {"A", "B"}
    assert page._view.frame.branch
    assert page._clock.duration == max(row["time"] for row in page._events.events)


def test_the_branch_of_an_address_is_flown(opened: Callable[..., FlyPage], noted: dict[str, str]) -> None:
    for text in ("A,150,expert-dragging", branch_text(Branch("A", 150, (90,) * 30, "expert-dragging"))):
        page = opened(branch=text)
        assert noted["branch"] == text
        assert "A′" in page._stick.widgets.card.object
        assert page._stick.widgets.steer_on.visible == ("by-hand" in text)


@pytest.mark.parametrize("wrong", ["A,150,<b>nobody</b>", "A,150", "A,1199,expert-dragging", "A,5,by-hand.AAAA"])
def test_a_wrong_branch_is_one_sentence_and_the_flights_are_shown(
    opened: Callable[..., FlyPage], noted: dict[str, str], wrong: str
) -> None:
    page = opened(branch=wrong)
    problem = page._stick.widgets.problem
    assert problem.visible
    assert problem.object.endswith("No branch is flown.")
    assert "<b>" not in problem.object
    assert noted["branch"] == ""
    assert {row["who"] for row in page._events.events} == {"A", "B"}


def test_back_to_the_original(opened: Callable[..., FlyPage], noted: dict[str, str]) -> None:
    page = opened(branch="A,150,expert-dragging")
    before = page._clock.duration
    page._stick.widgets.back.clicks += 1
    assert noted["branch"] == ""
    assert {row["who"] for row in page._events.events} == {"A", "B"}
    assert not page._view.frame.branch
    assert not page._stick.widgets._branch.visible
    assert page._clock.duration <= before


def test_rerun_shows_the_branch_as_long_as_there_is_one(opened: Callable[..., FlyPage]) -> None:
    page = opened(branch="A,150,by-hand.AFo,expert-dragging", tab="rerun")
    shown = page._tabs._recorded
    assert list(shown)[2].startswith("A′ · from 2:30 by hand, from 2:31")
    (pane,) = page._tabs._rerun.objects
    with_branch = pane.recording
    page._stick.widgets.back.clicks += 1
    assert len(page._tabs._recorded) == 2
    assert pane.recording != with_branch and page._export.who == ["A", "B"]


def test_other_flights_forget_the_branch(opened: Callable[..., FlyPage], noted: dict[str, str]) -> None:
    page = opened(branch="A,150,expert-dragging")
    page._controls.mask({4})
    assert noted["branch"] == ""
    assert {row["who"] for row in page._events.events} == {"A", "B"}


def _steered(page: FlyPage, seconds: float = 30.0, heading: int = 90) -> FlyStick:
    """Fly by hand from 2:00 on towards a heading."""
    stick = _stick(page, 120.0)
    stick.widgets.steer.clicks += 1
    assert not stick.widgets.dial.running  # time waits for the first turn
    stick.widgets.dial.param.update(heading=heading, running=True)
    for _ in range(round(seconds / (stick.widgets.dial.speed * LAG_S))):
        stick._ticked -= LAG_S
        stick._go_on()
    return stick


def test_a_person_flies_and_hands_over(opened: Callable[..., FlyPage], noted: dict[str, str]) -> None:
    page = opened()
    stick = _steered(page)
    assert stick.widgets._live.visible
    assert page._view.frame.camera == "chase-branch"
    assert abs(stick.widgets.dial.sight["heading"] - 90.0) < 15.0
    assert page._clock.jump[0] == pytest.approx(150.0, abs=3.0)
    stick.widgets.heir.value = "expert-dragging"
    stick.widgets.hand_over.clicks += 1
    flown = read_branch(noted["branch"], ["expert-dragging"], 1200)
    assert (flown.of, flown.step, flown.policy) == ("A", 120, "expert-dragging")
    assert set(flown.headings_deg) == {90}
    assert "from 2:00 by hand, from 2:3" in stick.widgets.card.object
    assert page._view.frame.camera != "chase-branch"
    assert stick._live is None


def test_a_flight_by_hand_is_not_lost_when_nobody_can_take_over(
    opened: Callable[..., FlyPage], noted: dict[str, str]
) -> None:
    stick = _steered(opened())
    stick.widgets.heir.value = "submas-source-3"  # sees missile 1 alone
    stick.widgets.hand_over.clicks += 1
    assert "cannot see missile 2" in stick.widgets.problem.object
    assert "The last heading is held instead." in stick.widgets.problem.object
    assert noted["branch"].startswith("A,120,by-hand.")
    assert "the last heading held" in stick.widgets.card.object


def test_a_pause_stops_the_flight_and_notes_it_in_the_address(
    opened: Callable[..., FlyPage], noted: dict[str, str]
) -> None:
    stick = _steered(opened(), 10.0)
    assert stick._live is not None
    stick.widgets.dial.running = False
    assert noted["branch"].startswith("A,120,by-hand.")
    before = stick._live.time_s
    stick._ticked -= 1.0
    stick._go_on()
    assert stick._live.time_s == before


def test_a_flight_by_hand_to_its_end_is_shown(opened: Callable[..., FlyPage], noted: dict[str, str]) -> None:
    page = opened()
    stick = _steered(page, 20.0, 270)
    assert stick._live is not None
    for _ in range(1200):
        if stick._live is None:
            break
        stick.widgets.dial.speed = 20
        stick._ticked -= LAG_S
        stick._go_on()
    assert "Left the battlefield" in stick.widgets.card.object or "Shot down" in stick.widgets.card.object
    assert noted["branch"].count(",") == 2


def test_steering_can_be_taken_up_again(opened: Callable[..., FlyPage], noted: dict[str, str]) -> None:
    page = opened(branch=branch_text(Branch("A", 120, (90,) * 40, "expert-dragging")))
    stick = page._stick
    page._clock.time = 130.0
    stick.widgets.steer_on.clicks += 1
    assert stick._live is not None
    assert stick._live.stick.headings_deg == [90] * 10
    stick.widgets.cancel.clicks += 1
    assert stick._live is None
    assert noted["branch"] == ""


def test_a_flight_that_is_over_cannot_be_left(opened: Callable[..., FlyPage]) -> None:
    page = opened()
    stick = _stick(page, 119_999.0)
    assert stick.widgets.take.disabled
    assert stick.widgets.steer.disabled
    assert stick.widgets.moment.over
    page._clock.time = 10.0
    assert not stick.widgets.take.disabled


def test_the_card_has_the_figures_of_both() -> None:
    card = branch_card("A", sample_flight(outcome=Outcome.SHOT_DOWN), sample_flight(), "<i>me</i>")
    assert "Reached the exit" in card
    assert "A: ✗ Shot down by missile 4" in card
    assert "4 of 4<s title='flight A'>A 3 of 4" in card
    assert "A hit at 1.0 km" in card
    assert "&lt;i&gt;me" in card


def test_headings_are_whole_degrees_from_0_to_359() -> None:
    assert [whole_heading(np.radians(a)) for a in (0.0, -1.0, 359.8, 90.4, -179.9)] == [0, 359, 0, 90, 180]
    sight = dial_sight(fly_stick.Stick(sample_flight(), Branch("A", 0, (), "x")).sight())
    assert 0.0 <= sight["heading"] < 360.0
    assert sight["missiles"] == []
