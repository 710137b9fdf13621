"""What is controlled in each environment: the plant, what is seen of it, and the targets."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from mckibben._mckibben import VectorPlant, Scenario
from mckibben.errors import InputError

Ranges = Mapping[str, tuple[float, float]]

MUSCLE = """
[actuator]
preset = "colbrunn-2001"
[supply]
gauge_pressure = "100 psi"
[valve]
preset = "matrix-eight-channel"
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.5
[run]
duration = "2 s"
engine = "fixed-step"
method = "rk4"
"""
HANGING_MASS = (
    MUSCLE
    + """
step = "0.5 ms"
[load]
kind = "hanging-mass"
mass = "5 lb"
[initial]
gauge_pressure = "40 psi"
length = "equilibrium"
"""
)
JOINT = (
    MUSCLE
    + """
step = "0.2 ms"
[load]
kind = "antagonistic-joint"
pulley_radius = "15 mm"
rest_length = "3.3 in"
mass = "0.5 kg"
distance = "100 mm"
inertia = "1e-3 kg*m^2"
damping = "0.02 N*m*s/rad"
min_angle = "-40 deg"
max_angle = "40 deg"
[initial]
gauge_pressure = "20 psi"
"""
)
LEG = (
    MUSCLE
    + """
step = "0.2 ms"
[initial]
gauge_pressure = "15 psi"
[mechanism]
kind = "chain"
[mechanism.joints.hip]
segment = "thigh"
length = "22 cm"
mass = "0.40 kg"
distance = "9 cm"
inertia = "1.6e-3 kg*m^2"
damping = "0.02 N*m*s/rad"
min_angle = "-60 deg"
max_angle = "60 deg"
stop_stiffness = "50 N*m/rad"
stop_damping = "0.3 N*m*s/rad"
angle = "0.1 rad"
[mechanism.joints.knee]
segment = "shank"
length = "22 cm"
mass = "0.22 kg"
distance = "10 cm"
inertia = "0.9e-3 kg*m^2"
damping = "0.02 N*m*s/rad"
min_angle = "-100 deg"
max_angle = "-5 deg"
stop_stiffness = "50 N*m/rad"
stop_damping = "0.3 N*m*s/rad"
angle = "-0.5 rad"
[mechanism.belt]
depth = "43.2 cm"
velocity = "-0.35 m/s"
stiffness = "20 kN/m"
damping = "80 N*s/m"
friction = 0.6
slipping_speed = "2 cm/s"
[coupling]
rest_length = "80 mm"
[actuators.both-forward]
coupling.arms = { hip = "8 mm", knee = "8 mm" }
[actuators.both-back]
coupling.arms = { hip = "-8 mm", knee = "-8 mm" }
[actuators.hip-forward]
coupling.arms.hip = "18 mm"
[actuators.hip-back]
coupling.arms.hip = "-18 mm"
[actuators.knee-forward]
coupling.arms.knee = "15 mm"
coupling.rest_length = "78 mm"
[actuators.knee-back]
coupling.arms.knee = "-15 mm"
coupling.rest_length = "78 mm"
"""
)
ARM = """
[supplies.tank]
gauge_pressure = "6.6 bar"
reservoir_volume = "300 cm^3"
compressor_displacement = "40 L/min"
cut_in_gauge_pressure = "6.5 bar"
cut_out_gauge_pressure = "8 bar"
[supplies.regulator]
from = "tank"
gauge_pressure = "4 bar"
lag = "20 ms"
droop = "2e7 Pa*s/kg"
[supplies.manifold]
from = "regulator"
reservoir_volume = "50 cm^3"
inlet.flow_area = "10 mm^2"
[valve]
preset = "matrix-eight-channel"
kind = "fill-hold-exhaust"
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.5
[initial]
gauge_pressure = "1 bar"
[mechanism]
kind = "chain"
[mechanism.joints.shoulder]
segment = "upper-arm"
length = "28 cm"
mass = "0.8 kg"
distance = "12 cm"
inertia = "5e-3 kg*m^2"
damping = "0.05 N*m*s/rad"
min_angle = "-60 deg"
max_angle = "60 deg"
[mechanism.joints.elbow]
segment = "forearm"
length = "24 cm"
mass = "0.5 kg"
distance = "10 cm"
inertia = "2.5e-3 kg*m^2"
damping = "0.04 N*m*s/rad"
min_angle = "-10 deg"
max_angle = "100 deg"
angle = "20 deg"
[mechanism.joints.wrist]
segment = "hand"
mass = "0.2 kg"
distance = "6 cm"
inertia = "3e-4 kg*m^2"
damping = "0.02 N*m*s/rad"
min_angle = "-50 deg"
max_angle = "50 deg"
[coupling]
rest_length = "3.4 in"
[actuators.deltoid]
coupling.arms.shoulder = "20 mm"
[actuators.latissimus]
coupling.arms.shoulder = "-20 mm"
[actuators.biceps]
coupling.arms = { shoulder = "12 mm", elbow = "15 mm" }
[actuators.triceps]
coupling.arms.elbow = "-12 mm"
[actuators.flexor]
coupling.arms.wrist = "10 mm"
[actuators.extensor]
coupling.arms.wrist = "-10 mm"
[run]
duration = "2 s"
engine = "fixed-step"
step = "0.5 ms"
"""


@dataclass(frozen=True)
class Seen:
    """One entry of an observation: a column of the plant, from which `zero` is taken and which is divided by `unit`; `least`
    is the least that the column can be, in SI."""

    column: str
    zero: float
    unit: float
    least: float = -math.inf


@dataclass(frozen=True)
class Task:
    """A plant that is to be brought to targets.

    `targets` are the columns that are to reach a target, each with the range in SI that targets are drawn from; `seen` is
    what an observation has of the plant, before the targets.
    """

    scenario: Scenario
    targets: Ranges
    seen: tuple[Seen, ...]


def hanging_mass(scenario: Scenario | None = None, targets: Ranges | None = None) -> Task:
    """A muscle of the paper that lifts a mass of 5 lb; the length is to reach its target."""
    ranges = among({"length_m": (0.070, 0.090)}, targets)
    seen = (position("length_m", ranges), velocity("velocity_m_s", "length_m", ranges), pressure("absolute_pressure_pa"))
    return Task(scenario or Scenario(HANGING_MASS, "HangingMass"), ranges, seen)


def joint(scenario: Scenario | None = None, targets: Ranges | None = None) -> Task:
    """A limb that two muscles of the paper turn against each other about a pulley; the angle is to reach its target."""
    ranges = among({"angle_rad": (math.radians(-30.0), math.radians(30.0))}, targets)
    seen = (
        position("angle_rad", ranges),
        velocity("angular_velocity_rad_s", "angle_rad", ranges),
        pressure("absolute_pressure_pa"),
        pressure("antagonist_absolute_pressure_pa"),
    )
    return Task(scenario or Scenario(JOINT, "Joint"), ranges, seen)


def leg(scenario: Scenario | None = None, targets: Ranges | None = None) -> Task:
    """A leg of a small dog's size, whose numbers are assumed, on six muscles of the paper; hip and knee are to reach their
    targets, and where the foot comes low enough a belt drags it. A scenario is one with joints `hip` and `knee`."""
    own = {
        "hip.angle_rad": (math.radians(-25.0), math.radians(25.0)),
        "knee.angle_rad": (math.radians(-70.0), math.radians(-20.0)),
    }
    return reach(scenario or Scenario(LEG, "Leg"), among(own, targets))


def arm(scenario: Scenario | None = None, targets: Ranges | None = None) -> Task:
    """An arm of three joints on six muscles, on a manifold behind a regulator and a tank with a compressor; its numbers are
    assumed. All three joints are to reach their targets. A scenario is one with joints `shoulder`, `elbow` and `wrist`."""
    own = {
        "shoulder.angle_rad": (math.radians(-10.0), math.radians(30.0)),
        "elbow.angle_rad": (math.radians(5.0), math.radians(60.0)),
        "wrist.angle_rad": (math.radians(-20.0), math.radians(20.0)),
    }
    return reach(scenario or Scenario(ARM, "Arm"), among(own, targets))


def reach(scenario: Scenario, targets: Ranges) -> Task:
    """Any plant whose columns are to reach targets: an observation has those columns, their velocities and all pressures.
    `mckibben.VectorPlant.columns_of(scenario)` has the names of the columns."""
    columns = VectorPlant.columns_of(scenario)
    for column in targets:
        if column not in columns:
            raise InputError(f"targets: `{column}` is nothing that is seen of this plant; name one of {', '.join(columns)}")
    ranges = among(dict(targets), targets)
    velocities = [(column, velocity_of(column)) for column in ranges]
    seen = (
        *(position(column, ranges) for column in ranges),
        *(velocity(name, column, ranges) for column, name in velocities if name in columns),
        *(pressure(column) for column in columns if column.endswith("absolute_pressure_pa") and column not in ranges),
    )
    return Task(scenario, ranges, seen)


TASKS: Mapping[str, Callable[..., Task]] = {"HangingMass": hanging_mass, "Joint": joint, "Leg": leg, "Arm": arm}
# Of what may be controlled, the name of its velocity.
VELOCITY = {
    "length_m": "velocity_m_s",
    "position_m": "velocity_m_s",
    "angle_rad": "angular_velocity_rad_s",
}


def among(own: dict[str, tuple[float, float]], given: Ranges | None) -> Ranges:
    """The ranges of targets, some of them given."""
    for column, (low, high) in (given or {}).items():
        if column not in own:
            raise InputError(f"targets: `{column}` is not controlled here; name one of {', '.join(own)}")
        if not -math.inf < low < high < math.inf:
            raise InputError(f"targets: {column} from {low} to {high} is no range; give the lower end first, in SI")
    return {**own, **(given or {})}


def position(column: str, ranges: Ranges) -> Seen:
    """What is controlled, from 0 to 1 over the range of its targets."""
    low, high = ranges[column]
    return Seen(column, low, high - low)


def velocity_of(column: str) -> str:
    """The column of the velocity of what is controlled."""
    part, dot, name = column.rpartition(".")
    return part + dot + VELOCITY.get(name, "")


def velocity(column: str, of: str, ranges: Ranges) -> Seen:
    """A velocity, in ranges of targets for each tenth of a second."""
    low, high = ranges[of]
    return Seen(column, 0.0, (high - low) / 0.1)


def pressure(column: str) -> Seen:
    """A pressure above 101325 Pa, in units of 500 kPa."""
    return Seen(column, 101325.0, 5e5, 0.0)
