"""Physics of the kernel as Warp functions: aircraft, missile, closest approach; SI units, radians."""

import warp as wp

from sim.kernel.atmosphere import density, sound_speed, thrust_share
from sim.kernel.elementary import arctangent, cosine, near_cosine, near_sine, sine, wrap_to_pi

GRAVITY = wp.constant(9.80665)


@wp.struct
class AircraftModel:
    """Parameters of one aircraft, in the units of `sim.scenario.Aircraft`."""

    mass: float
    wing_area: float
    cd0: float
    induced_drag: float
    cl_max: float
    load_factor_max: float
    roll_rate_max: float
    thrust_max: float
    heading_gain: float


@wp.struct
class MissileModel:
    """Parameters of the missiles, in the units of `sim.scenario.Missile`."""

    mass: float
    propellant: float
    thrust: float
    burn: float
    area: float
    cd0: float
    induced_drag: float
    navigation_constant: float
    load_factor_max: float
    full_load_pressure: float
    lag: float
    fuse: float
    arm: float
    speed_min: float
    age_max: float
    opening: float


@wp.struct
class Aircraft:
    """State of one aircraft: position [m], velocity [m/s], climb angle, heading and bank [rad], left turns positive.

    The velocity follows from speed, climb angle and heading; it is kept so that their sines are taken once. The carry
    [m] is what float32 could not hold of the position: without it, steps of 13 m at 100 km round by the same 4 mm
    each, 5 m in a minute.
    """

    position: wp.vec3
    carry: wp.vec3
    velocity: wp.vec3
    speed: float
    climb: float
    heading: float
    bank: float


@wp.struct
class Shot:
    """What was drawn for one shot: factors on launch range, interval, thrust, drag and navigation; autopilot lag.

    The lag is held as the share of the way to the wanted acceleration that a substep covers, 1 - exp(-dt / lag).
    """

    reach: float
    interval: float
    thrust: float
    drag: float
    navigation: float
    response: float


@wp.struct
class Missile:
    """State of one missile: position and its carry [m], velocity [m/s], lateral acceleration [m/s^2], age [s]."""

    position: wp.vec3
    carry: wp.vec3
    velocity: wp.vec3
    lateral: wp.vec3
    age: float


@wp.func
def direction(climb: float, heading: float) -> wp.vec3:
    """Unit vector of flight for a climb angle in [-pi/2, pi/2] and a heading in [-pi, pi] [rad]."""
    level = near_cosine(climb)
    return wp.vec3(level * cosine(heading), level * sine(heading), near_sine(climb))


@wp.func
def turn_to(velocity: wp.vec3, offset: wp.vec3) -> float:
    """Turn [rad] in (-pi, pi] that points a velocity, seen from above, along an offset; left positive."""
    return arctangent(
        velocity[0] * offset[1] - velocity[1] * offset[0], velocity[0] * offset[0] + velocity[1] * offset[1]
    )


@wp.func
def fly_aircraft(a: Aircraft, m: AircraftModel, turn: float, altitude: float, speed: float, dt: float) -> Aircraft:
    """One substep [s] of bank-to-turn flight: `turn` [rad] still to go, commanded altitude [m] and speed [m/s].

    The controller asks for the vertical acceleration that holds the altitude and spends what is left of the load
    factor (structural limit or lift limit) on the turn; thrust replaces drag as far as the engine can.
    """
    inverse = 1.0 / a.speed
    lift_area = 0.5 * density(a.position[2]) * a.speed * a.speed * m.wing_area
    weight = m.mass * GRAVITY
    limit = wp.min(m.load_factor_max, lift_area * m.cl_max / weight)
    climb_cosine = near_cosine(a.climb)
    climb_wanted = wp.clamp(0.05 * (altitude - a.position[2]) * inverse, -0.15, 0.15)
    pull = wp.clamp(climb_cosine + a.speed * (climb_wanted - a.climb) / GRAVITY, 0.2, 0.95 * limit)
    side_max = wp.sqrt(wp.max(limit * limit - pull * pull, 0.0))
    side = wp.clamp(a.speed * m.heading_gain * turn / GRAVITY, -side_max, side_max)
    bank = a.bank + wp.clamp(arctangent(side, pull) - a.bank, -m.roll_rate_max * dt, m.roll_rate_max * dt)
    bank_cosine = near_cosine(bank)
    load = wp.min(pull / bank_cosine, limit)
    drag = lift_area * m.cd0 + m.induced_drag * load * load * weight * weight / lift_area
    thrust = wp.clamp(drag + 0.2 * m.mass * (speed - a.speed), 0.0, m.thrust_max * thrust_share(a.position[2]))
    out = Aircraft()
    out.speed = wp.max(a.speed + dt * ((thrust - drag) / m.mass - GRAVITY * near_sine(a.climb)), 30.0)
    out.climb = a.climb + dt * GRAVITY * (load * bank_cosine - climb_cosine) * inverse
    out.heading = wrap_to_pi(a.heading + dt * GRAVITY * load * near_sine(bank) * inverse / climb_cosine)
    out.bank = bank
    out.velocity = out.speed * direction(out.climb, out.heading)
    move = a.carry + 0.5 * dt * (a.velocity + out.velocity)
    out.position = a.position + move
    out.carry = move - (out.position - a.position)
    return out


@wp.func
def drag_shape(mach: float) -> float:
    """Zero-lift drag relative to its peak at Mach 1.2, by Mach number (points of the public AIM-120C table)."""
    rise = 0.8025 * wp.clamp(mach - 0.6, 0.0, 0.4) + 0.735 * wp.clamp(mach - 1.0, 0.0, 0.2)
    fall = 0.22625 * wp.clamp(mach - 1.2, 0.0, 0.8) + 0.189 * wp.clamp(mach - 2.0, 0.0, 1.0)
    return 0.532 + rise - fall - 0.126 * wp.clamp(mach - 3.0, 0.0, 1.0)


@wp.func
def proportional_navigation(offset: wp.vec3, closing: wp.vec3, constant: float) -> wp.vec3:
    """True proportional navigation, a = N V_c (omega x los) [m/s^2]; `offset`, `closing`: target minus missile."""
    distance = wp.max(wp.length(offset), 1.0)
    line_of_sight = offset / distance
    omega = wp.cross(offset, closing) / (distance * distance)
    return constant * wp.max(-wp.dot(line_of_sight, closing), 0.0) * wp.cross(omega, line_of_sight)


@wp.func
def at_most(vector: wp.vec3, limit: float) -> wp.vec3:
    """A vector, shortened to a length where it is longer."""
    return vector * wp.min(1.0, limit / wp.max(wp.length(vector), 1.0e-6))


@wp.func
def autopilot(s: Missile, m: MissileModel, shot: Shot, forward: wp.vec3, wanted: wp.vec3, pressure: float) -> wp.vec3:
    """Lateral acceleration [m/s^2] after a substep: the wanted one follows with a lag, never more than the air gives.

    The limit holds before the lag, for the command, and after it: a pull from faster days would tear a slow missile
    round by its induced drag.
    """
    limit = m.load_factor_max * GRAVITY * wp.min(1.0, pressure / wp.max(m.full_load_pressure, 1.0))
    command = at_most(wanted - wp.dot(wanted, forward) * forward, limit)
    lateral = s.lateral + (command - s.lateral) * shot.response
    return at_most(lateral - wp.dot(lateral, forward) * forward, limit)


@wp.func
def fly_missile(
    s: Missile, m: MissileModel, shot: Shot, target: wp.vec3, target_velocity: wp.vec3, dt: float
) -> Missile:
    """One substep [s] of a guided missile towards a target [m, m/s]."""
    speed = wp.length(s.velocity)
    forward = s.velocity / speed
    altitude = s.position[2]
    pressure = 0.5 * density(altitude) * speed * speed
    constant = m.navigation_constant * shot.navigation
    wanted = proportional_navigation(target - s.position, target_velocity - s.velocity, constant)
    lateral = autopilot(s, m, shot, forward, wanted + wp.vec3(0.0, 0.0, GRAVITY), pressure)
    mass = m.mass - m.propellant * wp.clamp(s.age / wp.max(m.burn, 1.0e-6), 0.0, 1.0)
    # The motor burns for its very time, whatever the substep: the last one gets its share of the thrust.
    thrust = m.thrust * shot.thrust * wp.clamp((m.burn - s.age) / dt, 0.0, 1.0)
    drag = pressure * m.area * m.cd0 * shot.drag * drag_shape(speed / sound_speed(altitude))
    drag = drag + m.induced_drag * mass * mass * wp.dot(lateral, lateral) / (pressure * m.area)
    acceleration = forward * ((thrust - drag) / mass) + lateral - wp.vec3(0.0, 0.0, GRAVITY)
    out = Missile()
    out.velocity = s.velocity + dt * acceleration
    move = s.carry + 0.5 * dt * (s.velocity + out.velocity)
    out.position = s.position + move
    out.carry = move - (out.position - s.position)
    out.lateral = lateral
    out.age = s.age + dt
    return out


@wp.func
def closest_approach(before: wp.vec3, after: wp.vec3) -> float:
    """Smallest distance [m] while a relative position moves straight from `before` to `after`."""
    move = after - before
    share = wp.clamp(-wp.dot(before, move) / wp.max(wp.dot(move, move), 1.0e-12), 0.0, 1.0)
    return wp.length(before + share * move)
