"""What the kernel holds: the scenario's numbers, the state, and the codes of fates and outcomes.

A thread moves a group of WIDTH lanes. Each number of a group lies in a row of WIDTH values, so that the compiler turns
a loop over the lanes of a group into vector instructions: fifteen times faster than one lane after the other.
"""

import warp as wp

from sim.kernel.physics import AircraftModel, MissileModel

# Warp greets and reports compilations on standard output, where commands print one JSON object and nothing else.
wp.config.log_level = wp.LOG_ERROR
# Sums of products may be fused. Loops over the lanes of a group must stay loops, or they are not vectorised.
_FLAGS = f"{wp.config.cpu_compiler_flags or '-march=native'} -ffp-contract=fast"
OPTIONS = {"enable_backward": False, "max_unroll": 8, "cpu_compiler_flags": _FLAGS}
"""Options of every module that holds a kernel."""

WIDTH = wp.constant(16)
Row = wp.types.vector(WIDTH, float)
IntRow = wp.types.vector(WIDTH, int)

X = wp.constant(0)  # rows of Aircraft and of Missile: position [m]
Y = wp.constant(1)
Z = wp.constant(2)
VX = wp.constant(3)  # velocity [m/s]
VY = wp.constant(4)
VZ = wp.constant(5)
SPEED = wp.constant(6)  # rows of Aircraft: speed [m/s], angles [rad], altitude and speed the controllers hold
CLIMB = wp.constant(7)
HEADING = wp.constant(8)
BANK = wp.constant(9)
LEVEL = wp.constant(10)
CRUISE = wp.constant(11)
CARRY = wp.constant(12)  # x, y, z of what float32 could not hold of the position [m]
AIRCRAFT_ROWS = wp.constant(15)
AircraftRows = wp.types.matrix((AIRCRAFT_ROWS, WIDTH), float)

AX = wp.constant(6)  # rows of Missile: lateral acceleration [m/s^2], age [s], smallest distance so far [m]
AY = wp.constant(7)
AZ = wp.constant(8)
AGE = wp.constant(9)
CLOSEST = wp.constant(10)
REACH = wp.constant(11)  # rows of Missile: what was drawn for the shot, see sim.kernel.physics.Shot
INTERVAL = wp.constant(12)
THRUST = wp.constant(13)
DRAG = wp.constant(14)
NAVIGATION = wp.constant(15)
RESPONSE = wp.constant(16)
MISS = wp.constant(17)  # smallest distance in the last substep [m]
CARRIED = wp.constant(18)  # x, y, z as in CARRY
MISSILE_ROWS = wp.constant(21)
MissileRows = wp.types.matrix((MISSILE_ROWS, WIDTH), float)

UNLAUNCHED = wp.constant(0)  # the values of sim.world.Fate
IN_FLIGHT = wp.constant(1)
EVADED = wp.constant(2)
HIT = wp.constant(3)

FLYING = wp.constant(0)  # the values of sim.world.Outcome
EXIT = wp.constant(1)
SHOT_DOWN = wp.constant(2)
LEFT_FIELD = wp.constant(3)
TIMEOUT = wp.constant(4)
NOT_FINITE = wp.constant(5)


@wp.struct
class Model:
    """A scenario as the kernel reads it; units as in `sim.scenario`."""

    evader: AircraftModel
    interceptor: AircraftModel
    missile: MissileModel
    half_length: float
    half_width: float
    exit_y: float
    exit_half_width: float
    radar_range: float
    radar_half_angle: float
    launch_range: float
    tail_fraction: float
    range_min: float
    interval: float
    dt: float
    substeps: int
    max_steps: int
    outside_steps: int
    reward_exit: float
    reward_evaded: float
    reward_shot_down: float
    reward_step: float


@wp.struct
class State:
    """All mutable arrays of the world; leading axis groups of lanes, aircraft axis [evader, interceptor]."""

    aircraft: wp.array2d(dtype=AircraftRows)
    missile: wp.array2d(dtype=MissileRows)
    fate: wp.array2d(dtype=IntRow)
    available: wp.array(dtype=int)  # 1 when the missile is not masked [M]
    waiting: wp.array(dtype=IntRow)  # index of the missile to be fired next, or -1
    patience: wp.array(dtype=Row)  # how long it waits after the launch before it [s]
    reach: wp.array(dtype=Row)  # furthest from which it can be fired at all [m]
    since_launch: wp.array(dtype=Row)  # [s]
    steps: wp.array(dtype=IntRow)
    outside: wp.array(dtype=IntRow)  # consecutive steps outside the battlefield
    outcome: wp.array(dtype=IntRow)
    killer: wp.array(dtype=IntRow)
