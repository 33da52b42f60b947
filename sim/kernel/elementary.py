"""Sine, cosine and arctangent as polynomials, for Warp.

The C library's functions took two thirds of a step of the world. These are good to 2e-7, about the resolution of a
float32 angle; the coefficients are least-maximum fits in the square of the argument.
"""

import warp as wp

PI = wp.constant(3.14159265358979)
HALF_PI = wp.constant(1.57079632679490)


@wp.func
def wrap_to_pi(angle: float) -> float:
    """The same angle in (-pi, pi] [rad]."""
    return angle - 2.0 * PI * wp.ceil((angle - PI) / (2.0 * PI))


@wp.func
def near_sine(x: float) -> float:
    """Sine of an angle in [-pi/2, pi/2] [rad]."""
    t = x * x
    p = 1.0 + t * (-0.16666667 + t * (8.333331e-3 + t * (-1.9840862e-4 + t * (2.7525298e-6 - t * 2.388966e-8))))
    return x * p


@wp.func
def sine(angle: float) -> float:
    """Sine of an angle in [-pi, pi] [rad]."""
    return near_sine(wp.where(wp.abs(angle) > HALF_PI, wp.where(angle > 0.0, PI, -PI) - angle, angle))


@wp.func
def near_cosine(x: float) -> float:
    """Cosine of an angle in [-pi/2, pi/2] [rad]."""
    t = x * x
    p = 0.04166666 + t * (-1.38886596e-3 + t * (2.4775018e-5 - t * 2.630549e-7))
    return 1.0 + t * (-0.5 + t * p)


@wp.func
def cosine(angle: float) -> float:
    """Cosine of an angle in [-pi, pi] [rad]."""
    size = wp.abs(angle)
    return wp.where(size > HALF_PI, -near_cosine(PI - size), near_cosine(size))


@wp.func
def arctangent(y: float, x: float) -> float:
    """Angle of the point (x, y) in (-pi, pi] [rad]; 0 at the origin."""
    across = wp.abs(x)
    up = wp.abs(y)
    ratio = wp.min(across, up) / wp.max(wp.max(across, up), 1.0e-30)
    t = ratio * ratio
    p = 0.10654679 + t * (-0.07533678 + t * (0.04303939 + t * (-0.01628302 + t * 0.00290355)))
    angle = ratio * (0.99999999 + t * (-0.33333094 + t * (0.19993054 + t * (-0.14207134 + t * p))))
    angle = wp.where(up > across, HALF_PI - angle, angle)
    angle = wp.where(x < 0.0, PI - angle, angle)
    return wp.where(y < 0.0 and angle < PI, -angle, angle)
