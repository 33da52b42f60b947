"""A flight in words: who flew what, how it ended, durations and distances."""

from __future__ import annotations

import math

from sim.trajectory import Departure, Trajectory
from sim.world import Outcome


def caption(flight: Trajectory) -> str:
    """Who flew what, from which initial state."""
    episode = f", episode {flight.episode}" if flight.episode else ""
    return f"{policy_text(flight)} on {flight.task.name}, seed {flight.seed}{episode}"


def policy_text(flight: Trajectory) -> str:
    """The policy's name without what no file and no picture can hold: it may be the name of somebody's file."""
    return "".join(c if c.isprintable() else "�" for c in flight.policy)


def name_text(flight: Trajectory, beside: bool) -> str:
    """Who flies; of a branch `beside` the flight that it left only who flew on, and when."""
    left = flight.departure
    return f"from {clock_text(left.time_s)} {flown_on_text(left)}" if beside and left else policy_text(flight)


def flown_on_text(left: Departure) -> str:
    """Who flew on: a person, a policy, or one after the other."""
    return ", then ".join(["by hand"] * bool(left.headings_deg) + [left.then or "heading held"])


def outcome_text(flight: Trajectory) -> str:
    """How a flight ended, and the cause when it failed."""
    texts = {
        Outcome.FLYING: "still flying",
        Outcome.EXIT: "✓ Reached the exit",
        Outcome.SHOT_DOWN: f"✗ Shot down by missile {flight.killer}",
        Outcome.LEFT_FIELD: "✗ Left the battlefield",
        Outcome.TIMEOUT: "✗ Out of time",
        Outcome.NOT_FINITE: "✗ Void: a number was no longer finite",
    }
    return texts.get(flight.outcome, f"✗ {flight.outcome.name.capitalize().replace('_', ' ')}")


def closest_miss_m(flight: Trajectory) -> float:
    """Smallest distance of any missile to the evader [m]; NaN when none was launched."""
    return min((m.closest_m for m in flight.missiles if not math.isnan(m.closest_m)), default=math.nan)


def clock_text(seconds: float) -> str:
    """Minutes and seconds, as on the clock."""
    return f"{int(seconds) // 60}:{int(seconds) % 60:02d}"


def distance_text(metres: float) -> str:
    """Metres below a kilometre, kilometres above; a dash for none."""
    if math.isnan(metres):
        return "–"
    return f"{metres:.0f} m" if metres < 1000.0 else f"{metres / 1e3:.1f} km"
