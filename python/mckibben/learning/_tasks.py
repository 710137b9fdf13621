"""Tasks: a plant, targets of its columns, and the columns in an observation."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from mckibben._mckibben import Scenario, VectorPlant
from mckibben._statics import curves
from mckibben.errors import InputError
from mckibben.learning._named import NAMED
from mckibben.learning._plant import Plant

Range = tuple[float, float]
Ranges = Mapping[str, Range]

# Quantities that may be controlled, with the names of their velocities.
VELOCITY = {
    "length_m": "velocity_m_s",
    "position_m": "velocity_m_s",
    "angle_rad": "angular_velocity_rad_s",
}
# Quantities that are above zero.
ABOVE_ZERO = ("length_m", "absolute_pressure_pa", "air_mass_kg", "temperature_k")
# Share of the range of a coordinate that is left out at each end, unless targets are given.
MARGIN = 0.1


@dataclass(frozen=True)
class Seen:
    """Entry of an observation: a column of the plant less `zero`, over `unit`;
    `least` is the least value that the column can have. All are in SI."""

    column: str
    zero: float
    unit: float
    least: float = -math.inf


@dataclass(frozen=True)
class Task:
    """Plant with targets of its columns.

    `targets` are the columns that are to reach a target, each with the range in SI that targets are drawn from; `seen` is
    what an observation has of the plant, before the targets.
    """

    scenario: Scenario
    targets: Ranges
    seen: tuple[Seen, ...]


def reach(scenario: Scenario, targets: Ranges | None = None) -> Task:
    """Make a task of any plant with targets of some of its columns.

    An observation has the columns with targets, their velocities and all pressures.

    Parameters
    ----------
    scenario
        The plant: one actuator, an antagonistic joint, or actuators with names.
    targets
        Ranges in SI from which targets are drawn, by columns of `mckibben.VectorPlant.columns_of(scenario)`. Unless given,
        each coordinate of the plant has a target. Angles have the middle 80 % between the stops of their joint; lengths the
        middle 80 % between the lengths at which the actuator carries its load at the pressure of its supply and at the
        pressure of the atmosphere; the position of a mass that several actuators move the middle 80 % of the lengths that
        all of them can have.

    Raises
    ------
    InputError
        For a column that the plant does not have, for a range that is none or that its quantity cannot have, and where no range can
        be chosen.
    """
    columns = VectorPlant.columns_of(scenario)
    if targets is None:
        targets = chosen(scenario, columns)
    _check(targets, columns)
    _check_threads(scenario, targets)
    velocities = [(column, velocity_of(column)) for column in targets]
    seen = (
        *(_position(column, targets[column]) for column in targets),
        *(_velocity(name, targets[column]) for column, name in velocities if name in columns),
        *(_pressure(column) for column in columns if column.endswith("absolute_pressure_pa") and column not in targets),
    )
    return Task(scenario, dict(targets), seen)


def task(name: str, scenario: Scenario | None = None, targets: Ranges | None = None) -> Task:
    """Make a task by its name.

    Parameters
    ----------
    name
        "HangingMass", "Joint", "Leg" or "Arm"; or "Scenario", which has no predefined plant.
    scenario
        The plant, where it is not the task's own. It must have the columns of the task's targets.
    targets
        Ranges in SI by columns. They replace those of the task, column by column.

    Raises
    ------
    InputError
        For another name, for "Scenario" without a scenario, and as `reach` does.
    """
    if name == "Scenario":
        if scenario is None:
            raise InputError("scenario is missing: give a mckibben.Scenario or the path of a scenario file")
        return reach(scenario, targets)
    if name not in NAMED:
        raise InputError(f"task: there is no `{name}`; name one of {', '.join(NAMED)}, Scenario, or give a Task")
    text, own = NAMED[name]
    return reach(scenario or Scenario(text, name), {**own, **(targets or {})})


def chosen(scenario: Scenario, columns: list[str]) -> Ranges:
    """Return the default ranges of targets of the coordinates of a plant."""
    plant, ranges = Plant(scenario), {}
    for column in columns:
        part, _, name = column.rpartition(".")
        if name not in VELOCITY or velocity_of(column) not in columns:
            continue
        reached = {"angle_rad": _between_stops, "length_m": _carrying, "position_m": _moving}[name](plant, part)
        if reached is not None:
            low, high = reached
            ranges[column] = (low + MARGIN * (high - low), high - MARGIN * (high - low))
    if not ranges:
        pressure = next((column for column in columns if column.endswith("absolute_pressure_pa")), columns[0])
        raise InputError(
            "targets: nothing in this plant moves freely, so that no targets can be chosen; give ranges in SI by columns, "
            f'such as targets={{"{pressure}": (2e5, 5e5)}}'
        )
    return ranges


def _between_stops(plant: Plant, joint: str) -> Range:
    """Return the range in rad between the stops of a joint."""
    paths = [f"{path}.joints.{joint}" for path, section in plant.mechanisms().items() if joint in section.get("joints", {})]
    path = paths[0] if joint else "load"
    low, high = plant.number(f"{path}.min_angle"), plant.number(f"{path}.max_angle")
    if low is None or high is None or not low < high:
        column = f"{joint}.angle_rad" if joint else "angle_rad"
        raise InputError(
            f"targets: no range can be chosen for `{column}`, whose joint lacks a stop; give `{path}.min_angle` and "
            f'`{path}.max_angle` in the scenario, or a range in rad, such as targets={{"{column}": (-0.5, 0.5)}}'
        )
    return low, high


def _carrying(plant: Plant, actuator: str) -> Range | None:
    """Return the range in m of the lengths at which an actuator can carry its own load at rest, or None without a load."""
    load = plant.section(actuator, "load")
    on_mechanism = plant.mechanisms() and not plant.at(f"actuators.{actuator}.load")
    if on_mechanism or load.get("kind") not in ("hanging-mass", "constant-force"):
        return None
    prefix = f"actuators.{actuator}." if actuator else ""

    def of_load(key: str) -> float:
        return plant.number(f"{prefix}load.{key}", f"load.{key}") or 0.0

    force = of_load("force") if load["kind"] == "constant-force" else of_load("mass") * of_load("gravity")
    alone: dict[str, Any] = {"actuator": plant.section(actuator, "actuator"), "run": {"duration": "1 s"}}
    alone["load"] = {"kind": "hanging-mass", "mass": "1 kg"}
    table = curves(Scenario.from_dict(alone), [0.0, plant.supply_pressure(actuator) or 0.0])
    # Forces rise with the length.
    long, short = (
        float(np.interp(force, np.maximum.accumulate(forces), lengths))
        for forces, lengths in zip(table["force_n"], table["length_m"], strict=True)
    )
    if not short < long:
        remedy = "raise the gauge pressure of the supply, reduce the load, or give a range in m"
        raise InputError(f"targets: no range can be chosen for the length of an actuator that cannot lift its load; {remedy}")
    return short, long


def _moving(plant: Plant, mechanism: str) -> Range | None:
    """Return the range in m of the lengths that all actuators on a mass can have, or None where the position is given."""
    sections = plant.mechanisms()
    if sections.get(mechanism, sections.get(f"mechanisms.{mechanism}", {})).get("kind") != "mass":
        return None
    on_it = [name for name in plant.actuators if plant.section(name, "coupling").get("mechanism", mechanism) == mechanism]
    low = max(plant.number(f"actuators.{name}.min_length", "actuator.min_length") or 0.0 for name in on_it)
    high = min(plant.number(f"actuators.{name}.max_length", "actuator.max_length") or 0.0 for name in on_it)
    return (low, high) if low < high else None


def _check(targets: Ranges, columns: list[str]) -> None:
    """Refuse targets that are no ranges of columns."""
    if not isinstance(targets, Mapping) or not targets:
        raise InputError(f"targets = {targets!r}: give ranges in SI by columns, one at least, of {', '.join(columns)}")
    remedy = "give two finite numbers in SI, the lower first"
    for column, given in targets.items():
        if column not in columns:
            raise InputError(f"targets: `{column}` is no column of this plant; name one of {', '.join(columns)}")
        try:
            low, high = (float(end) for end in given)
        except (TypeError, ValueError):
            raise InputError(f"targets: {column} = {given!r} is no range; {remedy}") from None
        if not -math.inf < low < high < math.inf:
            raise InputError(f"targets: {column} from {low} to {high} is no range; {remedy}")
        if low <= 0.0 and column.rpartition(".")[2].endswith(ABOVE_ZERO):
            raise InputError(f"targets: {column} from {low} to {high} has values that are not above zero; give a range in SI above zero")


def _check_threads(scenario: Scenario, targets: Ranges) -> None:
    """Refuse lengths of actuators that their threads cannot have. Those on a tendon have no such end."""
    lengths = [column for column in targets if column.rpartition(".")[2] == "length_m"]
    try:
        plant = Plant(scenario) if lengths else None
    except InputError:
        # What is wrong with the plant is said where its environment is made.
        return
    for column in lengths:
        actuator = column.rpartition(".")[0]
        if plant is None or plant.section(actuator, "tendon"):
            continue
        own = [f"actuators.{actuator}.thread_length"] if actuator else []
        thread, (low, high) = plant.number(*own, "actuator.thread_length"), targets[column]
        if thread is not None and high >= thread:
            raise InputError(
                f"targets: {column} from {low} to {high} is beyond the thread of the actuator, which is {thread:.6g} m long; give a "
                "range of shorter lengths in m"
            )


def _position(column: str, ends: Range) -> Seen:
    """Return the entry of a controlled column: from 0 to 1 over the range of its targets."""
    low, high = ends
    return Seen(column, low, high - low)


def velocity_of(column: str) -> str:
    """Return the column of the velocity of a controlled column."""
    part, dot, name = column.rpartition(".")
    return part + dot + VELOCITY.get(name, "")


def _velocity(column: str, ends: Range) -> Seen:
    """Return the entry of a velocity, in ranges of targets for each tenth of a second."""
    low, high = ends
    return Seen(column, 0.0, (high - low) / 0.1)


def _pressure(column: str) -> Seen:
    """Return the entry of a pressure: above 101325 Pa, in units of 500 kPa."""
    return Seen(column, 101325.0, 5e5, 0.0)
