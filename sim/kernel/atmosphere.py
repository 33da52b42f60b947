"""The International Standard Atmosphere up to 20 km (ICAO Doc 7488), for Warp."""

import warp as wp

TROPOPAUSE = wp.constant(11000.0)


@wp.func
def temperature(altitude: float) -> float:
    """Temperature [K]."""
    return 288.15 - 0.0065 * wp.min(altitude, TROPOPAUSE)


@wp.func
def fading(u: float) -> float:
    """exp(-u) for u in [0, 4], 1 below; the fourth power of a polynomial, good to 7e-7."""
    t = wp.clamp(0.25 * u, 0.0, 1.0)
    p = -0.16661124 + t * (0.04142316 + t * (-0.00784238 + t * 9.1454876e-4))
    root = 1.0 + t * (-0.99999994 + t * (0.49999536 + t * p))
    return root * root * root * root


@wp.func
def density(altitude: float) -> float:
    """Air density [kg/m^3].

    Below the tropopause the power 4.2559 of the temperature, as a polynomial that is good to 1e-7 from -500 m up: a
    call of `pow` in every substep cost as much as the rest of the aircraft.
    """
    h = wp.min(altitude, TROPOPAUSE) / TROPOPAUSE - 0.5
    p = 0.3875785 + h * (-0.08256014 + h * (7.3414925e-3 - h * 1.0665832e-4))
    return (0.69710536 + h * (-0.84043564 + h * p)) * fading((altitude - TROPOPAUSE) / 6341.62)


@wp.func
def thrust_share(altitude: float) -> float:
    """Thrust relative to sea level: the power 0.7 of relative density, a polynomial as in `density`."""
    h = wp.min(altitude, TROPOPAUSE) / TROPOPAUSE - 0.5
    share = 0.6739282 + h * (-0.56874512 + h * (0.15943206 + h * (-0.01474069 - h * 2.184805e-5)))
    return share * fading(0.7 * (altitude - TROPOPAUSE) / 6341.62)


@wp.func
def sound_speed(altitude: float) -> float:
    """Speed of sound [m/s]."""
    return wp.sqrt(401.874 * temperature(altitude))
