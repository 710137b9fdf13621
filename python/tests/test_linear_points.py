"""Linear models of plants with manifolds, and of spools at an edge, against the nonlinear simulation."""

from __future__ import annotations

import numpy
import pytest

import mckibben

MANIFOLD = """\
[supplies.bottle]
gauge_pressure = "6 bar"
[supplies.manifold]
from = "bottle"
reservoir_volume = "40 cm^3"
gauge_pressure = "6 bar"
inlet.flow_area = "0.5 mm^2"
[valve]
kind = "three-way"
flow_area = "0.4 mm^2"
[command]
kind = "pwm"
frequency = "100 Hz"
duty = 0.45
[initial]
gauge_pressure = "1 bar"
[load]
kind = "hanging-mass"
mass = "2 kg"
[actuators.one]
supply = "manifold"
preset = "colbrunn-2001"
friction.coulomb_width = "0 m"
[run]
duration = "3 s"
"""


def spool(overlap: float) -> mckibben.Scenario:
    """A muscle on a proportional spool in the middle of its stroke."""
    return mckibben.Scenario.from_dict({
        "actuator": {"preset": "colbrunn-2001", "friction": {"coulomb_width": "0 m", "viscous": "2 N*s/m"}},
        "supply": {"gauge_pressure": "100 psi"},
        "valve": {"kind": "proportional-spool", "flow_area": "0.5 mm^2",
                  "spool": {"natural_frequency": "100 Hz", "damping_ratio": 0.7, "supply_overlap": overlap, "exhaust_overlap": overlap}},
        "command": {"kind": "positions", "time": ["0 s"], "position": [0.0]},
        "load": {"kind": "hanging-mass", "mass": "5 lb"},
        "initial": {"gauge_pressure": "2 bar"},
        "run": {"duration": "0.1 s"},
    })  # fmt: skip


def test_a_spool_without_overlap_has_the_mean_of_both_gains():
    with pytest.warns(UserWarning, match="at an edge: the model has the mean of both gains"):
        model = mckibben.linearize(spool(0.0))
    entry = model.A[model.states.index("pressure"), model.states.index("spool_position")]
    actuator = mckibben.Actuator(spool(0.0))
    gains = []
    for position in (1e-4, -1e-4):
        # 50 ms: the spool has arrived, and the pressure has hardly changed.
        state = actuator.start()
        for _ in range(1000):
            state, _, rates = actuator.step(state, actuator.initial_length, 0.0, position, 5e-5)
        gains.append(rates.pressure_rate / position)
    assert gains[0] > 2 * gains[1]
    assert entry == pytest.approx(sum(gains) / 2, rel=1e-3)


def test_a_spool_in_its_dead_zone_is_warned_of():
    with pytest.warns(UserWarning, match="dead zone, where its gain is zero"):
        model = mckibben.linearize(spool(0.05))
    assert model.A[model.states.index("pressure"), model.states.index("spool_position")] == 0


def test_a_driven_plant_is_linearised_where_its_manifold_settles():
    scenario = mckibben.Scenario(MANIFOLD)
    model = mckibben.linearize(scenario)
    point = model.operating_point
    assert abs(point["manifold.mass_flow_kg_s"]) < 1e-12

    def settled(duty: float) -> list[float]:
        run = mckibben.simulate(scenario.with_values({"command.duty": duty}))
        late = run.t > 2.5
        return [run[f"{name}.gauge_pressure_pa"][late].mean() for name in ("manifold", "one")]

    manifold, one = settled(0.45)
    # The distance to the pressure of the source is 15 kPa.
    assert point["manifold.gauge_pressure_pa"] == pytest.approx(manifold, abs=300)
    assert point["one.gauge_pressure_pa"] == pytest.approx(one, rel=5e-3)
    gains = -model.C @ numpy.linalg.solve(model.A, model.B)
    gain = gains[model.outputs.index("one.pressure"), model.inputs.index("one.duty")]
    assert gain == pytest.approx((settled(0.46)[1] - settled(0.44)[1]) / 0.02, rel=0.03)


@pytest.mark.parametrize("kind", ["", 'inlet.kind = "check-valve"\n'])
def test_an_inlet_stays_open_where_valves_are_held_shut(kind):
    text = MANIFOLD.replace("[valve]", f"{kind}[valve]").replace('kind = "three-way"', 'kind = "fill-hold-exhaust"')
    text = text.replace('kind = "pwm"\nfrequency = "100 Hz"\nduty = 0.45', 'kind = "hold"')
    model = mckibben.linearize(mckibben.Scenario(text))
    row = model.states.index("manifold.pressure")
    # The straight line of (23) near equal pressures: A_p C_m(0.999)/(0.001 sqrt(T)) RT/V.
    assert model.A[row, row] == pytest.approx(-162.06, rel=1e-4)
    assert model.operating_point.get("manifold.supply_opening", 1.0) == 1.0


def test_a_bottle_that_nothing_fills_is_warned_of():
    text = MANIFOLD.replace('gauge_pressure = "6 bar"\n', 'gauge_pressure = "6 bar"\nreservoir_volume = "500 cm^3"\n', 1)
    with pytest.warns(UserWarning, match="bottle: .* kept by a mass flow .* the pressure does not last"):
        mckibben.linearize(mckibben.Scenario(text))


@pytest.mark.parametrize("hose", [{}, {"hose": {"length": "4 m", "diameter": "6 mm"}}])
def test_the_delay_is_when_a_step_of_the_command_begins_to_act(hose):
    """A step of 0.2 bar at 0.1 s, through a regulator with a dead time of 50 ms and a hose."""
    scenario = mckibben.Scenario.from_dict({
        "actuator": {"preset": "colbrunn-2001"},
        "supply": {"gauge_pressure": "5 bar"},
        "valve": {"kind": "pressure-regulator", "flow_area": "0.3 mm^2", "time_constant": "20 ms", "rate_limit": "50 bar/s",
                  "dead_time": "50 ms"},
        "command": {"kind": "set-points", "time": ["0 s", "0.1 s"], "gauge_pressure": ["3 bar", "3.2 bar"]},
        "load": {"kind": "isometric"},
        "initial": {"gauge_pressure": "3 bar", "length": "85 mm"},
        "run": {"duration": "0.2 s", "sample_interval": "1 ms"},
        **hose,
    })  # fmt: skip
    model = mckibben.linearize(scenario)
    delay = model.delay["set_point"]
    assert delay > 0.06 if hose else delay == 0.05
    assert all(late == 0.0 for name, late in model.delay.items() if name != "set_point")
    run = mckibben.simulate(scenario)
    change = run["hose_absolute_pressure_pa" if hose else "absolute_pressure_pa"] - run["absolute_pressure_pa"][0]
    assert abs(change[run.t < 0.1 + delay]).max() < 1e-6
    assert change[run.t > 0.1 + delay + 0.002].min() > 1.0


@pytest.mark.parametrize("omega", [numpy.nan, numpy.inf, -numpy.inf])
def test_a_response_at_no_frequency_is_refused(omega):
    model = mckibben.linearize(mckibben.Scenario(MANIFOLD))
    with pytest.raises(mckibben.InputError, match="`omega` has .*no finite angular frequency"):
        model.response([1.0, omega])


@pytest.mark.parametrize(
    ("kind", "frequency", "duty", "delays", "shares"),
    [
        # The supply is open for the pulse, longer by how much later it shuts than opens, and the exhaust for the rest of the period.
        ("three-way", 25, 0.5, (4, 1), (0.425, 0.575)),
        ("three-way", 25, 0.5, (4, 9), (0.625, 0.375)),
        # Each port has a poppet that opens 4 ms late and shuts 9 ms late: both are open for a part of the period.
        ("fill-hold-exhaust", 25, 0.5, (4, 9), (0.625, 0.625)),
        # A pulse of 5 ms does not open; the rest of 95 ms opens 9 ms late and shuts 2 ms late.
        ("fill-hold-exhaust", 10, 0.05, (9, 2), (0.0, 0.88)),
    ],
)
@pytest.mark.parametrize("actuators", [{}, {"muscle": {}}])
@pytest.mark.filterwarnings("ignore::UserWarning")
def test_shares_are_the_mean_openings_of_a_run(kind, frequency, duty, delays, shares, actuators):
    both = {"pulse": "fill", "rest": "exhaust"} if kind == "fill-hold-exhaust" else {}
    scenario = mckibben.Scenario.from_dict({
        "actuator": {"preset": "colbrunn-2001"},
        "supply": {"gauge_pressure": "6 bar"},
        "valve": {"kind": kind, "flow_area": "0.05 mm^2", "opening_delay": f"{delays[0]} ms", "closing_delay": f"{delays[1]} ms"},
        "command": {"kind": "pwm", "frequency": f"{frequency} Hz", "duty": duty, **both},
        "load": {"kind": "isometric"},
        "initial": {"gauge_pressure": "2 bar", "length": "85 mm"},
        "run": {"duration": "1 s"},
        **({"actuators": actuators} if actuators else {}),
    })  # fmt: skip
    (pulses,) = mckibben.linearize(scenario).validity.pulses
    assert pulses.valve == next(iter(actuators), "")
    assert (pulses.supply_share, pulses.exhaust_share) == pytest.approx(shares, abs=1e-12)
    if actuators:
        return
    run = mckibben.simulate(scenario)
    # Five whole periods, at instants between those at which a poppet moves.
    times = 0.5 + (numpy.arange(10_000) + 0.5) / 10_000 * 5 / frequency
    states = run.at_times(times)["valve"]
    for port, share in zip(("supply", "exhaust"), shares):
        assert numpy.mean([port in state for state in states]) == pytest.approx(share, abs=1e-3)
