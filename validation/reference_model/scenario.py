"""The scenario file as SI values. Every key must be there: the reference assumes no defaults."""

import math
import tomllib
from dataclasses import dataclass

from .physics import Air, Braid, Effectiveness, FlowLaw, Friction, Iso6358Flow, Limit, NozzleFlow
from .solenoid import Command
from .units import quantity, unit_factor


@dataclass(frozen=True)
class Load:
    """Section 7: ``mass dv/dt = pull − F``; isometric when the mass is infinite."""

    pull: float  # N, what lengthens the actuator: M g, or the constant force
    mass: float  # kg


@dataclass(frozen=True)
class Valve:
    """Sections 5 and 6. ``flow`` is the law of each seat."""

    kind: str
    flow: FlowLaw
    opening_delay: float  # s
    closing_delay: float  # s
    exhaust_is_ambient: bool


@dataclass(frozen=True)
class Scenario:
    """One experiment, in SI."""

    braid: Braid
    effectiveness: Effectiveness
    friction: Friction
    limit: Limit
    air: Air
    supply_pressure: float  # Pa, absolute
    supply_temperature: float  # K
    valve: Valve | None
    command: Command | None
    load: Load
    initial_pressure: float  # Pa, absolute
    initial_temperature: float  # K
    initial_length: float | None  # m; None: the friction-free static balance
    initial_velocity: float  # m/s
    duration: float  # s
    sample_interval: float  # s


class Table:
    """A table of the file whose keys must all be read."""

    def __init__(self, name, content):
        self.name, self.content, self.seen = name, content, set()

    def __contains__(self, key):
        return key in self.content

    def raw(self, key):
        self.seen.add(key)
        if key not in self.content:
            raise ValueError(f"[{self.name}] lacks {key}: the reference assumes no defaults")
        return self.content[key]

    def si(self, key, unit):
        return quantity(self.raw(key), unit)

    def table(self, key):
        return Table(f"{self.name}.{key}" if self.name else key, self.raw(key))

    def finish(self):
        unknown = set(self.content) - self.seen
        if unknown:
            raise ValueError(f"[{self.name}] has unknown keys {sorted(unknown)}")


def read_effectiveness(table):
    if "constant" in table:
        result = Effectiveness.constant(table.raw("constant"))
    elif "polynomial" in table:
        unit = unit_factor(table.raw("pressure_unit"))[0]
        result = Effectiveness.polynomial(table.raw("polynomial"), unit)
    else:
        pressures = [quantity(p, "Pa") for p in table.raw("gauge_pressure")]
        result = Effectiveness.table(pressures, table.raw("value"))
    table.finish()
    return result


def read_actuator(table):
    braid = Braid(
        thread_length=table.si("thread_length", "m"),
        turns=table.raw("turns"),
        max_length=table.si("max_length", "m"),
        min_length=table.si("min_length", "m"),
        external_volume=table.si("external_volume", "m^3"),
    )
    effectiveness = read_effectiveness(table.table("effectiveness"))
    rub = table.table("friction")
    friction = Friction(rub.si("viscous", "N*s/m"), rub.si("coulomb_width", "m"))
    rub.finish()
    end = table.table("limit")
    limit = Limit(end.si("stiffness", "N/m"), end.si("damping", "N*s/m"))
    end.finish()
    table.finish()
    return braid, effectiveness, friction, limit


def read_air(table):
    process = table.raw("process")
    gamma = table.raw("heat_capacity_ratio")
    balance = process == "energy-balance"
    index = {
        "isentropic": lambda: gamma,
        "isothermal": lambda: 1.0,
        "polytropic": lambda: table.raw("polytropic_index"),
        "energy-balance": lambda: math.nan,
    }[process]()
    air = Air(
        process=process,
        index=index,
        gas_constant=table.si("gas_constant", "J/(kg*K)"),
        gamma=gamma,
        atmosphere=table.si("atmospheric_pressure", "Pa"),
        heat_transfer=table.si("heat_transfer", "W/K") if balance else 0.0,
        wall_temperature=table.si("wall_temperature", "K") if balance else math.nan,
    )
    table.finish()
    return air


def read_valve(table, air):
    efficiency = table.raw("efficiency")
    laminar_ratio = table.raw("laminar_ratio")
    if "flow_area" in table:
        area = table.si("flow_area", "m^2")
        flow = NozzleFlow(efficiency * area, air.gamma, air.gas_constant, laminar_ratio)
    else:
        conductance = table.si("sonic_conductance", "m^3/(s*Pa)")
        flow = Iso6358Flow(efficiency * conductance, table.raw("critical_ratio"), laminar_ratio)
    valve = Valve(
        kind=table.raw("kind"),
        flow=flow,
        opening_delay=table.si("opening_delay", "s"),
        closing_delay=table.si("closing_delay", "s"),
        exhaust_is_ambient={"actuator": False, "ambient": True}[table.raw("exhaust_temperature")],
    )
    table.finish()
    return valve


def read_command(table):
    kind = table.raw("kind")
    if kind == "pwm":
        command = Command.pwm(table.si("frequency", "Hz"), table.raw("duty"))
    elif kind == "table":
        command = Command.table([quantity(t, "s") for t in table.raw("time")], table.raw("state"))
    else:
        command = Command.table([0.0], [kind])
    table.finish()
    return command


def read_load(table):
    kind = table.raw("kind")
    if kind == "hanging-mass":
        mass = table.si("mass", "kg")
        load = Load(mass * table.si("gravity", "m/s^2"), mass)
    elif kind == "constant-force":
        load = Load(table.si("force", "N"), table.si("mass", "kg"))
    elif kind == "isometric":
        load = Load(math.nan, math.inf)
    else:
        raise ValueError(f"the reference has no load {kind!r}")
    table.finish()
    return load


def load_scenario(path):
    """Read the file at ``path``."""
    with open(path, "rb") as file:
        root = Table("", tomllib.load(file))
    braid, effectiveness, friction, limit = read_actuator(root.table("actuator"))
    air = read_air(root.table("air"))
    supply, start, run = root.table("supply"), root.table("initial"), root.table("run")
    length = start.raw("length")
    run.raw("relative_tolerance")  # of the other integrator; ours is an argument
    scenario = Scenario(
        braid=braid,
        effectiveness=effectiveness,
        friction=friction,
        limit=limit,
        air=air,
        supply_pressure=air.atmosphere + supply.si("gauge_pressure", "Pa"),
        supply_temperature=supply.si("temperature", "K"),
        valve=read_valve(root.table("valve"), air) if "valve" in root else None,
        command=read_command(root.table("command")) if "command" in root else None,
        load=read_load(root.table("load")),
        initial_pressure=air.atmosphere + start.si("gauge_pressure", "Pa"),
        initial_temperature=start.si("temperature", "K"),
        initial_length=None if length == "equilibrium" else quantity(length, "m"),
        initial_velocity=start.si("velocity", "m/s"),
        duration=run.si("duration", "s"),
        sample_interval=run.si("sample_interval", "s"),
    )
    for table in (supply, start, run, root):
        table.finish()
    return scenario
