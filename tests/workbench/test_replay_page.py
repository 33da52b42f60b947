"""The replay in one file: whole, closed to the network, and true to the flight; whatever a policy is called."""

from __future__ import annotations

import base64
import hashlib
import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from typing import Any

import numpy as np
import pytest

from sim.trajectory import Trajectory
from sim.world import Outcome
from tests.workbench.flights import ending, unhindered
from workbench.exports import encode
from workbench.replay_page import embedded

HOSTILE = "</script><img src=https://evil.example/x onerror=alert(1)>\"'&<!--"


class Reader(HTMLParser):
    """The elements of a page with their attributes, and the text inside scripts and styles."""

    def __init__(self, page: bytes) -> None:
        super().__init__()
        self.elements: list[tuple[str, dict[str, str | None]]] = []
        self.texts: list[tuple[str, str]] = []
        self.feed(page.decode())

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.elements.append((tag, dict(attrs)))

    def handle_data(self, data: str) -> None:
        self.texts.append((self.elements[-1][0] if self.elements else "", data))

    def all(self, tag: str) -> list[dict[str, str | None]]:
        return [attributes for name, attributes in self.elements if name == tag]


def record(page: bytes) -> dict[str, Any]:
    found = re.search(rb'id="flight-data">(.*?)</script>', page, re.DOTALL)
    assert found
    return json.loads(found[1])


def page_of(flight: Trajectory, other: Trajectory | None = None) -> bytes:
    return encode(flight, ".html", *([other] if other else []))


def foreign(page: bytes) -> list[str]:
    """Addresses that a browser would ask for; the name of the SVG language is none."""
    reader = Reader(page)
    links = [value for _, attributes in reader.elements for key, value in attributes.items() if key in ("src", "href")]
    return [link for link in links if link and not link.startswith("data:")]


def test_the_page_refers_to_nothing_outside_itself() -> None:
    page = page_of(ending(Outcome.EXIT))
    assert foreign(page) == []
    assert foreign(page.replace(b"<body>", b'<body><img src="https://example.org/a.png">')) != []  # the test can fail
    assert set(re.findall(rb"https?://[^\s'\"]+", page)) == {b"http://www.w3.org/2000/svg"}
    assert b"@import" not in page
    assert b"fetch(" not in page


def test_the_policy_allows_this_script_and_this_style_and_no_request() -> None:
    page = page_of(ending(Outcome.EXIT))
    (policy,) = [
        attributes["content"] for attributes in Reader(page).all("meta") if "Content-Security" in str(attributes)
    ]
    assert policy is not None
    rules = dict(rule.split(" ", 1) for rule in policy.split("; "))
    assert rules["default-src"] == rules["base-uri"] == rules["form-action"] == "'none'"
    assert rules["img-src"] == "data:"
    for rule, tag in (("script-src", b"script"), ("style-src", b"style")):
        (text,) = re.findall(rb"<" + tag + rb">(.*?)</" + tag + rb">", page, re.DOTALL)
        assert rules[rule] == f"'sha256-{base64.b64encode(hashlib.sha256(text).digest()).decode()}'"


def test_a_hostile_name_stays_a_name() -> None:
    flight = replace(ending(Outcome.SHOT_DOWN), policy=HOSTILE)
    page = page_of(flight)
    reader = Reader(page)
    assert [len(reader.all(tag)) for tag in ("script", "img")] == [2, 0]
    assert record(page)["flights"][0]["facts"]["policy"] == HOSTILE
    assert "<" not in embedded({"name": HOSTILE})
    assert b"evil.example" not in page.split(b'id="flight-data"')[1].split(b"<script>")[1]
    plain = page.replace(b"\\u003c", b"<").replace(b"\\u003e", b">")
    assert len(Reader(plain).all("img")) > 0  # without the escapes it would be an element


def test_the_record_says_what_was_flown() -> None:
    flight = ending(Outcome.SHOT_DOWN)
    told = record(page_of(flight))
    (one,) = told["flights"]
    facts, task = one["facts"], flight.task
    assert told["format"] == "submas-replay/1"
    assert {"submas-workbench", "warp-lang", "python"} <= set(told["made_with"])
    assert (facts["policy"], facts["seed"], facts["scenario"]) == (flight.policy, flight.seed, task.scenario.name)
    assert (facts["scenario_digest"], facts["masked_missiles"]) == (task.scenario.digest, sorted(task.masked))
    assert [event["text"] for event in one["events"]] == [event.text for event in flight.events]
    assert one["outcome"] == f"✗ Shot down by missile {flight.killer}"
    assert not one["success"]


def test_between_the_kept_samples_the_flight_is_where_it_was() -> None:
    flight = ending(Outcome.EXIT)
    bodies = record(page_of(flight))["flights"][0]["bodies"]
    tracks = [flight.evader, flight.interceptor, *(m for m in flight.missiles if np.isfinite(m.launch_s))]
    assert len(bodies) == len(tracks)
    for body, track in zip(bodies, tracks, strict=True):
        flown = np.isfinite(track.position_m[:, 0])
        for axis, name in enumerate(("x_m", "y_m", "altitude_m")):
            drawn = np.interp(flight.time_s[flown], body["time_s"], body[name])
            assert np.abs(drawn - track.position_m[flown, axis]).max() < 12.0, (name, body["missile"])
        heading = np.radians(np.interp(flight.time_s[flown], body["time_s"], body["heading_deg"]))
        assert np.abs(np.angle(np.exp(1j * (heading - track.heading_rad[flown])))).max() < np.radians(8.0)


def test_the_closest_approach_is_a_sample() -> None:
    flight = ending(Outcome.EXIT)
    told = record(page_of(flight))["flights"][0]["bodies"][2:]
    for body, missile in zip(told, [m for m in flight.missiles if np.isfinite(m.launch_s)], strict=True):
        assert min(body["range_m"]) == pytest.approx(np.nanmin(missile.range_m), abs=0.51)


def test_two_flights_have_letters_and_one_clock() -> None:
    a, b = ending(Outcome.EXIT), ending(Outcome.SHOT_DOWN)
    told = record(page_of(a, b))
    assert [flight["letter"] for flight in told["flights"]] == ["A", "B"]
    assert told["duration_s"] == pytest.approx(max(a.duration_s, b.duration_s), abs=1e-3)
    assert len({flight["bodies"][0]["ink"] for flight in told["flights"]}) == 2


def test_a_long_flight_of_two_stays_small() -> None:
    long = replace(unhindered())
    assert len(page_of(long, long)) < 1_000_000
