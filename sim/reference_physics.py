"""How aircraft and missiles fly, a second time: float64 NumPy, written from the equations and not from the kernel.

Together with `sim.reference` it is the executable specification of the world; the Warp kernel is checked against it.
Arrays have any leading axes `[...]`; vectors have a last axis of 3: x, y, altitude [m]. SI units, radians.
"""

from __future__ import annotations

from dataclasses import dataclass, fields
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from sim.scenario import Missile

Array = NDArray[np.float64]
Bodies = TypeVar("Bodies", bound="AircraftState | MissileState")

GRAVITY_M_S2 = 9.80665
GAS_CONSTANT = 287.05287
"""Specific gas constant of dry air [J/(kg K)] (ICAO Doc 7488)."""
HEAT_RATIO = 1.4
LAPSE_K_M = 0.0065
SEA_LEVEL_K, SEA_LEVEL_KG_M3, TROPOPAUSE_M = 288.15, 1.225, 11_000.0
DRAG_MACH = (0.6, 1.0, 1.2, 2.0, 3.0, 4.0)
DRAG_SHARE = (0.532, 0.853, 1.0, 0.819, 0.630, 0.504)
"""Zero-lift drag by Mach number, relative to its peak: straight lines between points of the public AIM-120C table."""


@dataclass
class AircraftState:
    """Aircraft as point masses; climb angle up, heading and bank to the left positive [rad]."""

    position: Array
    speed: Array
    climb: Array
    heading: Array
    bank: Array


@dataclass
class MissileState:
    """Missiles as point masses; `lateral` is the acceleration [m/s^2] that the autopilot has reached, `age` [s]."""

    position: Array
    velocity: Array
    lateral: Array
    age: Array


def take(bodies: Bodies, index: Any) -> Bodies:
    """The bodies at an index (a copy)."""
    return type(bodies)(**{f.name: getattr(bodies, f.name)[index] for f in fields(bodies)})


def put(bodies: Bodies, index: Any, new: Bodies) -> None:
    """Overwrite the bodies at an index."""
    for field in fields(bodies):
        getattr(bodies, field.name)[index] = getattr(new, field.name)


def wrap(angle: ArrayLike) -> Array:
    """The same angle in (-pi, pi] [rad]."""
    return np.pi - (np.pi - np.asarray(angle)) % (2.0 * np.pi)


def length(vector: Array) -> Array:
    """Euclidean length of vectors `[..., 3]`."""
    return np.sqrt(dot(vector, vector))


def dot(a: Array, b: Array) -> Array:
    """Scalar product of vectors `[..., 3]`."""
    return np.einsum("...i,...i->...", a, b)


def bearing(offset: Array) -> Array:
    """Heading [rad] of offsets `[..., 3]` seen from above."""
    return np.arctan2(offset[..., 1], offset[..., 0])


def flight_velocity(a: AircraftState) -> Array:
    """Velocity `[..., 3]` [m/s] of an aircraft."""
    level = np.cos(a.climb)
    unit = np.stack((level * np.cos(a.heading), level * np.sin(a.heading), np.sin(a.climb)), axis=-1)
    return a.speed[..., None] * unit


def air(altitude_m: Array) -> tuple[Array, Array]:
    """Density [kg/m^3] and speed of sound [m/s] of the ISA up to 20 km: a linear lapse, then isothermal."""
    kelvin = SEA_LEVEL_K - LAPSE_K_M * np.minimum(altitude_m, TROPOPAUSE_M)
    exponent = GRAVITY_M_S2 / (GAS_CONSTANT * LAPSE_K_M) - 1.0
    above = np.maximum(altitude_m - TROPOPAUSE_M, 0.0) * GRAVITY_M_S2 / (GAS_CONSTANT * kelvin)
    density = SEA_LEVEL_KG_M3 * (kelvin / SEA_LEVEL_K) ** exponent * np.exp(-above)
    return density, np.sqrt(HEAT_RATIO * GAS_CONSTANT * kelvin)


def fly_aircraft(
    a: AircraftState, model: Any, heading: Array, altitude: Array, speed: Array, dt: float
) -> AircraftState:
    """One substep `dt` [s] of bank-to-turn flight under the built-in controller (section 2.3).

    Args:
        a: aircraft now.
        model: the numbers of `sim.scenario.Aircraft`, each a number or an array `[...]`.
        heading: commanded heading [rad].
        altitude: commanded altitude [m].
        speed: commanded speed [m/s].
        dt: substep [s].
    """
    density, _ = air(a.position[..., 2])
    pressure_area = 0.5 * density * a.speed**2 * model.wing_area_m2
    weight = model.mass_kg * GRAVITY_M_S2
    g_max = np.minimum(model.load_factor_max, pressure_area * model.cl_max / weight)
    # Load factor upwards that brings the climb angle, within a second, to the one that regains the altitude in 20 s.
    climb_wanted = np.clip((altitude - a.position[..., 2]) / (20.0 * a.speed), -0.15, 0.15)
    up = np.clip(np.cos(a.climb) + a.speed * (climb_wanted - a.climb) / GRAVITY_M_S2, 0.2, 0.95 * g_max)
    # What is left of the load factor turns.
    side_max = np.sqrt(np.maximum(g_max**2 - up**2, 0.0))
    side = a.speed * model.heading_gain_1_s * wrap(heading - a.heading) / GRAVITY_M_S2
    bank_wanted = np.arctan2(np.clip(side, -side_max, side_max), up)
    roll_max = model.roll_rate_max_rad_s * dt
    bank = a.bank + np.clip(bank_wanted - a.bank, -roll_max, roll_max)
    g = np.minimum(up / np.cos(bank), g_max)
    drag = pressure_area * model.cd0 + model.induced_drag * (g * weight) ** 2 / pressure_area
    thrust_max = model.thrust_max_n * (density / SEA_LEVEL_KG_M3) ** 0.7
    thrust = np.clip(drag + 0.2 * model.mass_kg * (speed - a.speed), 0.0, thrust_max)
    faster = (thrust - drag) / model.mass_kg - GRAVITY_M_S2 * np.sin(a.climb)
    steeper = GRAVITY_M_S2 * (g * np.cos(bank) - np.cos(a.climb)) / a.speed
    round_ = GRAVITY_M_S2 * g * np.sin(bank) / (a.speed * np.cos(a.climb))
    speed_after = np.maximum(a.speed + dt * faster, 30.0)
    after = AircraftState(a.position, speed_after, a.climb + dt * steeper, wrap(a.heading + dt * round_), bank)
    after.position = a.position + 0.5 * dt * (flight_velocity(a) + flight_velocity(after))
    return after


def fly_missile(m: MissileState, model: Missile, target: Array, target_velocity: Array, dt: float) -> MissileState:
    """One substep `dt` [s] of guided missiles `[n]` towards targets `[n, 3]` [m] and their velocities [m/s].

    Thrust, drag, navigation constant and lag of the model may be arrays `[n]`, drawn for every shot.
    """
    speed = length(m.velocity)
    forward = m.velocity / speed[:, None]
    density, sound = air(m.position[:, 2])
    pressure = 0.5 * density * speed**2
    up = np.array([0.0, 0.0, GRAVITY_M_S2])
    wanted = across(
        navigate(target - m.position, target_velocity - m.velocity, model.navigation_constant) + up, forward
    )
    # The fins pull as hard as the air lets them.
    air_share = np.minimum(1.0, pressure / max(model.full_load_pressure_pa, 1.0))
    pull_max = model.load_factor_max * GRAVITY_M_S2 * air_share
    wanted = at_most(wanted, pull_max)
    remains = np.exp(-dt / np.asarray(model.lag_s))[..., None]
    # And never harder, or a pull from faster days would tear a slow missile round by its induced drag.
    lateral = at_most(across(wanted + (m.lateral - wanted) * remains, forward), pull_max)
    # The last substep of the motor gets its share of the thrust, so the impulse does not depend on the substep.
    burning = np.clip((model.burn_s - m.age) / dt, 0.0, 1.0)
    mass = model.mass_kg - model.propellant_kg * np.clip(m.age / max(model.burn_s, 1e-6), 0.0, 1.0)
    side_force = mass * length(lateral)
    drag = pressure * model.area_m2 * model.cd0 * np.interp(speed / sound, DRAG_MACH, DRAG_SHARE)
    drag += model.induced_drag * side_force**2 / (pressure * model.area_m2)
    along = (burning * model.thrust_n - drag) / mass
    velocity = m.velocity + dt * (along[:, None] * forward + lateral - up)
    # Ages to the nanosecond: 160 substeps of 0.05 s are 8 s, which their sum in binary is not.
    age = np.round(m.age + dt, 9)
    return MissileState(m.position + 0.5 * dt * (m.velocity + velocity), velocity, lateral, age)


def navigate(offset: Array, closing: Array, constant: ArrayLike) -> Array:
    """True proportional navigation `[n, 3]` [m/s^2]: N times closing speed times the turn rate of the line of sight.

    `offset` and `closing` are target minus missile. A target that opens is not followed.
    """
    distance = np.maximum(length(offset), 1.0)[:, None]
    sight = offset / distance
    closing_speed = np.maximum(-dot(sight, closing), 0.0)[:, None]
    # The part of the relative velocity across the line of sight, over the distance, turns it: omega x sight.
    size = dot(sight, sight)[:, None]
    return (
        np.asarray(constant)[..., None]
        * closing_speed
        * (closing * size - sight * dot(sight, closing)[:, None])
        / distance
    )


def at_most(vector: Array, limit: Array) -> Array:
    """Vectors `[n, 3]`, shortened to lengths `[n]` where they are longer."""
    return vector * np.minimum(1.0, limit / np.maximum(length(vector), 1e-6))[:, None]


def across(vector: Array, unit: Array) -> Array:
    """The part of vectors `[n, 3]` that is perpendicular to unit vectors."""
    return vector - dot(vector, unit)[:, None] * unit


def closest_approach(before: Array, after: Array) -> Array:
    """Smallest length `[n]` [m] of relative positions that move straight from `before` to `after` `[n, 3]`."""
    move = after - before
    path = dot(move, move)
    share = np.clip(-dot(before, move) / np.where(path > 1e-12, path, 1e-12), 0.0, 1.0)
    return length(before + share[:, None] * move)
