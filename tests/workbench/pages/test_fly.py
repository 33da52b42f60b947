"""The Fly page put together, without a browser."""

from __future__ import annotations

import asyncio
import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pytest
import viser

from sim.errors import UsageError
from workbench.context import AppContext
from workbench.pages import fly
from workbench.pages.fly import FlyPage
from workbench.pages.fly_settings import FlySettings
from workbench.recordings import Recordings
from workbench.runs import RunStore
from workbench.viser_proxy import ViserRegistry


class OneScene(ViserRegistry):
    """Gives every page the same viser server; starting one per test would be slow."""

    def __init__(self, server: viser.ViserServer) -> None:
        super().__init__()
        self.server = server

    def open(self) -> tuple[str, viser.ViserServer]:
        return "scene", self.server


@pytest.fixture(scope="module")
def server() -> Iterator[viser.ViserServer]:
    server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
    yield server
    server.stop()


@pytest.fixture
def shown(tmp_path: Path, server: viser.ViserServer, monkeypatch: pytest.MonkeyPatch) -> FlyPage:
    monkeypatch.setattr(fly.pn.state, "onload", lambda _callback: None)
    monkeypatch.setattr(fly.pn.state, "execute", lambda callback, **_options: callback())
    return FlyPage(AppContext(RunStore(tmp_path / "runs"), Recordings(tmp_path / "rrd"), OneScene(server)))


def _cards(shown: FlyPage) -> str:
    return "".join(str(card.object) for card in shown._cards.values())


def test_a_page_says_that_it_is_flying_until_it_has_flown(shown: FlyPage) -> None:
    assert _cards(shown).count("flying …") == 2
    asyncio.run(shown._fly())
    assert "flying …" not in _cards(shown)
    assert not shown._progress.visible


def test_the_clock_ends_with_the_longer_flight(shown: FlyPage) -> None:
    asyncio.run(shown._fly())
    assert shown._clock.duration == pytest.approx(max(row["time"] for row in shown._events.events))
    assert shown._clock.marks == shown._events.events


def test_every_time_is_acknowledged_so_that_the_next_may_come(shown: FlyPage) -> None:
    asyncio.run(shown._fly())
    shown._clock.time = 123.4
    assert shown._clock.shown == 123.4


def test_a_refused_flight_is_one_sentence(shown: FlyPage, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_settings: FlySettings, _store: RunStore) -> None:
        raise UsageError("policy <x> cannot see missile 4")

    monkeypatch.setattr(fly, "fly_both", refuse)
    asyncio.run(shown._fly())
    assert shown._alert.visible
    assert shown._alert.object == "Policy &lt;x&gt; cannot see missile 4. Nothing new was flown."
    assert _cards(shown).count("not flown") == 2


def test_a_refused_change_keeps_what_was_flown(shown: FlyPage, monkeypatch: pytest.MonkeyPatch) -> None:
    asyncio.run(shown._fly())
    before = _cards(shown)

    def refuse(_settings: FlySettings, _store: RunStore) -> None:
        raise UsageError("no")

    monkeypatch.setattr(fly, "fly_both", refuse)
    asyncio.run(shown._fly())
    assert _cards(shown) == before


def test_choosing_a_mask_changes_the_settings(shown: FlyPage, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fly.pn.state, "execute", lambda *_arguments, **_options: None)
    shown._controls.mask({2, 3})
    assert shown._settings.masked == {2, 3}
    assert shown._settings.time_s == 0.0


def test_another_scenario_brings_its_missiles_and_forgets_masks_it_does_not_have(
    shown: FlyPage, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fly.pn.state, "execute", lambda *_arguments, **_options: None)
    shown._controls.mask({2, 4})
    shown._controls._scenario.value = "short-range"
    assert shown._settings == replace(shown._settings, scenario="short-range", masked=frozenset({2}))
    assert len(shown._controls._chips.colours) == 2
    shown._controls._scenario.value = "six-missiles"
    assert len(shown._controls._chips.colours) == 6


def test_a_blind_policy_is_offered_the_mask_that_works(shown: FlyPage, monkeypatch: pytest.MonkeyPatch) -> None:
    flights: list[FlySettings] = []
    monkeypatch.setattr(fly.pn.state, "execute", lambda *_arguments, **_options: None)
    shown._controls._scenario.value = "six-missiles"
    monkeypatch.setattr(fly.pn.state, "execute", lambda callback, **_options: flights.append(shown._settings))
    asyncio.run(shown._fly())
    assert "cannot see missiles 5, 6 of this task" in shown._alert.object
    assert (shown._offer.visible, shown._offer.label) == (True, "Mask 5, 6 and fly")
    shown._offer.clicks += 1
    assert flights[-1].masked == {5, 6}
    assert not shown._offer.visible
    monkeypatch.setattr(fly.pn.state, "execute", lambda callback, **_options: callback())
    asyncio.run(shown._fly())
    assert not shown._alert.visible
    assert "A: policy &#x27;submas-target&#x27; was trained on scenario &#x27;default&#x27;" in shown._note.object
    assert "missile_6_km" in shown._tabs._charts.pair("range").a.source.column_names


def test_the_scene_which_is_heavy_waits_until_the_curves_are_painted(
    shown: FlyPage, monkeypatch: pytest.MonkeyPatch
) -> None:
    order: list[str] = []
    monkeypatch.setattr(shown._tabs, "show", lambda _pair: order.append("curves"))
    monkeypatch.setattr(shown._view, "load", lambda _flights: order.append("scene"))
    frame = shown._view.frame
    for _ in range(2):
        asyncio.run(shown._fly())
    assert order == ["curves", "curves"]
    frame.painted = frame.due - 1  # of flights that others have replaced
    assert order == ["curves", "curves"]
    frame.painted = frame.due
    assert order == ["curves", "curves", "scene"]


def test_the_read_outs_and_the_guide_belong_to_the_flights_shown(shown: FlyPage) -> None:
    asyncio.run(shown._fly())
    a, b = json.loads(shown._hud.flights)
    assert (a["letter"], b["letter"]) == ("A", "B")
    assert a["guide"] is not None
    assert b["guide"] is None


def test_what_a_browser_sets_is_in_the_address(shown: FlyPage, monkeypatch: pytest.MonkeyPatch) -> None:
    written: dict[str, str] = {}
    monkeypatch.setattr(fly, "write_query", lambda **values: written.update(values))
    shown._view.frame.camera = "chase-b"
    shown._view.frame.drawn = ["labels", "energy"]
    shown._clock.speed = 10
    shown._tabs._over.value = True
    assert (written["camera"], written["show"], written["curves"], written["speed"]) == (
        "chase-b",
        "energy",
        "over",
        "10",
    )
    assert written["hide"] == "readouts,trails,sight,beams"
    assert not shown._hud.visible_hud
