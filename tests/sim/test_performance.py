"""Turns, climb and fly-out against closed forms and another integration; the tables of docs/fidelity.md, run again."""

from __future__ import annotations

import contextlib
import dataclasses
import io
import math
import re
from pathlib import Path

import numpy as np
import pytest

from sim.performance import (
    FlyOut,
    aircraft_figures,
    excess_power,
    fly_out,
    markdown,
    missile_figures,
    sound_speed_m_s,
    turn_rates,
)
from sim.scenario import Aircraft, Missile, Scenario
from tests.engagements import DRILL, changed
from tests.sim.public_models import AMRAAMS, GRAVITY, PublicMissile, air, f16_figures, fly_out_row

PAGE = (Path(__file__).parents[2] / "docs/fidelity.md").read_text(encoding="utf-8")
POINTS = [(0.0, 290.0), (5000.0, 270.0), (8800.0, 260.0)]
NUMBER = re.compile(r"-?\d+(?:\.\d+)?")


def thrust_n(model: Aircraft, altitude_m: float) -> float:
    return model.thrust_max_n * (air(altitude_m)[0] / 1.225) ** 0.7


def sustained_load(model: Aircraft, altitude_m: float, speed_m_s: float) -> float:
    """Load factor at which drag eats all thrust, or the limit: T = q S CD0 + K (n W)^2 / (q S) solved for n."""
    pressure_area = 0.5 * air(altitude_m)[0] * speed_m_s**2 * model.wing_area_m2
    spare = (thrust_n(model, altitude_m) - pressure_area * model.cd0) * pressure_area / model.induced_drag
    return min(math.sqrt(spare) / (model.mass_kg * GRAVITY), limit_load(model, altitude_m, speed_m_s))


def limit_load(model: Aircraft, altitude_m: float, speed_m_s: float) -> float:
    pressure_area = 0.5 * air(altitude_m)[0] * speed_m_s**2 * model.wing_area_m2
    return min(model.load_factor_max, pressure_area * model.cl_max / (model.mass_kg * GRAVITY))


def turn_rad_s(load: float, speed_m_s: float) -> float:
    return GRAVITY * math.sqrt(load**2 - 1.0) / speed_m_s


def turns_as_they_should(scenario: Scenario, model: Aircraft) -> bool:
    """The check: sustained within 1 %, instantaneous within 2 % of the closed forms for a model."""
    right = []
    for altitude, speed in POINTS:
        found = turn_rates(scenario, altitude, speed)
        sustained = turn_rad_s(sustained_load(model, altitude, speed), speed)
        at_once = turn_rad_s(limit_load(model, altitude, speed), speed)
        right.append(math.isclose(found.sustained_rad_s, sustained, rel_tol=0.01))
        right.append(math.isclose(found.instantaneous_rad_s, at_once, rel_tol=0.02))
    return all(right)


def test_turns_are_those_of_the_closed_forms() -> None:
    assert turns_as_they_should(DRILL, DRILL.evader)


@pytest.mark.parametrize("name", ["mass_kg", "thrust_max_n", "induced_drag"])
def test_an_aircraft_a_twentieth_better_would_be_noticed(name: str) -> None:
    better = changed(evader={name: getattr(DRILL.evader, name) * 1.05})
    assert not turns_as_they_should(better, DRILL.evader)


def test_the_load_of_a_turn_is_told_from_its_rate() -> None:
    found = turn_rates(DRILL, 5000.0, 270.0)
    assert found.sustained_g == pytest.approx(sustained_load(DRILL.evader, 5000.0, 270.0), rel=0.01)


@pytest.mark.parametrize("altitude", [0.0, 5000.0, 8800.0])
def test_excess_power_is_thrust_less_drag(altitude: float) -> None:
    model, speeds = DRILL.evader, np.array([200.0, 250.0, 300.0])
    weight = model.mass_kg * GRAVITY
    pressure_area = 0.5 * air(altitude)[0] * speeds**2 * model.wing_area_m2
    drag = pressure_area * model.cd0 + model.induced_drag * weight**2 / pressure_area
    expected = (thrust_n(model, altitude) - drag) * speeds / weight
    np.testing.assert_allclose(excess_power(DRILL, altitude, speeds), expected, rtol=0.01)
    draggy = changed(evader={"cd0": model.cd0 * 1.1})
    assert not np.allclose(excess_power(draggy, altitude, speeds), expected, rtol=0.01)


def as_public(name: str, m: Missile) -> PublicMissile:
    """A scenario's missile for the integrator that knows nothing of ours."""
    share = [m.cd0 * part for part in (0.532, 0.853, 1.0, 0.819, 0.630, 0.504)]
    return PublicMissile(
        name, m.mass_kg, ((m.thrust_n, m.burn_s, m.propellant_kg),), (0.6, 1.0, 1.2, 2.0, 3.0, 4.0), share, m.area_m2
    )


def figures_of(shot: FlyOut) -> list[float]:
    kilometres = [metres / 1e3 for metres in (*shot.range_m, shot.supersonic_range_m)]
    return [shot.peak_speed_m_s, *shot.speed_m_s, *kilometres]


@pytest.mark.parametrize("altitude", [6000.0, 10000.0])
def test_the_fly_out_is_that_of_an_independent_integration(altitude: float) -> None:
    expected = fly_out_row(as_public("drill", DRILL.missile), altitude, DRILL.missile.induced_drag)
    np.testing.assert_allclose(figures_of(fly_out(DRILL, altitude)), expected, rtol=0.01)


@pytest.mark.parametrize(("name", "factor"), [("thrust_n", 1.03), ("cd0", 1.03), ("burn_s", 1.03), ("area_m2", 1.03)])
def test_a_missile_by_other_numbers_flies_otherwise(name: str, factor: float) -> None:
    expected = fly_out_row(as_public("drill", DRILL.missile), 6000.0, DRILL.missile.induced_drag)
    other = changed(missile={name: getattr(DRILL.missile, name) * factor})
    assert not np.allclose(figures_of(fly_out(other, 6000.0)), expected, rtol=0.01)


@pytest.mark.parametrize("altitude", [6000.0, 10000.0])
def test_with_the_numbers_of_a_public_model_the_kernel_flies_that_model(altitude: float) -> None:
    public = AMRAAMS[0]
    (motor,) = public.stages
    missile = dataclasses.replace(
        DRILL.missile, mass_kg=public.mass_kg, thrust_n=motor[0], burn_s=motor[1], propellant_kg=motor[2],
        area_m2=public.area_m2, cd0=max(public.drag), induced_drag=0.0,
    )  # fmt: skip
    shot = fly_out(dataclasses.replace(DRILL, missile=missile), altitude)
    np.testing.assert_allclose(figures_of(shot), fly_out_row(public, altitude), rtol=0.01)


def test_a_missile_that_stays_fast_tells_no_range_above_mach_1() -> None:
    lasting = changed(missile={"cd0": 0.02, "induced_drag": 0.0})
    assert math.isnan(fly_out(lasting, 10000.0).supersonic_range_m)
    assert missile_figures(lasting, [10000.0])[0][-1] == "further"
    assert sound_speed_m_s(0.0) == pytest.approx(340.29, abs=0.01)


def same_figures(told: str, found: str) -> bool:
    """Whether texts say the same words, and numbers that differ by at most one in their last digit."""
    if NUMBER.sub("#", told) != NUMBER.sub("#", found):
        return False
    pairs = zip(NUMBER.findall(told), NUMBER.findall(found), strict=True)
    return all(abs(float(a) - float(b)) < 1.01 * 10.0 ** -len(b.partition(".")[2]) for a, b in pairs)


def rows_of_page(first: str) -> list[list[str]]:
    """Cells of the page's table rows whose first cell is `first`."""
    rows = [line.strip().strip("|").split("|") for line in PAGE.splitlines() if line.startswith(f"| {first} |")]
    return [[cell.strip() for cell in row] for row in rows]


def told_by_page(row: list[str]) -> bool:
    """Whether the page has this row, whatever columns follow."""
    told = [" | ".join(cells[: len(row)]) for cells in rows_of_page(row[0])]
    return any(same_figures(text, " | ".join(row)) for text in told)


def test_the_snippet_of_the_page_prints_the_figures_of_the_page() -> None:
    (snippet,) = re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(snippet, "docs/fidelity.md", "exec"), {})
    rows = [[cell.strip() for cell in line.strip("|").split("|")] for line in printed.getvalue().splitlines()]
    assert len(rows) == 11
    for row in rows:
        assert told_by_page(row), f"docs/fidelity.md does not say | {' | '.join(row)} |: run its snippet again"


def test_figures_of_another_scenario_are_not_those_of_the_page() -> None:
    faster = changed(DRILL, missile={"thrust_n": 12e3})
    assert not any(told_by_page(["default scenario", *row[1:]]) for row in missile_figures(faster))
    better = changed(DRILL, evader={"thrust_max_n": 118e3})
    assert not all(told_by_page(list(row)) for row in aircraft_figures(better))
    assert markdown([("a", "1 m/s")]) == "| a | 1 m/s |"


@pytest.mark.parametrize("public", AMRAAMS, ids=lambda public: public.name)
@pytest.mark.parametrize("altitude", [6000.0, 10000.0])
def test_the_page_tells_public_missiles_as_their_numbers_fly(public: PublicMissile, altitude: float) -> None:
    row = fly_out_row(public, altitude)
    ranges = ["further" if math.isnan(kilometres) else f"{kilometres:.1f} km" for kilometres in row[3:]]
    assert told_by_page([public.name, f"{altitude / 1e3:.0f} km", *(f"{speed:.0f} m/s" for speed in row[:3]), *ranges])


@pytest.mark.parametrize("altitude", [0, 5000, 8800])
def test_the_page_tells_the_public_f16_as_its_tables_say(altitude: int) -> None:
    sustained, load, at_once, power = f16_figures(altitude, 0.85, mass_kg=12000.0)
    expected = {
        "sustained turn": f"{sustained:.1f} deg/s at {load:.1f} g",
        "instantaneous turn": f"{at_once:.1f} deg/s",
        "excess power": f"{power:.0f} m/s",
    }
    for quantity, text in expected.items():
        (row,) = rows_of_page(f"{quantity}, Mach 0.85 at {altitude} m")
        assert same_figures(row[2], text)
