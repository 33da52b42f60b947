"""A scenario and a task in the kernel's own terms: its parameters and its arrays."""

from __future__ import annotations

import dataclasses

import warp as wp

from sim.kernel.lane import AircraftRows, IntRow, MissileRows, Model, Row, State
from sim.kernel.physics import AircraftModel, MissileModel
from sim.scenario import Scenario
from sim.task import Task


def kernel_model(scenario: Scenario) -> Model:
    """Parameters of a scenario as the kernel reads them."""
    model = Model()
    for side in ("evader", "interceptor"):
        setattr(model, side, _parameters(AircraftModel(), getattr(scenario, side)))
    model.missile = _parameters(MissileModel(), scenario.missile)
    field, launch, rules, reward = scenario.battlefield, scenario.launch, scenario.rules, scenario.reward
    model.half_length, model.half_width = field.length_m / 2, field.width_m / 2
    model.exit_y, model.exit_half_width = field.exit_y_m, field.exit_half_width_m
    model.radar_range, model.radar_half_angle = launch.radar_range_m, launch.radar_half_angle_rad
    model.launch_range, model.tail_fraction = launch.range_m, launch.tail_fraction
    model.range_min, model.interval = launch.range_min_m, launch.interval_s
    model.dt, model.substeps = rules.step_s / rules.substeps, rules.substeps
    model.max_steps, model.outside_steps = rules.max_steps, rules.outside_steps
    model.reward_exit, model.reward_evaded = reward.exit, reward.evaded
    model.reward_shot_down, model.reward_step = reward.shot_down, reward.step
    return model


_UNITS = ("_rad_s", "_1_s", "_m_s", "_kg", "_m2", "_pa", "_n", "_m", "_s")


def _parameters(model: AircraftModel | MissileModel, section: object) -> AircraftModel | MissileModel:
    # Warp structs carry the scenario's names without their units: `mass_kg` becomes `mass`.
    for field in dataclasses.fields(section):  # type: ignore[arg-type]
        name = next((field.name.removesuffix(unit) for unit in _UNITS if field.name.endswith(unit)), field.name)
        setattr(model, name, getattr(section, field.name))
    return model


def kernel_state(task: Task, groups: int, device: str) -> State:
    """Zeroed arrays for some groups of lanes of a task on a Warp device."""
    missiles = task.scenario.launch.missiles
    state = State()
    state.aircraft = wp.zeros((groups, 2), dtype=AircraftRows, device=device)
    state.missile = wp.zeros((groups, missiles), dtype=MissileRows, device=device)
    state.fate = wp.zeros((groups, missiles), dtype=IntRow, device=device)
    available = [int(m in task.missiles) for m in range(1, missiles + 1)]
    state.available = wp.array(available, dtype=int, device=device)
    for name in ("waiting", "steps", "outside", "outcome", "killer"):
        setattr(state, name, wp.zeros(groups, dtype=IntRow, device=device))
    for name in ("patience", "reach", "since_launch"):
        setattr(state, name, wp.zeros(groups, dtype=Row, device=device))
    return state
