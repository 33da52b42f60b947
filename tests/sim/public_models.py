"""Aircraft and missiles of public models, flown by the shortest program that can: what our figures stand beside.

Numbers are quoted from the files named at each; the programs are a point mass in level flight and know nothing of ours.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

GRAVITY = 9.80665
POUND_FORCE_N = 4.44822
FOOT_M = 0.3048


@dataclass(frozen=True)
class PublicMissile:
    """A boost(-sustain) missile: stages of (thrust [N], seconds, propellant [kg]), drag by Mach number."""

    name: str
    mass_kg: float
    stages: tuple[tuple[float, float, float], ...]
    mach: Sequence[float]
    drag: Sequence[float]
    area_m2: float
    delay_s: float = 0.0


def _flightgear_drag(cd: float) -> tuple[list[float], list[float]]:
    # NikolaiVChr/f16, the function `drag` of its guided missiles: five times the base value, by Mach number.
    mach = [0.0, 0.69, 0.7, 0.8, 0.9, 1.0, 1.1, 1.19, 1.2, 1.5, 2.0, 2.5, 3.0, 3.5, 4.0, 5.0]
    low = [0.0125 * m + 0.2 for m in mach if m < 0.7]
    middle = [0.3742 * m**2 - 0.252 * m + 0.2021 for m in mach if 0.7 <= m < 1.2]
    high = [0.2965 * m**-1.1506 + 0.2 for m in mach if m >= 1.2]
    return mach, [5.0 * cd * share for share in low + middle + high]


_FG_BOOST, _FG_SUSTAIN = (2700 * POUND_FORCE_N, 10.0), (280 * POUND_FORCE_N, 18.0)
_FG_SHARE = 59.0 / (math.prod(_FG_BOOST) + math.prod(_FG_SUSTAIN))
AMRAAMS = (
    # lizi-Margin/bvr_sim, src_py/simulator/missile/aim120c.py and aim120c_adv_sim.py
    PublicMissile("bvr_sim AIM-120C", 161.48, ((16325.0, 8.0, 51.28),),
                  (0.6, 1.0, 1.2, 2.0, 3.0, 4.0), (0.468, 0.751, 0.88, 0.7205, 0.5545, 0.4439), 0.02487),
    # Notimetimer/project03_fire_and_dodge_missile, Envs/MissileModel1112.py
    PublicMissile("Notimetimer two-stage AMRAAM", 162.0, ((20393.0, 2.3, 20.28), (9360.5, 10.5, 44.9)),
                  (0.6, 1.0, 1.4, 2.4, 4.0), (0.016, 0.045, 0.034, 0.026, 0.0215), 0.41, delay_s=0.5),
    # NikolaiVChr/f16, f16-base.xml, payload/armament/aim-120; propellant shared by impulse
    PublicMissile("FlightGear AIM-120B", 132.0,
                  tuple((*stage, math.prod(stage) * _FG_SHARE) for stage in (_FG_BOOST, _FG_SUSTAIN)),
                  *_flightgear_drag(0.20), 0.2739 * FOOT_M**2),
    # simldl/bvr-marl, src/bvr_marl_core/missiles/fox3/amraam.py; no loss of mass
    PublicMissile("bvr-marl AMRAAM", 160.0, ((9000.0, 8.0, 0.0),), (0.0, 1.0), (0.08, 0.08), 0.025),
)  # fmt: skip


def air(altitude_m: float) -> tuple[float, float]:
    """Density [kg/m^3] and speed of sound [m/s] of the standard atmosphere below 11 km."""
    kelvin = 288.15 - 0.0065 * altitude_m
    return 1.225 * (kelvin / 288.15) ** 4.2559, math.sqrt(1.4 * 287.053 * kelvin)


def level_fly_out(
    missile: PublicMissile, altitude_m: float, lift_drag: float = 0.0, speed_m_s: float = 300.0
) -> NDArray[np.float64]:
    """Age [s], speed [m/s] and distance [m] `[n, 3]` of level flight at 1 g; `lift_drag` is K in K (m g)^2 / (q S)."""
    density, sound = air(altitude_m)
    age, speed, distance, mass, dt = 0.0, speed_m_s, 0.0, missile.mass_kg, 0.01
    rows = [(age, speed, distance)]
    while age < 180.0 and speed > 150.0:
        thrust, burning = _motor(missile, age)
        pressure_area = 0.5 * density * speed**2 * missile.area_m2
        drag = pressure_area * float(np.interp(speed / sound, missile.mach, missile.drag))
        drag += lift_drag * (mass * GRAVITY) ** 2 / pressure_area
        after = speed + dt * (thrust - drag) / mass
        age, speed, distance, mass = age + dt, after, distance + dt * (speed + after) / 2, mass - dt * burning
        rows.append((age, speed, distance))
    return np.array(rows)


def fly_out_row(missile: PublicMissile, altitude_m: float, lift_drag: float = 0.0) -> list[float]:
    """Peak speed, speed at 30 s and 60 s [m/s], range at 30 s and 60 s and while above Mach 1 [km]; NaN for ever."""
    age, speed, distance = level_fly_out(missile, altitude_m, lift_drag).T
    slow = np.flatnonzero((speed < air(altitude_m)[1]) & (age > sum(stage[1] for stage in missile.stages)))
    speeds = [speed.max(), *np.interp([30.0, 60.0], age, speed)]
    ranges = [*np.interp([30.0, 60.0], age, distance), distance[slow[0]] if len(slow) else math.nan]
    return [float(value) for value in (*speeds, *(metres / 1e3 for metres in ranges))]


def _motor(missile: PublicMissile, age: float) -> tuple[float, float]:
    """Thrust [N] and propellant flow [kg/s]."""
    since = age - missile.delay_s
    for thrust, seconds, propellant in missile.stages:
        if 0.0 <= since < seconds - 1e-9:
            return thrust, propellant / seconds
        since -= seconds
    return 0.0, 0.0


# JSBSim, aircraft/f16/f16.xml: drag and lift of the clean aircraft by angle of attack [rad], elevator neutral (after
# NASA TP-1538), drag rise by Mach number; engine/F100-PW-229.xml: thrust with reheat by Mach number and altitude [ft].
F16_ALPHA = (-0.175, -0.087, 0.0, 0.087, 0.175, 0.262, 0.349, 0.436, 0.524)
F16_LIFT = (-0.754, -0.238, 0.100, 0.414, 0.725, 1.041, 1.327, 1.547, 1.737)
F16_DRAG = (0.156, 0.041, 0.021, 0.040, 0.096, 0.182, 0.347, 0.577, 0.826)
F16_DRAG_RISE = ((0.0, 0.81, 1.1, 1.8), (0.0, 0.0, 0.023, 0.015))
F16_AREA_M2 = 300 * FOOT_M**2
F16_REHEAT_N = 29000 * POUND_FORCE_N
F16_MACH, F16_FEET = (0.6, 0.8, 1.0), (0.0, 10e3, 20e3, 30e3, 40e3)
F16_THRUST = (
    (0.9589, 0.7894, 0.6420, 0.5134, 0.3661),
    (0.9942, 0.8177, 0.6647, 0.5309, 0.3784),
    (1.0529, 0.8648, 0.7017, 0.5596, 0.3983),
)
F16_LOAD_FACTOR_MAX = 9.0


def f16_figures(altitude_m: float, mach: float, mass_kg: float) -> tuple[float, float, float, float]:
    """JSBSim's F-16 with reheat: sustained turn [deg/s] and its g, instantaneous turn [deg/s], excess power [m/s]."""
    density, sound = air(altitude_m)
    speed, weight = mach * sound, mass_kg * GRAVITY
    alpha = np.linspace(0.0, 0.5, 5001)
    pressure_area = 0.5 * density * speed**2 * F16_AREA_M2
    by_altitude = [float(np.interp(altitude_m / FOOT_M, F16_FEET, row)) for row in F16_THRUST]
    thrust = F16_REHEAT_N * float(np.interp(mach, F16_MACH, by_altitude))
    drag = pressure_area * (np.interp(alpha, F16_ALPHA, F16_DRAG) + np.interp(mach, *F16_DRAG_RISE))
    load = (pressure_area * np.interp(alpha, F16_ALPHA, F16_LIFT) + thrust * np.sin(alpha)) / weight
    spare = thrust * np.cos(alpha) - drag
    sustained = min(float(load[spare > 0.0].max()), F16_LOAD_FACTOR_MAX)
    at_once = min(float(load.max()), F16_LOAD_FACTOR_MAX)
    rates = [math.degrees(GRAVITY * math.sqrt(n**2 - 1.0) / speed) for n in (sustained, at_once)]
    return rates[0], sustained, rates[1], float(np.interp(1.0, load, spare)) * speed / weight
