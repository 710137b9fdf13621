"""Derivatives of runs: against differences, and through JAX forwards and backwards."""

from __future__ import annotations

import pickle

import jax
import numpy
import pytest

import mckibben

jax.config.update("jax_enable_x64", True)

PULSED = """\
[supply]
gauge_pressure = "100 psi"
[valve]
preset = "matrix-eight-channel"
[command]
kind = "pwm"
frequency = "25 Hz"
duty = 0.4
[load]
kind = "hanging-mass"
mass = "5 lb"
[initial]
gauge_pressure = "10 psi"
length = "equilibrium"
[run]
duration = "0.2 s"
relative_tolerance = 1e-10
"""

HOSE = """\
[hose]
diameter = "2.5 mm"
length = "1 m"
[pressure]
at = "hose"
time = ["0 s", "20 ms", "0.5 s"]
gauge_pressure = ["1 bar", "4 bar", "3.5 bar"]
[load]
kind = "isometric"
[initial]
length = "85 mm"
[run]
duration = "10 ms"
"""

BY = ["load.mass", "command.duty", "actuator.turns", "valve.efficiency", "supply.gauge_pressure", "initial.temperature"]
BY += ["actuator.friction.viscous", "actuator.external_volume", "valve.opening_delay"]


@pytest.fixture(scope="module")
def pulsed() -> mckibben.Differentiable:
    scenario = mckibben.Scenario(PULSED, "pulsed.toml")
    return mckibben.Differentiable(scenario, parameters=BY, quantities=["length", "gauge_pressure", "tension"], times=[0.053, 0.131, 0.2])


def test_values_are_those_of_the_run(pulsed):
    run = mckibben.simulate(pulsed.scenario)
    values = pulsed(pulsed.defaults)
    assert values.shape == (3, 3) and pulsed.units == {"length": "m", "gauge_pressure": "Pa", "tension": "N"}
    for time, (length, _, tension) in zip(pulsed.times, values):
        at = run.at(time)
        numpy.testing.assert_allclose([length, tension], [at["length_m"], at["tension_n"]], rtol=1e-12)


def test_derivatives_are_those_of_differences(pulsed):
    """No event lies at these times. The error of central differences is the square of the step and the run's own error over it."""
    start = pulsed.defaults
    values, slopes = pulsed.value_and_jacobian(start)
    scale = abs(values).max(axis=0)
    # Steps are short enough for the derivatives too, so that values differ by what the tolerance leaves.
    numpy.testing.assert_allclose(values / scale, pulsed(start) / scale, atol=1e-8)
    assert slopes.shape == (3, 3, len(BY)), "more numbers than one pass takes"
    for number, value in enumerate(start):
        step = 1e-5 * value
        there = [pulsed(start + sign * step * (numpy.arange(len(BY)) == number)) for sign in (1, -1)]
        difference = (there[0] - there[1]) / (2 * step)
        numpy.testing.assert_allclose(slopes[..., number] * value / scale, difference * value / scale, atol=2e-4)
        assert abs(slopes[..., number]).max() > 0


def test_jax_differentiates_forwards_and_backwards(pulsed):
    function = pulsed.for_jax()
    _, slopes = pulsed.value_and_jacobian(pulsed.defaults)
    numpy.testing.assert_array_equal(jax.jit(function)(pulsed.defaults), pulsed(pulsed.defaults))
    forwards = jax.jacfwd(function)(pulsed.defaults)
    backwards = jax.jacrev(function)(pulsed.defaults)
    numpy.testing.assert_allclose(forwards, slopes, rtol=1e-14)
    numpy.testing.assert_allclose(backwards, slopes, rtol=1e-14)

    def reduced(values):
        return (function(values)[:, 0] ** 2).sum()

    expected = 2 * numpy.einsum("t,tp->p", pulsed(pulsed.defaults)[:, 0], slopes[:, 0])
    numpy.testing.assert_allclose(jax.grad(reduced)(pulsed.defaults), expected, rtol=1e-8)


def test_runs_of_a_vmap_equal_single_runs_and_have_their_derivatives(pulsed):
    function = pulsed.for_jax()
    shares = 1 + 0.001 * numpy.arange(6).reshape(2, 3, 1)
    several = pulsed.defaults * shares
    found = jax.vmap(jax.vmap(function))(several)
    slopes = jax.vmap(jax.vmap(jax.jacrev(function)))(several)
    for row, column in numpy.ndindex(2, 3):
        value, alone = pulsed.value_and_jacobian(several[row, column])
        numpy.testing.assert_allclose(found[row, column], value, rtol=1e-8, atol=1e-8 * abs(value).max())
        numpy.testing.assert_allclose(slopes[row, column], alone, rtol=1e-13)
    with pytest.raises(Exception, match="load.mass"):
        jax.vmap(function)(numpy.array([pulsed.defaults, -pulsed.defaults]))


def test_a_joint_has_derivatives_by_both_actuators(examples):
    joint = mckibben.Scenario.from_file(examples / "antagonistic-joint.toml").with_values({"run.duration": "50 ms"})
    by = ["actuator.turns", "antagonist.actuator.turns", "load.inertia"]
    angle = mckibben.Differentiable(joint, by, ["angle"], [0.05])
    _, slopes = angle.value_and_jacobian(angle.defaults)
    assert slopes.shape == (1, 1, 3) and slopes[0, 0, 0] * slopes[0, 0, 1] < 0, "they pull against each other"


@pytest.mark.parametrize(
    ("file", "values", "paths", "quantity"),
    [
        ("valves/pressure-regulator", {}, ["command.gauge_pressure", "command.time"], "length"),
        (
            "valves/proportional-spool",
            {"command.position": [0.04, 0.1, 0.6, -0.1], "command.time": [0.1, 0.3, 0.6, 0.9]},
            ["command.position", "command.time"],
            "gauge_pressure",
        ),
        (
            "valves/pressure-regulator",
            {"load": {"kind": "prescribed-motion", "time": [0.0, 0.3, 0.8], "table_length": [0.09, 0.085, 0.088]}},
            ["load.table_length", "command.gauge_pressure"],
            "tension",
        ),
    ],
)
def test_a_sequence_of_controls_is_differentiated_by(file, values, paths, quantity, examples):
    """Each entry of a table of commands or of a motion: against central differences."""
    scenario = mckibben.Scenario.from_file(examples / f"{file}.toml")
    if "load" in values:
        sections = scenario.to_dict() | values
        sections["initial"] = {"gauge_pressure": sections["initial"]["gauge_pressure"]}
        scenario, values = mckibben.Scenario.from_dict(sections), {}
    scenario = scenario.with_values(values | {"run.relative_tolerance": 1e-10, "run.duration": 1.0})
    run = mckibben.Differentiable(scenario, paths, [quantity], [0.23, 0.55, 0.97])
    counts = [len(scenario.to_dict()[path.split(".")[0]][path.split(".")[1]]) for path in paths]
    assert run.parameters == [f"{path}[{place}]" for path, count in zip(paths, counts) for place in range(count)]
    start = run.defaults
    read, slopes = run.value_and_jacobian(start)
    assert slopes.shape == (3, 1, sum(counts))
    for place, value in enumerate(start):
        step = 1e-5 * max(abs(value), 1e-3) * (numpy.arange(len(start)) == place)
        if value == 0.0:
            continue  # A time of zero has one side.
        difference = (run(start + step) - run(start - step)) / (2 * step[place])
        scale = abs(read).max() / abs(value)
        numpy.testing.assert_allclose(slopes[..., place] / scale, difference / scale, atol=3e-4, err_msg=run.parameters[place])
    taken = [place for place, path in enumerate(run.parameters) if path.startswith(paths[0])][:2]
    assert (abs(slopes[-1, 0, taken]) > 0).all(), "entries before the last time have their part in it"


def test_impossible_arguments_are_refused(pulsed):
    scenario = pulsed.scenario
    for by, of, at, words in [
        (["load.mas"], ["length"], [0.1], "did you mean `load.mass`"),
        (["load.mass"], ["angle"], [0.1], "`angle` is no quantity"),
        (["load.mass"], ["length"], [0.3], "is no time of the run"),
        (["load.mass"], ["length"], [float("nan")], "is no time of the run"),
    ]:
        with pytest.raises(mckibben.InputError, match=words):
            mckibben.Differentiable(scenario, by, of, at)
    with pytest.raises(mckibben.InputError, match="1 values were given for 9 parameters"):
        pulsed([1.0])
    with pytest.raises(mckibben.InputError, match="load.mass"):
        pulsed([-1.0, *pulsed.defaults[1:]])


def test_it_can_be_pickled(pulsed):
    again = pickle.loads(pickle.dumps(pulsed))
    numpy.testing.assert_array_equal(again(again.defaults), pulsed(pulsed.defaults))


def test_air_that_rests_behind_a_hose_has_the_derivatives_of_differences():
    """The muscle starts at the pressure at its hose: nothing flows, and the derivatives settle as fast as the hose lets them."""
    by = ["pressure.offset", "pressure.scale"]
    model = mckibben.Differentiable(
        mckibben.Scenario(HOSE, "hose.toml"), parameters=by, quantities=["gauge_pressure"], times=[2e-3, 2.9e-3, 5e-3]
    )
    start = model.defaults
    _, slopes = model.value_and_jacobian(start)
    for number, size in enumerate([100.0, 1e-3]):
        step = numpy.eye(len(by))[number] * size
        differences = (model(start + step) - model(start - step)) / (2.0 * size)
        numpy.testing.assert_allclose(slopes[:, :, number], differences, rtol=0.05)


def test_a_list_and_its_entry_are_one_number_twice(examples):
    """The derivative with respect to a number that is named twice would be divided between the two, or lost."""
    scenario = mckibben.Scenario.from_file(examples / "valves/pressure-regulator.toml")
    for paths, words in [
        (["command.gauge_pressure", "command.gauge_pressure[1]"], r"names `command.gauge_pressure\[1\]` twice"),
        (["command.gauge_pressure[1]", "command.gauge_pressure[01]"], r"also as `command.gauge_pressure\[1\]`"),
        (["load.mass", "load.mass"], "names `load.mass` twice"),
    ]:
        with pytest.raises(mckibben.InputError, match=words):
            mckibben.Differentiable(scenario, paths, ["length"], [0.1])


def test_an_empty_batch_has_the_shape_of_its_results(swing):
    """Without JAX or PyTorch: what both call for the sets of values in a batch."""
    from mckibben._beside import _over_batches

    run = mckibben.Differentiable(swing, ["load.mass"], ["length", "tension"], [0.02, 0.05, 0.1])
    both_of = _over_batches(run.value_and_jacobian, [(3, 2), (3, 2, 1)], 1)
    for batch in ((0,), (2, 0), (2,)):
        values, slopes = both_of(numpy.full((*batch, 1), 2.0))
        assert values.shape == (*batch, 3, 2) and slopes.shape == (*batch, 3, 2, 1)
    with pytest.raises(mckibben.InputError, match="sets of 2 values"):
        both_of(numpy.zeros((0, 2)))
