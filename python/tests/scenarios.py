"""Random scenarios, as dictionaries of what a file says: those that can be run, and those with something wrong."""

from __future__ import annotations

import typing

from hypothesis import strategies as st

Sections = dict[str, typing.Any]


def quantity(low: float, high: float, *units: str) -> st.SearchStrategy[str]:
    """A number between two ends in the first unit, in whose place any of the others may stand as they are written."""
    # Few digits, so that what fails is easy to read.
    number = st.integers(0, 1000).map(lambda share: low + (high - low) * share / 1000)
    return st.builds(lambda number, unit: f"{number:.6g} {unit}", number, st.sampled_from(units))


def number(low: float, high: float) -> st.SearchStrategy[float]:
    return st.integers(0, 1000).map(lambda share: low + (high - low) * share / 1000)


@st.composite
def hysteresis(draw: st.DrawFn) -> Sections:
    law = draw(st.sampled_from(["maxwell-slip", "bouc-wen", "lugre"]))
    if law == "maxwell-slip":
        count = draw(st.integers(1, 4))
        return {"law": law, "reach": [f"{0.05 * (index + 1)} mm" for index in range(count)],
                "stiffness_ratio": draw(st.lists(number(0.05, 0.5), min_size=count, max_size=count))}
    width = draw(quantity(0.02, 0.2, "mm"))
    if law == "bouc-wen":
        beta = draw(number(1000, 5000))
        return {"law": law, "width": width, "beta": f"{beta} m^-1", "gamma": f"{beta * draw(number(-0.9, 1))} m^-1"}
    return {"law": law, "width": width, "bristle_reach": draw(quantity(0.05, 0.3, "mm")),
            "static_ratio": draw(number(1, 1.6)), "stribeck_velocity": "10 mm/s", "damping_time": "5 ms"}


@st.composite
def actuators(draw: st.DrawFn) -> Sections:
    thread = draw(number(95, 130))
    actuator: Sections = {
        "thread_length": f"{thread} mm",
        "turns": draw(number(1, 4)),
        "max_length": f"{thread * draw(number(0.8, 0.95))} mm",
        "external_volume": draw(quantity(0.5, 6, "mL", "cm^3")),
        "friction": {"viscous": draw(quantity(0, 30, "N*s/m"))},
    }
    friction = draw(st.sampled_from(["not", "width", "force", "hysteresis"]))
    if friction == "width":
        actuator["friction"]["coulomb_width"] = draw(quantity(0, 0.3, "mm"))
    elif friction == "force":
        actuator["friction"]["coulomb_force"] = draw(quantity(0, 3, "N"))
        actuator["friction"]["static_ratio"] = draw(number(1, 1.5))
    elif friction == "hysteresis":
        actuator["friction"]["hysteresis"] = draw(hysteresis())
    if draw(st.booleans()):
        actuator["leakage"] = draw(quantity(0, 1e-12, "m^3/(s*Pa)"))
    if draw(st.booleans()):
        actuator["effectiveness"] = {"constant": draw(number(0.6, 1))}
    return actuator


VALVES = ["two-way", "three-way", "three-way-normally-open", "fill-hold-exhaust", "proportional-spool", "pressure-regulator"]


@st.composite
def drives(draw: st.DrawFn, kind: str) -> tuple[Sections, Sections]:
    """A valve of a kind with its command."""
    valve: Sections = {"kind": kind, "flow_area": draw(quantity(0.5, 4, "mm^2")), "efficiency": draw(number(0.5, 1))}
    times = ["0 s", "8 ms", "21 ms"]
    if kind == "proportional-spool":
        valve["spool"] = {"natural_frequency": draw(quantity(40, 150, "Hz")), "damping_ratio": draw(number(0.3, 1.5)),
                          "supply_overlap": draw(number(-0.1, 0.1)), "exhaust_overlap": draw(number(-0.1, 0.1))}
        position = draw(st.lists(number(-1, 1), min_size=3, max_size=3))
        return valve, {"kind": "positions", "time": times, "position": position}
    if kind == "pressure-regulator":
        valve |= {"time_constant": draw(quantity(5, 50, "ms")), "dead_time": draw(quantity(0, 9, "ms")),
                  "rate_limit": draw(quantity(20, 100, "bar/s"))}
        wanted = draw(st.lists(quantity(0, 5, "bar"), min_size=3, max_size=3))
        return valve, {"kind": "set-points", "time": times, "gauge_pressure": wanted}
    valve |= {"opening_delay": draw(quantity(0, 5, "ms")), "closing_delay": draw(quantity(0, 3, "ms"))}
    if draw(st.booleans()):
        valve |= {"opening_time": draw(quantity(0, 4, "ms")), "closing_time": draw(quantity(0, 4, "ms"))}
    requests = {"two-way": ["fill", "hold"], "fill-hold-exhaust": ["fill", "hold", "exhaust"]}
    requested = st.sampled_from(requests.get(kind, ["fill", "exhaust"]))
    command = draw(st.sampled_from(["pwm", "steady", "table"]))
    if command == "steady":
        return valve, {"kind": draw(requested)}
    if command == "table":
        return valve, {"kind": "table", "time": times, "state": draw(st.lists(requested, min_size=3, max_size=3))}
    pulses: Sections = {"kind": "pwm", "frequency": draw(quantity(15, 120, "Hz")), "duty": draw(number(0, 1))}
    if kind == "fill-hold-exhaust":
        pulses |= {"pulse": draw(requested), "rest": draw(requested)}
    return valve, pulses


@st.composite
def lines(draw: st.DrawFn) -> Sections:
    """Supply and hose."""
    sections: Sections = {"supply": {"gauge_pressure": draw(quantity(3, 7, "bar"))}}
    if draw(st.booleans()):
        sections["supply"] |= {"reservoir_volume": draw(quantity(0.1, 3, "L"))}
    if draw(st.booleans()):
        sections["supply"] |= {"lag": draw(quantity(5, 30, "ms")), "droop": draw(quantity(0, 2e7, "Pa*s/kg"))}
    kind = draw(st.sampled_from(["none", "lumped", "distributed"]))
    if kind != "none":
        sections["hose"] = {"kind": kind, "length": draw(quantity(0.2, 2, "m")), "diameter": draw(quantity(2, 5, "mm"))}
    if kind == "distributed":
        sections["hose"]["cells"] = draw(st.integers(1, 3))
    return sections


@st.composite
def loads(draw: st.DrawFn) -> Sections:
    kind = draw(st.sampled_from(["hanging-mass", "constant-force", "isometric", "prescribed-motion", "table"]))
    if kind == "hanging-mass":
        return {"kind": kind, "mass": draw(quantity(0.5, 4, "kg", "lb"))}
    if kind == "constant-force":
        return {"kind": kind, "mass": draw(quantity(0.5, 4, "kg")), "force": draw(quantity(0, 40, "N", "N"))}
    if kind == "prescribed-motion":
        return {"kind": kind, "length": "80 mm", "amplitude": draw(quantity(0, 4, "mm")),
                "frequency": draw(quantity(0.5, 20, "Hz")), "phase": draw(quantity(0, 360, "deg"))}
    if kind == "table":
        length = draw(st.lists(quantity(76, 84, "mm"), min_size=3, max_size=3))
        return {"kind": "prescribed-motion", "time": ["0 s", "11 ms", "40 ms"], "table_length": length}
    return {"kind": kind}


@st.composite
def runs(draw: st.DrawFn) -> Sections:
    """How long is simulated, and by which engine. No sample but the last lies on an event that is known beforehand."""
    run: Sections = {"duration": draw(quantity(20, 45, "ms")), "sample_interval": draw(quantity(0.3, 3, "ms"))}
    if draw(st.booleans()):
        run |= {"engine": "fixed-step", "step": draw(quantity(0.1, 1, "ms"))}
        run["method"] = draw(st.sampled_from(["stable", "rk4"]))
    return run


@st.composite
def singles(draw: st.DrawFn, valve: str | None) -> Sections:
    """An actuator on a load, with a valve of a kind or sealed."""
    sections: Sections = {"actuator": draw(actuators()), "load": draw(loads())}
    if valve is not None:
        sections["valve"], sections["command"] = draw(drives(valve))
        # What feeds a pressure regulator is taken as constant, and above what it gives.
        sections |= draw(lines()) if valve != "pressure-regulator" else {"supply": {"gauge_pressure": "7 bar"}}
    if draw(st.booleans()):
        sections["air"] = draw(st.sampled_from([
            {"process": "isothermal"}, {"process": "polytropic", "polytropic_index": 1.2},
            {"process": "energy-balance", "heat_transfer": "0.1 W/K"},
        ]))
    if sections["load"]["kind"] in ("hanging-mass", "constant-force") and not draw(st.integers(0, 3)):
        sections["tendon"] = {"stiffness": draw(quantity(5, 50, "kN/m"))}
    sections["initial"] = {"gauge_pressure": draw(quantity(0.5, 4, "bar", "bar"))}
    if sections["load"]["kind"] != "prescribed-motion":
        somewhere = quantity(76, 90, "mm")
        held = sections["load"]["kind"] == "isometric"
        sections["initial"]["length"] = draw(somewhere if held else st.one_of(somewhere, st.just("equilibrium")))
    sections["run"] = draw(runs())
    return sections


@st.composite
def joints(draw: st.DrawFn) -> Sections:
    """Two actuators that turn a joint."""
    requested = st.lists(st.sampled_from(["fill", "hold", "exhaust"]), min_size=3, max_size=3)
    times = ["0 s", "8 ms", "21 ms"]
    return {
        "actuator": {"preset": "colbrunn-2001", "friction": {"viscous": draw(quantity(0, 30, "N*s/m"))}},
        "supply": {"gauge_pressure": draw(quantity(3, 6, "bar"))},
        "valve": {"preset": "matrix-eight-channel", "kind": "fill-hold-exhaust"},
        "command": {"kind": "table", "time": times, "state": draw(requested)},
        "load": {
            "kind": "antagonistic-joint", "pulley_radius": draw(quantity(10, 18, "mm")), "rest_length": "3.3 in",
            "mass": draw(quantity(0.1, 1, "kg")), "distance": draw(quantity(0, 100, "mm")), "inertia": "1e-3 kg*m^2",
            "damping": draw(quantity(0, 0.05, "N*m*s/rad")), "min_angle": "-30 deg", "max_angle": draw(quantity(5, 30, "deg")),
        },
        "initial": {"gauge_pressure": draw(quantity(1, 2, "bar"))},
        "antagonist": {"initial": {"temperature": "293.15 K"}, "command": {"kind": "table", "time": times, "state": draw(requested)}},
        "run": draw(runs()),
    }


@st.composite
def controlled(draw: st.DrawFn) -> Sections:
    """An actuator whose controller commands the valve."""
    controller: Sections = {"kind": draw(st.sampled_from(["bang-bang", "pid"])), "rate": draw(quantity(60, 300, "Hz")),
                            "delay": draw(st.integers(0, 3))}
    regulated, band = draw(st.sampled_from([("length", "mm"), ("gauge_pressure", "bar")]))
    controller[regulated] = draw(quantity(78, 88, "mm") if regulated == "length" else quantity(1, 4, "bar"))
    if controller["kind"] == "pid":
        controller |= {"pulse_frequency": draw(quantity(20, 60, "Hz")), "proportional_band": draw(quantity(1, 9, band)),
                       "integral_time": draw(quantity(0.05, 1, "s")), "derivative_time": draw(quantity(0, 10, "ms"))}
    else:
        controller["dead_band"] = draw(quantity(0.01, 0.5, band))
    return {
        "actuator": draw(actuators()),
        "valve": {"kind": "fill-hold-exhaust", "flow_area": draw(quantity(0.5, 3, "mm^2")), "opening_delay": "1 ms"},
        "supply": {"gauge_pressure": "6 bar"},
        "command": {"kind": "controllers"},
        "controller": controller,
        "load": {"kind": "hanging-mass", "mass": draw(quantity(0.5, 4, "kg"))},
        "initial": {"gauge_pressure": draw(quantity(0.5, 4, "bar")), "length": draw(quantity(76, 90, "mm"))},
        "run": draw(runs()),
    }


#: Scenarios that are meant to run, of each kind; a few contradict themselves, and say so.
KINDS = {"sealed": singles(None), "joint": joints(), "controlled": controlled()} | {kind: singles(kind) for kind in VALVES}


def paths(sections: Sections, above: str = "") -> list[str]:
    """The paths of all keys that hold a value."""
    found = []
    for key, value in sections.items():
        found += paths(value, f"{above}{key}.") if isinstance(value, dict) else [f"{above}{key}"]
    return found


#: What stands where something else should.
STRANGE: list[typing.Any] = [
    -1, 0, 1, 1e300, -1e300, 5e-324, 2**70, float("nan"), float("inf"), True, "", " ", "nan bar", "inf m", "1e999 m", "1e-999 kg",
    "-1 mm", "0 mm", "0 kg", "0 Pa", "-3 bar", "1e12 bar", "1e30 mm", "1e-30 mm", "5 furlongs", "mm 5", "5", "5 mm mm", "m/0",
    "5 m^99999999999", "5 ((((((((m", "µ", "5 µm", "−5 mm", "\x00", "\n", '"', "'''", "𝓂 5", "equilibrium", "three-way", [], [[]],
    [1, "mm"], ["5 mm"], ["0 s", "0 s"], ["1 s", "0 s", "2 s"], {}, {"kind": "none"}, 2**63,
]


@st.composite
def mistaken(draw: st.DrawFn) -> Sections:
    """A scenario in which a few keys say what they should not, are not there, or are unknown."""
    sections = draw(st.one_of(*KINDS.values()))
    for _ in range(draw(st.integers(1, 3))):
        *above, key = draw(st.sampled_from(paths(sections))).split(".")
        at = sections
        for section in above:
            at = at[section]
        what = draw(st.integers(0, 9))
        if what == 0:
            del at[key]
        elif what == 1:
            at[draw(st.sampled_from(["mas", "kind", "preset", "length", "gauge_pressure", "", "a.b", "𝓂"]))] = at[key]
        else:
            at[key] = draw(st.one_of(st.sampled_from(STRANGE), st.text(max_size=6), st.floats(), st.integers()))
        if not paths(sections):
            break
    return sections
