"""Physics of the kernel as Warp functions: atmosphere, aircraft, missile, closest approach; SI units, radians."""

import warp as wp

GRAVITY = wp.constant(9.80665)
PI = wp.constant(3.14159265358979)


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
    """State of one aircraft: position [m], speed [m/s], climb angle, heading and bank [rad], left turns positive."""

    position: wp.vec3
    speed: float
    climb: float
    heading: float
    bank: float


@wp.struct
class Missile:
    """State of one missile in flight: position [m], velocity [m/s], lateral acceleration [m/s^2], age [s]."""

    position: wp.vec3
    velocity: wp.vec3
    lateral: wp.vec3
    age: float


@wp.func
def wrap_to_pi(angle: float) -> float:
    """The same angle in (-pi, pi] [rad]."""
    return angle - 2.0 * PI * wp.ceil((angle - PI) / (2.0 * PI))


@wp.func
def temperature(altitude: float) -> float:
    """ISA temperature [K] up to 20 km (ICAO Doc 7488)."""
    return 288.15 - 0.0065 * wp.min(altitude, 11000.0)


@wp.func
def density(altitude: float) -> float:
    """ISA air density [kg/m^3] up to 20 km (ICAO Doc 7488)."""
    troposphere = 1.225 * wp.pow(temperature(altitude) / 288.15, 4.2558797)
    return troposphere * wp.exp(-wp.max(altitude - 11000.0, 0.0) / 6341.62)


@wp.func
def sound_speed(altitude: float) -> float:
    """Speed of sound [m/s] in the ISA."""
    return wp.sqrt(401.874 * temperature(altitude))


@wp.func
def direction(climb: float, heading: float) -> wp.vec3:
    """Unit vector of flight for a climb angle and a heading [rad]."""
    return wp.vec3(wp.cos(climb) * wp.cos(heading), wp.cos(climb) * wp.sin(heading), wp.sin(climb))


@wp.func
def fly_aircraft(a: Aircraft, m: AircraftModel, heading: float, altitude: float, speed: float, dt: float) -> Aircraft:
    """One substep [s] of bank-to-turn flight towards a commanded heading [rad], altitude [m] and speed [m/s].

    The controller asks for the vertical acceleration that holds the altitude and spends what is left of the load
    factor (structural limit or lift limit) on the turn; thrust replaces drag as far as the engine can.
    """
    rho = density(a.position[2])
    lift_area = 0.5 * rho * a.speed * a.speed * m.wing_area
    weight = m.mass * GRAVITY
    limit = wp.min(m.load_factor_max, lift_area * m.cl_max / weight)
    climb_wanted = wp.clamp(0.05 * (altitude - a.position[2]) / a.speed, -0.15, 0.15)
    pull = wp.clamp(wp.cos(a.climb) + a.speed * (climb_wanted - a.climb) / GRAVITY, 0.2, 0.95 * limit)
    turn_max = wp.sqrt(wp.max(limit * limit - pull * pull, 0.0))
    turn = wp.clamp(a.speed * m.heading_gain * wrap_to_pi(heading - a.heading) / GRAVITY, -turn_max, turn_max)
    roll = wp.clamp(wp.atan2(turn, pull) - a.bank, -m.roll_rate_max * dt, m.roll_rate_max * dt)
    bank = a.bank + roll
    load = wp.min(pull / wp.cos(bank), limit)
    drag = lift_area * m.cd0 + m.induced_drag * load * load * weight * weight / lift_area
    thrust = wp.clamp(drag + 0.2 * m.mass * (speed - a.speed), 0.0, m.thrust_max * wp.pow(rho / 1.225, 0.7))
    out = Aircraft()
    out.speed = wp.max(a.speed + dt * ((thrust - drag) / m.mass - GRAVITY * wp.sin(a.climb)), 30.0)
    out.climb = a.climb + dt * GRAVITY * (load * wp.cos(bank) - wp.cos(a.climb)) / a.speed
    out.heading = wrap_to_pi(a.heading + dt * GRAVITY * load * wp.sin(bank) / (a.speed * wp.cos(a.climb)))
    out.bank = bank
    before = a.speed * direction(a.climb, a.heading)
    after = out.speed * direction(out.climb, out.heading)
    out.position = a.position + 0.5 * dt * (before + after)
    return out


@wp.func
def drag_shape(mach: float) -> float:
    """Zero-lift drag relative to its peak at Mach 1.2, by Mach number (points of the public AIM-120C table)."""
    shape = 0.532
    shape = wp.where(mach > 0.6, wp.lerp(0.532, 0.853, (mach - 0.6) / 0.4), shape)
    shape = wp.where(mach > 1.0, wp.lerp(0.853, 1.0, (mach - 1.0) / 0.2), shape)
    shape = wp.where(mach > 1.2, wp.lerp(1.0, 0.819, (mach - 1.2) / 0.8), shape)
    shape = wp.where(mach > 2.0, wp.lerp(0.819, 0.630, mach - 2.0), shape)
    shape = wp.where(mach > 3.0, wp.lerp(0.630, 0.504, mach - 3.0), shape)
    return wp.where(mach > 4.0, 0.504, shape)


@wp.func
def proportional_navigation(offset: wp.vec3, closing: wp.vec3, constant: float) -> wp.vec3:
    """True proportional navigation, a = N V_c (omega x los) [m/s^2]; `offset`, `closing`: target minus missile."""
    distance = wp.max(wp.length(offset), 1.0)
    line_of_sight = offset / distance
    omega = wp.cross(offset, closing) / (distance * distance)
    return constant * wp.max(-wp.dot(line_of_sight, closing), 0.0) * wp.cross(omega, line_of_sight)


@wp.func
def fly_missile(s: Missile, m: MissileModel, target: wp.vec3, target_velocity: wp.vec3, dt: float) -> Missile:
    """One substep [s] of a guided missile towards a target [m, m/s]."""
    speed = wp.length(s.velocity)
    forward = s.velocity / speed
    altitude = s.position[2]
    pressure = 0.5 * density(altitude) * speed * speed
    wanted = proportional_navigation(target - s.position, target_velocity - s.velocity, m.navigation_constant)
    wanted = wanted + wp.vec3(0.0, 0.0, GRAVITY)
    wanted = wanted - wp.dot(wanted, forward) * forward
    limit = m.load_factor_max * GRAVITY * wp.min(1.0, pressure / wp.max(m.full_load_pressure, 1.0))
    wanted = wanted * wp.min(1.0, limit / wp.max(wp.length(wanted), 1.0e-6))
    lateral = s.lateral + (wanted - s.lateral) * (1.0 - wp.exp(-dt / m.lag))
    lateral = lateral - wp.dot(lateral, forward) * forward
    burnt = wp.clamp(s.age / wp.max(m.burn, 1.0e-6), 0.0, 1.0)
    mass = m.mass - m.propellant * burnt
    # The motor burns for its very time, whatever the substep: the last one gets its share of the thrust.
    thrust = m.thrust * wp.clamp((m.burn - s.age) / dt, 0.0, 1.0)
    normal = mass * wp.length(lateral)
    drag = pressure * m.area * m.cd0 * drag_shape(speed / sound_speed(altitude))
    drag = drag + m.induced_drag * normal * normal / (pressure * m.area)
    acceleration = forward * ((thrust - drag) / mass) + lateral - wp.vec3(0.0, 0.0, GRAVITY)
    out = Missile()
    out.velocity = s.velocity + dt * acceleration
    out.position = s.position + 0.5 * dt * (s.velocity + out.velocity)
    out.lateral = lateral
    out.age = s.age + dt
    return out


@wp.func
def closest_approach(before: wp.vec3, after: wp.vec3) -> float:
    """Smallest distance [m] while a relative position moves straight from `before` to `after`."""
    move = after - before
    share = wp.clamp(-wp.dot(before, move) / wp.max(wp.dot(move, move), 1.0e-12), 0.0, 1.0)
    return wp.length(before + share * move)
