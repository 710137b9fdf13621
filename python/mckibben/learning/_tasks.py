"""What is controlled in each environment: the plant, what is seen of it, and the targets."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass

from mckibben._mckibben import Scenario
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
[load]
kind = "isometric"
[initial]
gauge_pressure = "15 psi"
length = "80 mm"
"""
)


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
    what an observation has of the plant, before the targets. With `leg`, the plant is a leg whose strands are the
    scenario's actuator, with these numbers other than assumed.
    """

    scenario: Scenario
    targets: Ranges
    seen: tuple[Seen, ...]
    leg: Mapping[str, float] | None = None


def hanging_mass(scenario: Scenario | None = None, targets: Ranges | None = None) -> Task:
    """A muscle of the paper that lifts a mass of 5 lb; the length is to reach its target."""
    ranges = among({"length_m": (0.070, 0.090)}, targets)
    seen = (position("length_m", ranges), velocity("velocity_m_s", "length_m", ranges), pressure("pressure_pa"))
    return Task(scenario or Scenario(HANGING_MASS, "HangingMass"), ranges, seen)


def joint(scenario: Scenario | None = None, targets: Ranges | None = None) -> Task:
    """A limb that two muscles of the paper turn against each other about a pulley; the angle is to reach its target."""
    ranges = among({"angle_rad": (math.radians(-30.0), math.radians(30.0))}, targets)
    seen = (
        position("angle_rad", ranges),
        velocity("angular_velocity_rad_s", "angle_rad", ranges),
        pressure("pressure_pa"),
        pressure("antagonist_pressure_pa"),
    )
    return Task(scenario or Scenario(JOINT, "Joint"), ranges, seen)


def leg(
    scenario: Scenario | None = None, targets: Ranges | None = None, numbers: Mapping[str, float] | None = None
) -> Task:
    """A leg of a small dog's size, whose numbers are assumed, on six muscles of the paper; hip and knee are to reach their
    targets, and where the foot comes low enough a belt drags it."""
    hip, knee = "hip_angle_rad", "knee_angle_rad"
    ranges = among(
        {
            hip: (math.radians(-25.0), math.radians(25.0)),
            knee: (math.radians(-70.0), math.radians(-20.0)),
        },
        targets,
    )
    seen = (
        position(hip, ranges),
        position(knee, ranges),
        velocity("hip_angular_velocity_rad_s", hip, ranges),
        velocity("knee_angular_velocity_rad_s", knee, ranges),
        *(pressure(f"pressure_{strand}_pa") for strand in range(6)),
    )
    return Task(scenario or Scenario(LEG, "Leg"), ranges, seen, numbers or {})


TASKS: Mapping[str, Callable[..., Task]] = {"HangingMass": hanging_mass, "Joint": joint, "Leg": leg}


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


def velocity(column: str, of: str, ranges: Ranges) -> Seen:
    """A velocity, in ranges of targets for each tenth of a second."""
    low, high = ranges[of]
    return Seen(column, 0.0, (high - low) / 0.1)


def pressure(column: str) -> Seen:
    """A pressure above 101325 Pa, in units of 500 kPa."""
    return Seen(column, 101325.0, 5e5, 0.0)
