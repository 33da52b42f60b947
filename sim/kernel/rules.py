"""Rules of the engagement, for Warp: when the interceptor may fire, when a missile is spent, who passes the gate."""

import warp as wp

from sim.kernel.lane import Model
from sim.kernel.physics import Aircraft, Missile, MissileModel, turn_to


@wp.func
def launch_zone(model: Model, evader: Aircraft, interceptor: Aircraft, factor: float) -> bool:
    """Whether the interceptor may fire: radar, field of view, and a range that grows from tail chase to head-on."""
    offset = evader.position - interceptor.position
    distance = wp.length(offset)
    facing = -wp.dot(evader.velocity, offset) / (evader.speed * distance)
    aspect_share = model.tail_fraction + (1.0 - model.tail_fraction) * 0.5 * (1.0 + facing)
    furthest = wp.min(model.radar_range, model.launch_range * factor * aspect_share)
    in_range = distance >= model.range_min and distance <= furthest
    return in_range and wp.abs(turn_to(interceptor.velocity, offset)) <= model.radar_half_angle


@wp.func
def spent(model: MissileModel, missile: Missile, distance: float, closest: float) -> bool:
    """Whether a missile is evaded: too slow, too old, or opening again after its closest approach."""
    slow = missile.age > model.burn and wp.length_sq(missile.velocity) < model.speed_min * model.speed_min
    opening = missile.age > model.arm and distance > closest + model.opening
    return slow or missile.age > model.age_max or opening


@wp.func
def through_gate(model: Model, before: wp.vec3, after: wp.vec3) -> bool:
    """Whether a straight move crosses the exit gate on the right edge from inside."""
    share = (model.half_length - before[0]) / wp.max(after[0] - before[0], 1.0e-9)
    crossing = before[1] + share * (after[1] - before[1])
    crosses = before[0] < model.half_length and after[0] >= model.half_length
    return crosses and wp.abs(crossing - model.exit_y) <= model.exit_half_width
