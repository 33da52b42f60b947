"""Axes of an envelope: which are read, which are refused, and in which words."""

from __future__ import annotations

import pytest

from agents.envelope_axis import Axis, AxisError, parse_axis, parse_held, varied
from sim.errors import ScenarioError
from tests.engagements import DRILL, changed


def test_both_ends_belong_to_an_axis() -> None:
    axis = parse_axis("aspect_deg=-180:175:72")
    assert axis.values == tuple(float(degrees) for degrees in range(-180, 180, 5))
    assert (axis.label, axis.unit, axis.quantity, axis.is_geometry) == ("aspect", "deg", "aspect", True)


def test_whole_fields_take_whole_numbers() -> None:
    assert parse_axis("rules.substeps=10:25:4").values == (10.0, 15.0, 20.0, 25.0)
    assert parse_axis("rules.substeps=10:21:5").values == (10.0, 13.0, 16.0, 18.0, 21.0)
    with pytest.raises(AxisError, match=r"launch.missiles is 1.5; legal is a whole number from 1 to 8"):
        parse_held("launch.missiles=1.5")


@pytest.mark.parametrize(
    ("name", "label", "unit"),
    [
        ("missile.burn_s", "missile burn", "s"),
        ("missile.cd0", "missile cd0", ""),
        ("missile.speed_min_m_s", "missile speed min", "m/s"),
        ("evader.roll_rate_max_rad_s", "evader roll rate max", "rad/s"),
        ("evader.wing_area_m2", "evader wing area", "m²"),
    ],
)
def test_labels_and_units_come_from_names(name: str, label: str, unit: str) -> None:
    axis = Axis(name, (1.0,)) if name != "missile.speed_min_m_s" else Axis(name, (300.0,))
    assert (axis.label, axis.unit, axis.is_geometry) == (label, unit, False)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("launch_range_m", "axis 'launch_range_m' is not NAME=START:END:COUNT"),
        ("launch_range_m=5e3:60e3", "is not NAME=START:END:COUNT"),
        ("launch_range_m=a:b:c", "is not NAME=START:END:COUNT"),
        ("launch_range_m=60e3:5e3:9", "axis launch_range_m goes from 60000 to 5000; START must be below END"),
        ("launch_range_m=5e3:nan:9", "START must be below END"),
        ("launch_range_m=5e3:60e3:1", "axis launch_range_m has 1 values; legal is a whole number from 2 to 1000"),
        ("launch_range_m=5e3:60e3:nan", "axis launch_range_m has nan values"),
        ("launch_range_m=5e3:60e3:2.5", "axis launch_range_m has 2.5 values"),
        ("launch_range_m=5e3:600e3:3", "launch_range_m is 600000; legal is a number from 100 to 500000"),
        ("aspect_deg=-190:0:3", "aspect_deg is -190; legal is a number from -180 to 180"),
        ("missile.burn_s=-1:5:3", "missile.burn_s is -1; legal is a number from 0 to 200"),
        ("missile.wings=1:2:2", "axis 'missile.wings' is unknown; missile has mass_kg, propellant_kg"),
        ("warp=1:2:2", "axis 'warp' is unknown; use launch_range_m, aspect_deg, aspect_rad, or section.key"),
        ("name.x=1:2:2", "axis 'name.x' is unknown"),
        ("launch.missiles=1:4:7", "takes whole numbers, of which 1 to 4 has fewer than 7"),
        ("launch.missiles=0:4:5", "launch.missiles is 0; legal is a whole number from 1 to 8"),
    ],
)
def test_an_axis_that_cannot_be_is_one_sentence(text: str, sentence: str) -> None:
    with pytest.raises(AxisError) as error:
        parse_axis(text)
    assert sentence in str(error.value)


@pytest.mark.parametrize("text", ["missile.cd0", "missile.cd0=x", "missile.cd0=1:2:3"])
def test_a_held_number_that_cannot_be_is_one_sentence(text: str) -> None:
    with pytest.raises(AxisError, match="is not NAME=VALUE"):
        parse_held(text)


def test_a_varied_scenario_differs_in_that_number_alone() -> None:
    other = varied(DRILL, {"missile.burn_s": 5.0, "launch.missiles": 2.0})
    assert other == changed(missile={"burn_s": 5.0}, launch={"missiles": 2})


def test_a_varied_scenario_is_checked_like_a_file() -> None:
    with pytest.raises(ScenarioError, match=r"propellant_kg is not below missile.mass_kg \(with missile.propellant_kg"):
        varied(DRILL, {"missile.propellant_kg": 170.0})
