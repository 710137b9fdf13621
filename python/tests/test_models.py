"""Static curves, linear models, identification and presets are those of the command line."""

from __future__ import annotations

import csv
import json
import re
import warnings

import control
import numpy
import pytest

import mckibben
from mckibben._linear import identifiers

pytestmark = pytest.mark.blas


def test_curves_are_those_of_the_command_line(program, examples, tmp_path):
    path = examples / "laws/bladder.toml"
    program(tmp_path, "curves", str(path), "--gauge-pressures", "1.5,3,4.5bar", "--output", "curves.csv")
    with open(tmp_path / "curves.csv", newline="") as file:
        header, *rows = csv.reader(file)
    curves = mckibben.curves(mckibben.Scenario.from_file(path), "1.5, 3, 4.5 bar")
    assert list(curves) == header
    for name, written in zip(header, zip(*rows)):
        assert curves[name].shape[0] == 3
        finite = numpy.array([float(number) if number else numpy.nan for number in written])
        own = numpy.where(numpy.isfinite(curves[name]), curves[name], numpy.nan).ravel()
        numpy.testing.assert_array_equal(own, finite)
    numpy.testing.assert_array_equal(curves["gauge_pressure_pa"][:, 0], [1.5e5, 3e5, 4.5e5])
    assert (numpy.diff(curves["length_m"]) > 0.0).all()


@pytest.mark.parametrize(
    "example, options",
    [
        ("paper/fig-12", {"gauge_pressure": "60 psi"}),
        ("paper/fig-12", {"duty": 0.5, "all_states": True}),
        ("paper/fig-12", {"gauge_pressure": "50 psi", "pwm": True}),
        ("paper/fig-12", {"length": "85 mm", "load": "10 lb", "temperature": "20 degC"}),
        ("tendon", {"amplitude": "1 mm"}),
        ("antagonistic-joint", {"angle": "5 deg", "stiffness": "2 N*m/rad"}),
    ],
)
def test_a_linear_model_is_that_of_the_command_line(example, options, program, examples, tmp_path):
    path = examples / f"{example}.toml"
    words = [
        f"--{name.replace('_', '-')}" + ("" if value is True else f"={value}") for name, value in options.items()
    ]
    program(tmp_path, "linearize", str(path), *words, "--output", "model.json")
    written = (tmp_path / "model.json").read_text()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        model = mckibben.linearize(mckibben.Scenario.from_file(path), **options)
    assert model.to_json() == written
    read = json.loads(written)
    for name in "ABCD":
        numpy.testing.assert_array_equal(getattr(model, name), numpy.array(read[name]))
        assert not getattr(model, name).flags.writeable
    for kind in ["states", "inputs", "outputs"]:
        assert getattr(model, kind) == [signal["name"] for signal in read[kind]]
        assert all(model.units[signal["name"]] == signal["unit"] for signal in read[kind])
    assert model.operating_point == read["operating_point"]

    system = control.ss(model.A, model.B, model.C, model.D, inputs=model.inputs, outputs=model.outputs)
    numpy.testing.assert_allclose(
        numpy.sort_complex(system.poles()), numpy.sort_complex(model.poles), rtol=1e-6, atol=1e-6
    )


def test_a_point_that_is_none_is_refused_in_the_words_of_the_command_line(program, examples, tmp_path):
    """But for the name of the argument."""
    path = examples / "paper/fig-12.toml"
    scenario = mckibben.Scenario.from_file(path)
    for options in [{"gauge_pressure": "60 mm"}, {"gauge_pressure": "60 psi", "length": "85 mm", "load": "5 lb"}, {"duty": 1.5}]:
        words = [f"--{name.replace('_', '-')}={value}" for name, value in options.items()]
        printed = program(tmp_path, "linearize", str(path), *words, code=2).stderr
        with pytest.raises(mckibben.InputError) as raised:
            mckibben.linearize(scenario, **options)
        title = str(raised.value).splitlines()[0].removeprefix("error: ").removeprefix("`gauge_pressure`: ")
        assert title in printed


def test_quantities_are_text_with_a_unit_or_numbers_in_si(examples):
    scenario = mckibben.Scenario.from_file(examples / "paper/fig-12.toml")
    printed, numbers = [
        mckibben.linearize(scenario, length=length, load=load, temperature=temperature)
        for length, load, temperature in [("85 mm", "40 N", "20 degC"), (0.085, 40, 293.15)]
    ]
    assert printed.operating_point == pytest.approx(numbers.operating_point, rel=1e-12)
    for wrong, words in [(float("nan"), "pressure = NaN"), ("60 mm", "no pressure")]:
        with pytest.raises(mckibben.InputError, match=words):
            mckibben.linearize(scenario, gauge_pressure=wrong)
    with pytest.raises(TypeError, match="is of type list"):
        mckibben.linearize(scenario, gauge_pressure=[1e5])  # type: ignore[arg-type]
    by_text, by_number = mckibben.curves(scenario, "1.5, 3 bar"), mckibben.curves(scenario, numpy.array([1.5e5, 3e5]))
    assert all(numpy.allclose(by_text[name], by_number[name], rtol=1e-12) for name in by_text)


@pytest.mark.parametrize("study", ["tank", "steady-flow", "flow-curve", "pulse-train", "arm"])
def test_identification_is_that_of_the_command_line(study, program, examples, tmp_path):
    study = examples / f"identify/{study}.toml"
    program(tmp_path, "identify", str(study), "--output", "program")
    found = mckibben.identify(study, tmp_path / "own")
    files = {path.name: path.read_bytes() for path in (tmp_path / "program").iterdir()}
    assert {path.name: path.read_bytes() for path in (tmp_path / "own").iterdir()} == files
    with open(tmp_path / "program/values.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    assert [row["number"].strip("`") for row in rows] == [estimate.name for estimate in found.estimates]
    for row, estimate in zip(rows, found.estimates):
        assert row["unit"] == estimate.unit
        assert float(row["value"]) == pytest.approx(estimate.value, rel=1e-2)
        if estimate.confidence_interval is not None:
            assert estimate.confidence_interval[0] <= estimate.value <= estimate.confidence_interval[1]
        assert found[estimate.name] == estimate
    for name, scenario in found.scenarios.items():
        assert scenario == mckibben.Scenario.from_file(tmp_path / "program" / name)
    assert found.notes and found.scenarios


def test_steady_flow_is_predicted(examples):
    """(22): the flow coefficient times that of an ideal orifice of the area, written out, at each reading."""
    found = mckibben.identify(examples / "identify/steady-flow.toml")
    (prediction,) = found.predictions
    at, gas, ratio = prediction.coordinates, 286.99, 1.4
    r = at["downstream_absolute_pressure_pa"] / at["upstream_absolute_pressure_pa"]
    numpy.testing.assert_allclose(at["pressure_ratio"], r)
    choked = (2.0 / (ratio + 1.0)) ** (ratio / (ratio - 1.0))
    r = numpy.maximum(r, choked)
    shape = numpy.sqrt(2.0 * ratio / (gas * (ratio - 1.0)) * (r ** (2.0 / ratio) - r ** ((ratio + 1.0) / ratio)))
    ideal = 4e-6 * at["upstream_absolute_pressure_pa"] * shape / numpy.sqrt(at["temperature_k"])
    coefficient = found["flow_coefficient"].value
    numpy.testing.assert_allclose(prediction.predicted, coefficient * ideal, rtol=1e-4)
    assert (prediction.quantity, prediction.unit) == ("mass flow", "kg/s")
    # By least squares the residuals are at right angles to the flows.
    weight = prediction.predicted / (prediction.measured**2 if "same part" in found.notes[0] else 1.0)
    assert abs(weight @ prediction.residuals) < 1e-6 * (weight @ prediction.measured)
    curve = mckibben.identify(examples / "identify/flow-curve.toml")
    (fitted,) = curve.predictions
    numpy.testing.assert_array_equal(fitted.measured, prediction.measured)
    conductance, critical = curve["valve.sonic_conductance"].value, curve["valve.critical_ratio"].value
    at_rest = fitted.coordinates["pressure_ratio"] <= critical
    choked_flow = conductance * 1.185 * at["upstream_absolute_pressure_pa"] * numpy.sqrt(293.15 / at["temperature_k"])
    numpy.testing.assert_allclose(fitted.predicted[at_rest], choked_flow[at_rest], rtol=1e-3)
    assert abs(fitted.residuals).max() < abs(prediction.residuals).max() and len(curve.plot().axes) == 2


def test_delays_are_predicted(examples):
    """The delay of each onset, and the mean over all runs, which is the estimate."""
    found = mckibben.identify(examples / "identify/pulse-train.toml")
    assert len({prediction.run for prediction in found.predictions}) == 3
    for quantity, name in [("opening delay", "valve.opening_delay"), ("closing delay", "valve.closing_delay")]:
        mine = [prediction for prediction in found.predictions if prediction.quantity == quantity]
        delays = numpy.concatenate([prediction.measured for prediction in mine])
        assert delays.mean() == pytest.approx(found[name].value, rel=1e-9)
        for prediction in mine:
            assert prediction.unit == "s" and (prediction.predicted == found[name].value).all()
            assert (numpy.diff(prediction.coordinates["edge_s"]) > 0).all()
    frame = found.predictions_to_pandas()
    assert {"run", "quantity", "edge_s", "residual"} <= set(frame) and len(found.plot().axes) == 4


def test_parts_of_a_plant_are_identified(examples):
    """What was put into the data of the arm, and a scenario with the values found that runs with the names of the parts."""
    found = mckibben.identify(examples / "identify/arm.toml")
    truths = {
        "mechanism.joints.shoulder.inertia": 6e-3,
        "mechanism.joints.elbow.damping": 0.05,
        "actuators.biceps.turns": 2.7,
        "supplies.tank.reservoir_volume": 250e-6,
    }
    assert set(found.keys()) == set(truths) and not any("interval" in words for words in found.warnings)
    for name, truth in truths.items():
        low, high = found[name].confidence_interval
        assert low < truth < high and high - low < 0.05 * truth
    assert list(found.scenarios) == ["scenario.toml"]
    scenario = found.scenarios["scenario.toml"]
    assert scenario.to_dict()["actuators"]["biceps"]["turns"] == pytest.approx(found["actuators.biceps.turns"].value)
    run = mckibben.simulate(scenario)
    measured = numpy.genfromtxt(examples / "identify/arm.csv", delimiter=",", names=True)
    for name, column in [("shoulder", "shoulder.angle_rad"), ("elbow", "elbow.angle_rad")]:
        off = numpy.degrees(numpy.interp(measured["t"], run.t, run[column])) - measured[name]
        # The noise that `data.sh` adds, in deg.
        assert numpy.sqrt(numpy.mean(off**2)) == pytest.approx(0.1, rel=0.15)


def test_ring_downs_identify_their_friction(tmp_path):
    """What was put in is found again under a sensor's noise, in each run that is measured, by the names that a scenario has."""
    random = numpy.random.default_rng(4)
    friction = {"actuator.friction.coulomb_width": 1e-4, "actuator.friction.viscous": 9.0}
    rig = mckibben.Scenario("""\
        [actuator]
        preset = "colbrunn-2001"
        [load]
        kind = "hanging-mass"
        mass = "5 lb"
        [initial]
        gauge_pressure = "60 psi"
        length = "90 mm"
        [run]
        duration = "2 s"
        sample_interval = "1 ms"
        """, "rig.toml").with_values({"actuator.friction.coulomb_width": "0.1 mm", "actuator.friction.viscous": "9 N*s/m"})
    (tmp_path / "rig.toml").write_text(rig.to_toml())
    study = '[study]\nkind = "ring-down"\nscenario = "rig.toml"\n'
    study += '[columns.time]\nname = "t"\nunit = "s"\n[columns.length]\nname = "L"\nunit = "m"\n'
    masses = {"light": "5 lb", "heavy": "7 lb"}
    for name, mass in masses.items():
        run = mckibben.simulate(rig.with_values({"load.mass": mass}))
        seen = run.length + random.normal(0.0, 1e-5, run.length.size)
        rows = "".join(f"{time!r},{length!r}\n" for time, length in zip(run.t.tolist(), seen.tolist()))
        (tmp_path / f"{name}.csv").write_text("t,L\n" + rows)
        study += f'[[run]]\nfile = "{name}.csv"\nset = {{ "load.mass" = "{mass}" }}\n'
    (tmp_path / "study.toml").write_text(study)
    found = mckibben.identify(tmp_path / "study.toml")
    assert [estimate.name for estimate in found.estimates] == [f"{key} [{name}]" for name in masses for key in friction]
    for name in masses:
        for key, value in friction.items():
            estimate = found[f"{key} [{name}]"]
            assert abs(estimate.value - value) < 4.0 * estimate.standard_error < 0.01 * value
        assert found.scenarios[f"scenario-{name}.toml"].to_dict()["actuator"]["friction"]
    # The pressure with which the air was sealed may be stated with the run.
    (tmp_path / "rig.toml").write_text(rig.with_values({"initial.gauge_pressure": "20 psi"}).to_toml())
    held = study.replace('" }\n', '" }\nheld = { gauge_pressure = "60 psi" }\n')
    (tmp_path / "study.toml").write_text(held)
    again = mckibben.identify(tmp_path / "study.toml")
    assert [estimate.name for estimate in again.estimates] == [estimate.name for estimate in found.estimates]
    for one, other in zip(again.estimates, found.estimates):
        assert one.value == pytest.approx(other.value, rel=1e-6)


def test_presets_are_those_of_the_command_line(program, tmp_path):
    presets = mckibben.presets()
    for name, preset in presets.items():
        printed = program(tmp_path, "presets", name).stdout
        assert f'{preset.section}.preset = "{name}"' in printed
        for key, of in preset.values.items():
            row = next(line for line in printed.splitlines() if line.split()[:1] == [key])
            assert (of.text or of.value) in row
            if of.assumed:
                assert "assumed" in row
    assert presets["colbrunn-2001"].values["actuator.max_length"].value == 3.85 * 0.0254


def test_parameters_are_those_of_the_schema(program, tmp_path):
    """Every key of `mckibben schema` that is a quantity is there, and says what is said there."""
    schema = json.loads(program(tmp_path, "schema").stdout)

    def quantities(key: dict, path: str = ""):
        if key.get("$ref", "").startswith("#/$defs/shared-"):
            key = schema["$defs"][key["$ref"].rsplit("/", 1)[1]]
        if " Unit: " in key.get("description", ""):
            yield path, key["description"]
        for way in key.get("anyOf", []):
            yield from quantities(way, path)
        inner = dict(key.get("properties", {}))
        if path and isinstance(key.get("additionalProperties"), dict):
            inner["*"] = key["additionalProperties"]
        for name, entry in inner.items():
            below = f"{path}.{name}" if path else name
            # What these have is said where a file of one actuator has it, but for what only a supply with a name has.
            if below in ("antagonist", "sweep.vary", "actuators", "mechanisms"):
                continue
            if below == "mechanism.joints.*.controller":
                continue
            if below.startswith("supplies.*.") and not below.startswith("supplies.*.inlet"):
                continue
            yield from quantities(entry, below)

    said = dict(quantities(schema))
    parameters = mckibben.parameters()
    assert set(parameters) == set(said) and len(said) > 150
    for key, description in said.items():
        of = parameters[key]
        unit = of.unit
        words = [of.meaning, f"Symbol: {of.symbol}.", f"Unit: {unit or 'none'}.", f"Source: {of.source}."]
        words.append(f"Range: {of.range} {unit}".rstrip() + ".")
        assert all(word in description for word in words), (key, description)
        found = re.search(r" Default(?: without a preset)?: ([^ ]+?)(?: [^ ]+)?\. ", description)
        if of.default is not None:
            assert found and float(found[1]) == of.default, (key, description)
        ends = [end for end in (of.minimum, of.maximum) if end is not None]
        assert [float(end) for end in re.findall(r"-?[0-9][0-9.]*", of.range)] == ends, (key, of.range)
        assert ("at least" in of.range) == of.minimum_included, key
        assert ("at most" in of.range) == of.maximum_included, key


def test_the_ends_of_a_range_are_where_values_are_refused(swing):
    """By what a scenario takes, of keys whose quantity has one value and no other rules."""
    parameters = mckibben.parameters()
    tried = 0
    for key in ["actuator.external_volume", "actuator.friction.viscous", "actuator.friction.static_ratio", "load.mass",
                "air.heat_capacity_ratio", "actuator.wall_thickness", "run.relative_tolerance"]:
        of = parameters[key]
        for end in ["minimum", "maximum"]:
            limit = getattr(of, end)
            if limit is None:
                continue
            beyond = limit + (-1e-9 if end == "minimum" else 1e-9)
            for value, taken in [(limit, getattr(of, f"{end}_included")), (beyond, False)]:
                values = {key: f"{value!r} {of.unit}" if of.unit else value}
                tried += 1
                if taken:
                    swing.with_values(values)
                else:
                    with pytest.raises(mckibben.InputError, match="out of range"):
                        swing.with_values(values)
    assert tried > 10
    assert parameters["actuator.friction.viscous"].unit == "N*s/m"
    assert parameters["load.gravity"].default == 9.80665


def test_a_linear_model_goes_to_control_by_the_names_of_its_signals(examples):
    model = mckibben.linearize(mckibben.Scenario.from_file(examples / "paper/fig-12.toml"), length="85 mm")
    system = model.to_control()
    assert [system.state_labels, system.input_labels, system.output_labels] == [
        model.states, model.inputs, model.outputs
    ]
    omega = numpy.array([0.3, 3.0, 30.0])
    printed = numpy.moveaxis(numpy.array(system.frequency_response(omega).frdata), 2, 0)
    numpy.testing.assert_allclose(model.response(omega), printed, rtol=1e-6)
    figure = model.bode(outputs=["length"])
    assert [line.get_label() for line in figure.axes[1].lines] == ["length"]
    # A mass flow has a quotient as its unit, a force one symbol, and an opening none.
    for name, due in [("mass_flow", "velocity (m/s/(kg/s))"), ("force", "velocity (m/s/N)"), ("supply_opening", "velocity (m/s)")]:
        assert model.bode(name, ["velocity"]).axes[0].lines[0].get_label() == due
    with pytest.raises(mckibben.InputError, match="no input `nothing`"):
        model.bode("nothing")
    modes = model.damp()
    assert len(modes) == sum(pole.imag >= 0 for pole in model.poles)
    swings = [mode for mode in modes if mode.pole.imag]
    assert swings and all(0 < mode.damping_ratio < 1 for mode in swings)
    assert str(modes).count("\n") == len(modes)


def test_a_model_says_what_casts_doubt_on_it(examples):
    """A duty of 1 % is shorter than the valve's delays: its seat does not follow, and the gain is zero."""
    held = {"load": {"kind": "isometric"}, "initial.length": "85 mm"}
    scenario = mckibben.Scenario.from_file(examples / "paper/fig-12.toml").with_values(held)
    with pytest.warns(UserWarning, match="does not answer to the duty"):
        model = mckibben.linearize(scenario, duty=0.01)
    numpy.testing.assert_array_equal(model.B[:, model.inputs.index("duty")], 0.0)
    assert [words for words in model.warnings if "does not answer" in words and "ripple" not in words]
    assert model.details["pwm"]["validity"]["seats_follow"] is False


def test_the_response_at_a_pole_is_refused(examples):
    """A sealed chamber integrates the mass flow: the model has a pole at zero."""
    model = mckibben.linearize(mckibben.Scenario.from_file(examples / "isometric-charge.toml"))
    with pytest.raises(mckibben.InputError, match="a pole at zero.*leave 0.0 rad/s out of `omega`"):
        model.response([1.0, 0.0])
    assert numpy.isfinite(model.response([1.0])).all()


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("file", ["plant/arm", "plant/bottle", "plant/leg"])
def test_points_in_the_names_of_signals_are_underscores_in_control(file, examples):
    model = mckibben.linearize(mckibben.Scenario.from_file(examples / f"{file}.toml"))
    system = model.to_control()
    for labels, names in [
        (system.state_labels, model.states), (system.input_labels, model.inputs), (system.output_labels, model.outputs)
    ]:
        assert labels == [name.replace(".", "_").replace("-", "_") for name in names] and len(set(labels)) == len(labels)
    numpy.testing.assert_array_equal(system.A, model.A)


def test_names_without_points_stay_unequal():
    assert identifiers(["a.b", "a_b", "a.c", "a-c"]) == ["a_b_2", "a_b", "a_c", "a_c_2"]


def test_an_angle_without_lengths_is_refused_by_its_name(examples):
    joint = mckibben.Scenario.from_file(examples / "linearize-joint.toml")
    for angle, words in [(5, "(?s)`angle` = 5.000 rad gives an actuator a length of .*a number is in rad"), (-5, "`angle` = -5.000 rad")]:
        with pytest.raises(mckibben.InputError, match=words) as refused:
            mckibben.linearize(joint, angle=angle, stiffness=1)
        assert "controller" not in str(refused.value)
    with pytest.raises(mckibben.InputError, match="`stiffness` = 1.00e6 N.m/rad contradicts"):
        mckibben.linearize(joint, angle=0.2, stiffness=1e6)


def test_a_pressure_that_stands_at_the_supply_is_said_to_be_there(examples):
    """Pulses of a two-way valve fill the muscle up to the supply, where no air flows."""
    with pytest.warns(UserWarning, match="stands at that beyond an open port"):
        model = mckibben.linearize(mckibben.Scenario.from_file(examples / "valves/kv-two-way.toml"))
    assert not [words for words in model.warnings if "too large" in words]
