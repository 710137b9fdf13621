"""What a controller is to reach, and how its section of the file is read.

An aim is a function (time, observations of the actuators, resolution) -> (columns, [(target, measured)] of each
actuator's regulator), where both are negated if more air makes less of the quantity.
"""


from .control import Controller, Modulator, Pid, Relay, SetPoint, quantise

QUANTITIES = {  # key of the file -> (unit, column)
    "gauge_pressure": ("Pa", "pa"),
    "length": ("m", "m"),
    "air_mass": ("kg", "kg"),
    "force": ("N", "n"),
    "angle": ("rad", "rad"),
}


def read_set_point(table, key, unit):
    values = table.list(key, unit)
    times = table.list("time", "s") if "time" in table else [0.0]
    if len(values) == 1:
        times = [0.0]
    lines = table.raw("table") == "lines" if "table" in table else False
    sinusoid = None
    if "amplitude" in table and not isinstance(table.content[key], list):
        sinusoid = (table.si("amplitude", unit), table.si("frequency", "Hz"), table.si("phase", "rad"))
    return SetPoint(times, values, lines, sinusoid)


def pull_area(braid, length):
    return (3 * length**2 - braid.thread_length**2) / braid.four_pi_n2


def read_controller(table, experiment, actuators, mechanism):
    kind = table.raw("kind")
    rate, delay = table.si("rate", "Hz"), table.raw("delay")
    can_hold = experiment.contents[0]["valve"]["kind"] != "three-way"
    muscle, air = actuators[0].muscle, actuators[0].air
    if kind in ("bang-bang", "pid"):
        regulated = next(key for key in QUANTITIES if key in table)
    else:
        regulated = {"feed-forward": "gauge_pressure", "air-mass": "air_mass"}[kind]
    unit, column = QUANTITIES[regulated]

    def measured_of(item):
        return {
            "gauge_pressure": lambda: item["pressure"] - air.atmosphere,
            "length": lambda: item["distance"],
            "air_mass": lambda: item["mass"],
            "force": lambda: item["tension"],
            "angle": lambda: float(item["state"][0]),
        }[regulated]()

    names = [f"set_point_{column}", f"measured_{column}"]
    if kind in ("bang-bang", "pid"):
        wanted = read_set_point(table, regulated, unit)

        def aim(time, seen, resolution):
            target = wanted.at(time)
            measured = quantise(measured_of(seen[0]), resolution)
            shown = {names[0]: target, names[1]: measured}
            if regulated == "length":
                return shown, [(-target, -measured)]
            if regulated == "angle":
                return shown, [(target, measured), (-target, -measured)]
            return shown, [(target, measured)]
    else:
        force, length = read_set_point(table, "force", "N"), read_set_point(table, "length", "m")
        highest = table.si("highest_gauge_pressure", "Pa")
        temperature = table.si("temperature", "K") if kind == "air-mass" else None
        names += ["set_point_n", "set_point_m"]

        def aim(time, seen, resolution):
            f, x = force.at(time), length.at(time)
            taut = muscle.limit.stiffness * max(0.0, x - muscle.braid.max_length)
            gauge = (f - taut) / pull_area(muscle.braid, x) / muscle.effectiveness.piece(0.0)(0.0)
            gauge = min(highest, max(0.0, gauge))
            target = gauge
            if kind == "air-mass":
                target = (gauge + air.atmosphere) * muscle.braid.volume(x) / (air.gas_constant * temperature)
            measured = quantise(measured_of(seen[0]), resolution)
            return {names[0]: target, names[1]: measured, "set_point_n": f, "set_point_m": x}, [(target, measured)]

    if "proportional_band" in table:
        numbers = [table.si("proportional_band", unit), table.si("integral_time", "s"), table.si("derivative_time", "s")]
        numbers += [table.raw("derivative_filter"), table.raw("set_point_weight"), table.si("tracking_time", "s")]
        bias = table.raw("bias")

        def regulator():
            return Pid(*numbers, bias, 1 / rate, can_hold)
    else:
        band, hysteresis = table.si("dead_band", unit), table.si("hysteresis", unit)

        def regulator():
            return Relay(band, hysteresis, can_hold)

    resolution = table.si("resolution", unit)
    frequency = table.si("pulse_frequency", "Hz") if "pulse_frequency" in table else rate
    count = len(actuators)
    regulators = [regulator() for _ in range(count)]
    modulators = [Modulator(frequency, can_hold) for _ in range(count)]
    controller = Controller(rate, delay, resolution, aim, regulators, modulators)
    controller.names = names
    table.finish()
    return controller
