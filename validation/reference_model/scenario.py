"""The scenario file as a plant, its command and the columns of its run.

Every key of a part that is there must be there: the reference assumes no defaults. A part that is absent from the
file (hose, leak, reservoir, regulator, tendon, ...) is absent from the plant.
"""

import copy
import math
import tomllib

import numpy as np

from . import control
from .actuator import BoucWen, Dry, LuGre, MaxwellSlip, Muscle, Viscoelastic
from .lines import Hose, LineRegulator, Reservoir
from .mechanism import ArmTable, Held, Joint, Mass, Pulley
from .physics import Air, Braid, Effectiveness, Iec60534Flow, Iso6358Flow, Limit, NozzleFlow
from .plant import Actuator, Plant, Supply, equilibrium
from .solenoid import Command
from .units import quantity, unit_factor
from .valves import RegulatorValve, SeatValve, Spool

# Cv = 1: one US gallon of 231 in³ of water a minute at 1 psi; as a flow at 1 bar, m³/s
CV = 231 * 0.0254**3 / 60 * math.sqrt(1e5 / unit_factor("psi")[0])


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

    def get(self, key, default):
        """A number that may be left out: only where the part that it belongs to may be left out."""
        return self.raw(key) if key in self.content else default

    def si(self, key, unit, default=None):
        if default is not None and key not in self.content:
            return default
        return quantity(self.raw(key), unit)

    def list(self, key, unit):
        values = self.raw(key)
        return [quantity(v, unit) for v in (values if isinstance(values, list) else [values])]

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


def read_hysteresis(table):
    law = table.raw("law")
    if law == "maxwell-slip":
        result = MaxwellSlip(table.list("reach", "m"), table.raw("stiffness_ratio"))
    elif law == "bouc-wen":
        numbers = table.si("width", "m"), table.si("beta", "m^-1"), table.si("gamma", "m^-1")
        result = BoucWen(*numbers)
    elif law == "lugre":
        result = LuGre(
            table.si("width", "m"),
            table.si("bristle_reach", "m"),
            table.raw("static_ratio"),
            table.si("stribeck_velocity", "m/s"),
            table.si("damping_time", "s"),
        )
    else:
        raise ValueError(f"the reference has no law {law!r}")
    table.finish()
    return result


def read_viscoelastic(table):
    times = table.list("relaxation_time", "s")
    none = [0.0] * len(times)
    if "stiffness" not in table and "stiffness_ratio" not in table:
        raise ValueError(f"[{table.name}] lacks stiffness and stiffness_ratio")
    stiffness = table.list("stiffness", "N/m") if "stiffness" in table else none
    ratio = table.get("stiffness_ratio", none)
    if not len(times) == len(stiffness) == len(ratio):
        raise ValueError(f"[{table.name}] has lists of different lengths")
    table.finish()
    return Viscoelastic(tuple(times), tuple(stiffness), tuple(ratio))


def read_actuator(table):
    """(muscle, leak)."""
    braid = Braid(
        thread_length=table.si("thread_length", "m"),
        turns=table.raw("turns"),
        max_length=table.si("max_length", "m"),
        min_length=table.si("min_length", "m"),
        external_volume=table.si("external_volume", "m^3"),
    )
    effectiveness = read_effectiveness(table.table("effectiveness"))
    friction = table.table("friction")
    viscous = friction.si("viscous", "N*s/m")
    structural = friction.si("structural_damping", "s", 0.0)
    dry = Dry(
        friction.si("coulomb_width", "m"),
        friction.si("coulomb_force", "N", 0.0),
        friction.si("coulomb_force_per_pressure", "m^2", 0.0),
        friction.get("static_ratio", 1.0),
        friction.si("stribeck_velocity", "m/s", 0.01),
    )
    hysteresis = read_hysteresis(friction.table("hysteresis")) if "hysteresis" in friction else None
    viscoelastic = read_viscoelastic(friction.table("viscoelastic")) if "viscoelastic" in friction else Viscoelastic()
    friction.finish()
    end = table.table("limit")
    limit = Limit(end.si("stiffness", "N/m"), end.si("damping", "N*s/m"))
    end.finish()
    leak = table.si("leakage", "m^3/(s*Pa)", 0.0)
    table.finish()
    return Muscle(braid, effectiveness, viscous, dry, hysteresis, limit, structural, viscoelastic), leak


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


def read_supply(table, air):
    pressure = air.atmosphere + table.si("gauge_pressure", "Pa")
    reservoir = regulator = None
    if "reservoir_volume" in table:
        has_compressor = "compressor_displacement" in table
        reservoir = Reservoir(
            volume=table.si("reservoir_volume", "m^3"),
            index=table.raw("reservoir_index"),
            pressure=air.atmosphere + table.si("reservoir_gauge_pressure", "Pa"),
            displacement=table.si("compressor_displacement", "m^3/s", 0.0),
            clearance=table.raw("compressor_clearance") if has_compressor else 0.0,
            cut_in=air.atmosphere + table.si("cut_in_gauge_pressure", "Pa") if has_compressor else 0.0,
            cut_out=air.atmosphere + table.si("cut_out_gauge_pressure", "Pa") if has_compressor else 0.0,
        )
    if "lag" in table:
        droop, band = table.si("droop", "Pa*s/kg"), table.si("dead_band", "Pa")
        regulator = LineRegulator(pressure, table.si("lag", "s"), droop, band)
    supply = Supply(pressure, table.si("temperature", "K"), reservoir, regulator, table.get("actuators", 1))
    table.finish()
    return supply


def read_law(table, air, efficiency, laminar_ratio):
    """The flow law of a flow path, or None if none is stated here."""
    if "flow_area" in table:
        area = table.si("flow_area", "m^2")
        return NozzleFlow(efficiency * area, air.gamma, air.gas_constant, laminar_ratio)
    if "sonic_conductance" in table:
        conductance = table.si("sonic_conductance", "m^3/(s*Pa)")
        return Iso6358Flow(efficiency * conductance, table.raw("critical_ratio"), laminar_ratio)
    for key, coefficient in (("kv", lambda: table.si("kv", "m^3/s")), ("cv", lambda: CV * table.raw("cv"))):
        if key in table:
            ratio = table.raw("pressure_drop_ratio")
            return Iec60534Flow(efficiency * coefficient(), ratio, air.gamma, air.gas_constant, laminar_ratio)
    return None


def read_valve(table, air, late):
    """(valve, supply law, exhaust law, whether the exhaust's temperature is the atmosphere's)."""
    efficiency, laminar_ratio = table.raw("efficiency"), table.raw("laminar_ratio")
    law = read_law(table, air, efficiency, laminar_ratio)
    exhaust_law = law
    if "exhaust" in table:
        exhaust = table.table("exhaust")
        exhaust_law = read_law(exhaust, air, efficiency, laminar_ratio)
        exhaust.finish()
    kind = table.raw("kind")
    if kind == "proportional-spool":
        spool = table.table("spool")
        valve = Spool(
            spool.si("natural_frequency", "Hz"),
            spool.raw("damping_ratio"),
            spool.raw("supply_overlap"),
            spool.raw("exhaust_overlap"),
            late,
        )
        spool.finish()
    elif kind == "pressure-regulator":
        times = table.si("time_constant", "s"), table.si("dead_time", "s")
        valve = RegulatorValve(*times, table.si("rate_limit", "Pa/s"), late)
    else:
        valve = SeatValve(
            kind,
            table.si("opening_delay", "s"),
            table.si("closing_delay", "s"),
            table.si("opening_time", "s", 0.0),
            table.si("closing_time", "s", 0.0),
            late,
        )
    ambient = {"actuator": False, "ambient": True}[table.raw("exhaust_temperature")]
    table.finish()
    return valve, law, exhaust_law, ambient


def read_hose(table, air, supply):
    cells = {"lumped": lambda: 0, "distributed": lambda: table.raw("cells")}[table.raw("kind")]()
    hose = Hose(
        length=table.si("length", "m"),
        diameter=table.si("diameter", "m"),
        viscosity=table.si("viscosity", "Pa*s"),
        index=table.raw("polytropic_index"),
        cells=cells,
        gas_constant=air.gas_constant,
        gamma=air.gamma,
        temperature=supply.temperature,
    )
    table.finish()
    return hose


def read_command(table, air, duration, kind_of_valve):
    """[(instant, request)] up to the end, or None for a controller."""
    kind = table.raw("kind")
    if kind == "pwm":
        steps = Command.pwm(table.si("frequency", "Hz"), table.raw("duty")).until(duration)
        if kind_of_valve == "two-way":
            steps = [(t, "fill" if request == "fill" else "hold") for t, request in steps]
    elif kind == "table":
        steps = list(zip(table.list("time", "s"), table.raw("state"), strict=True))
    elif kind == "set-points":
        pressures = [air.atmosphere + p for p in table.list("gauge_pressure", "Pa")]
        steps = list(zip(table.list("time", "s"), pressures, strict=True))
    elif kind == "positions":
        steps = list(zip(table.list("time", "s"), table.raw("position"), strict=True))
    elif kind == "controllers":
        steps = None
    else:
        steps = [(0.0, kind)]
    table.finish()
    return steps


class Lines:
    """Straight lines between (t, x); constant after the last."""

    def __init__(self, times, values):
        self.times, self.values = times, values
        self.piece = 0

    def pass_knot(self, time):
        self.piece = max(0, sum(t <= time + 1e-12 for t in self.times) - 1)

    def __call__(self, time):
        if self.piece + 1 >= len(self.times):
            return self.values[-1], 0.0
        t0, t1 = self.times[self.piece : self.piece + 2]
        x0, x1 = self.values[self.piece : self.piece + 2]
        slope = (x1 - x0) / (t1 - t0)
        return x0 + slope * (time - t0), slope


class Sinusoid:
    times = ()

    def __init__(self, mean, amplitude, frequency, phase):
        self.mean, self.amplitude, self.omega, self.phase = mean, amplitude, 2 * math.pi * frequency, phase

    def pass_knot(self, time):
        pass

    def __call__(self, time):
        angle = self.omega * time + self.phase
        return self.mean + self.amplitude * math.sin(angle), self.amplitude * self.omega * math.cos(angle)


def merged(first, second):
    """The table `first` with what `second` says in its place, section by section."""
    result = copy.deepcopy(first)
    for key, value in second.items():
        if isinstance(value, dict) and isinstance(result.get(key), dict) and key not in ("command",):
            result[key] = merged(result[key], value)
        else:
            result[key] = copy.deepcopy(value)
    return result


def read_arm(content):
    if "pulley_radius" in content:
        return Pulley(quantity(content["pulley_radius"], "m"))
    angles = [quantity(a, "rad") for a in content["moment_arm_angle"]]
    return ArmTable(angles, [quantity(r, "m") for r in content["moment_arm"]])


NAMES = ("length_m", "velocity_m_s", "absolute_pressure_pa", "gauge_pressure_pa", "air_mass_kg", "temperature_k")
NAMES += ("volume_m3", "tension_n", "mass_flow_kg_s", "valve")


class Experiment:
    """One scenario file."""

    controller = None

    def __init__(self, content):
        self.content = content
        root = Table("", content)
        run = root.table("run")
        self.duration, self.sample_interval = run.si("duration", "s"), run.si("sample_interval", "s")
        run.raw("relative_tolerance")  # of the other integrator; ours is an argument
        run.finish()
        self.knots, self.moving = [], []
        self.is_joint = content["load"]["kind"] == "antagonistic-joint"
        sections = ["actuator", "air", "supply", "valve", "hose", "command", "load", "initial", "pressure", "tendon"]
        first = {key: content[key] for key in sections if key in content}
        for key in (*first, "antagonist", "controller"):
            if key in content:
                root.seen.add(key)
        root.finish()
        self.contents = [first]
        if self.is_joint:
            other = copy.deepcopy(first)
            if first.get("valve", {}).get("kind", "").startswith("five-way"):
                other["valve"]["kind"] += " B"
            said = content.get("antagonist", {})
            if "pulley_radius" in said.get("load", {}) or "moment_arm" in said.get("load", {}):
                for key in ("pulley_radius", "moment_arm_angle", "moment_arm"):
                    other["load"].pop(key, None)
            self.contents.append(merged(other, said))

    def plant(self, rtol):
        self.knots, self.moving, self.all_commands = [], [], []
        shared = {}
        actuators = [self.read_one(content, shared) for content in self.contents]
        load = Table("load", self.contents[0]["load"])
        initial = Table("initial", self.contents[0]["initial"])
        kind = load.raw("kind")
        start = ((), ())
        if kind == "antagonistic-joint":
            arms = [read_arm(content["load"]) for content in self.contents]
            rest = [quantity(content["load"]["rest_length"], "m") for content in self.contents]
            bounds = [load.si(k, "rad") if k in load else None for k in ("min_angle", "max_angle")]
            stops = (*bounds, load.si("stop_stiffness", "N*m/rad"), load.si("stop_damping", "N*m*s/rad"))
            mechanism = Joint(
                arms,
                rest,
                load.si("mass", "kg"),
                load.si("gravity", "m/s^2"),
                load.si("distance", "m"),
                load.si("inertia", "kg*m^2"),
                load.si("hanging_angle", "rad"),
                load.si("torque", "N*m"),
                load.si("damping", "N*m*s/rad"),
                stops,
            )
            start = ((initial.si("angle", "rad"),), (initial.si("angular_velocity", "rad/s"),))
        elif kind in ("hanging-mass", "constant-force"):
            mass = load.si("mass", "kg")
            pull = mass * load.si("gravity", "m/s^2") if kind == "hanging-mass" else load.si("force", "N")
            mechanism = Mass(mass, pull)
            actuator = actuators[0]
            length = initial.raw("length")
            if length == "equilibrium":
                gauge = actuator.pressure - actuator.air.atmosphere
                length = equilibrium(actuator.muscle, gauge, pull)
            else:
                length = quantity(length, "m")
            position = length
            if actuator.tendon:
                stiffness, rest = actuator.tendon
                actuator.length = length
                position = length + rest + pull / stiffness
            start = ((position,), (initial.si("velocity", "m/s"),))
        elif kind == "isometric":
            length = initial.si("length", "m")
            mechanism = Held(lambda time: (length, 0.0))
        elif kind == "prescribed-motion":
            if "time" in load:
                motion = Lines(load.list("time", "s"), load.list("table_length", "m"))
            else:
                numbers = load.si("length", "m"), load.si("amplitude", "m"), load.si("frequency", "Hz")
                motion = Sinusoid(*numbers, load.si("phase", "rad"))
            self.moving.append(motion)
            mechanism = Held(motion)
        else:
            raise ValueError(f"the reference has no load {kind!r}")
        for moving in self.moving:
            self.knots += moving.times
        self.knots = sorted(set(self.knots))
        self.pass_knot(0.0)
        if "controller" in self.content:
            from .aims import read_controller

            self.controller = read_controller(Table("controller", self.content["controller"]), self, actuators, mechanism)
        self.header = self.columns(actuators)
        return Plant(actuators, mechanism, start, rtol)

    def pass_knot(self, time):
        for moving in self.moving:
            moving.pass_knot(time)

    def read_one(self, content, shared):
        """One actuator with everything on its side of the mechanism."""
        root = Table("", content)
        muscle, leak = read_actuator(root.table("actuator"))
        air = read_air(root.table("air"))
        supply = read_supply(root.table("supply"), air) if "supply" in content else Supply(air.atmosphere, 293.15)
        initial = root.table("initial")
        hose = read_hose(root.table("hose"), air, supply) if "hose" in content else None
        valve, law, exhaust_law, ambient = None, None, None, False
        if "valve" in content:
            valve, law, exhaust_law, ambient = read_valve(root.table("valve"), air, hose.delay if hose else 0.0)
        self.all_commands.append(None)
        if "command" in content:
            kind = content["valve"]["kind"]
            self.all_commands[-1] = read_command(root.table("command"), air, self.duration, kind)
        given = None
        if "pressure" in content:
            table = root.table("pressure")
            pressures = [air.atmosphere + p for p in table.list("gauge_pressure", "Pa")]
            given = Lines(table.list("time", "s"), pressures)
            self.moving.append(given)
            table.finish()
        tendon = None
        if "tendon" in content:
            table = root.table("tendon")
            tendon = (table.si("stiffness", "N/m"), table.si("rest_length", "m"))
            table.finish()
        return Actuator(
            muscle=muscle,
            air=air,
            supply=supply,
            pressure=given.values[0] if given else air.atmosphere + initial.si("gauge_pressure", "Pa"),
            temperature=initial.si("temperature", "K"),
            valve=valve,
            supply_law=law,
            exhaust_law=exhaust_law,
            exhaust_is_ambient=ambient,
            hose=hose,
            leak=leak,
            tendon=tendon,
            given=given,
        )

    def commands(self):
        return [list(steps) if steps else [] for steps in self.all_commands]

    # --- the columns --------------------------------------------------------------------------

    def columns(self, actuators):
        first = actuators[0]
        header = ["time_s", *NAMES]
        if self.is_joint:
            header += ["angle_rad", "angular_velocity_rad_s", "torque_n_m"]
            header += [f"antagonist_{name}" for name in NAMES]
        if first.tendon:
            header += ["load_distance_m", "load_velocity_m_s"]
        if first.hose:
            header += ["hose_absolute_pressure_pa", "hose_gauge_pressure_pa"]
        if first.supply.reservoir or first.supply.regulator:
            header += ["supply_absolute_pressure_pa", "supply_gauge_pressure_pa"]
        if isinstance(first.valve, RegulatorValve):
            header += ["regulated_absolute_pressure_pa", "regulated_gauge_pressure_pa", "set_point_pa"]
        if self.controller:
            header += list(self.controller.names)
        return header

    @staticmethod
    def ports(actuator, mode, k):
        valve = actuator.valve
        if valve is None:
            return "closed"
        if isinstance(valve, RegulatorValve):
            return "supply"
        if isinstance(valve, Spool):
            opened = tuple(mode.branches.sides["spool edge", k, side] for side in (1, -1))
        else:
            opened = valve.open_ports()
        return "+".join(n for n, o in zip(("supply", "exhaust"), opened, strict=True) if o) or "closed"

    def row(self, time, plant, seen, state, mode):
        def cells(k):
            item, actuator = seen[k], plant.actuators[k]
            length = item["length"] if actuator.tendon else item["distance"]
            velocity = item["velocity"] if actuator.tendon else item["speed"]
            pressure = [item["pressure"], item["pressure"] - actuator.air.atmosphere]
            numbers = [length, velocity, *pressure, item["mass"], item["temperature"], item["volume"]]
            return [*numbers, item["tension"], item["flow"], self.ports(actuator, mode, k)]

        first = plant.actuators[0]
        row = [time, *cells(0)]
        if self.is_joint:
            arms = plant.mechanism.arms(state[:1].tolist())
            torque = -sum(arm[0] * item["tension"] for arm, item in zip(arms, seen, strict=True))
            row += [float(state[0]), float(state[1]), torque, *cells(1)]
        if first.tendon:
            row += [float(state[0]), float(state[1])]
        if first.hose:
            row += [seen[0]["hose_pressure"], seen[0]["hose_pressure"] - first.air.atmosphere]
        if first.supply.reservoir or first.supply.regulator:
            outlet = float(first.supply.outlet(state))
            row += [outlet, outlet - first.air.atmosphere]
        if isinstance(first.valve, RegulatorValve):
            asked = first.valve.asked
            start = first.pressure if asked is None else asked
            regulated = float(state[first.i_valve[0]])
            row += [regulated, regulated - first.air.atmosphere, start - first.air.atmosphere]
        if self.controller:
            row += [self.controller.shown[name] for name in self.controller.names]
        return row


def load_scenario(path):
    """Read the file at ``path``."""
    with open(path, "rb") as file:
        return Experiment(tomllib.load(file))
