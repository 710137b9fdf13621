"""Plants whose ends a simulator moves: what is refused takes no time, and states are saved and restored."""

from __future__ import annotations

import itertools
import math

import numpy
import pytest

import mckibben


def plant(count: int = 1) -> mckibben.HostedPlant:
    scenario = mckibben.Scenario.from_dict(
        {
            "supply": {"gauge_pressure": "100 psi"},
            "valve": {"preset": "matrix-eight-channel"},
            "command": {"kind": "fill"},
            "load": {"kind": "isometric"},
            "initial": {"length": "90 mm", "gauge_pressure": "40 psi"},
            "run": {"duration": "1 s"},
        }
    )
    return mckibben.HostedPlant(scenario, count, command_mode="request")


def test_a_refused_step_takes_no_time():
    refused, plain = plant(), plant()
    distances, fill = numpy.array([[0.09]]), numpy.ones((1, 1))
    for _ in range(3):
        with pytest.raises(mckibben.InputError, match="actuator.request"):
            refused.step(distances, 7.0 * fill, 1e-3)
        for of in (refused, plain):
            of.step(distances, fill, 1e-3)
    assert refused.time == plain.time == 3e-3
    numpy.testing.assert_array_equal(refused.save(), plain.save())


def test_states_go_on_where_they_were_saved():
    first, second = plant(2), plant(2)
    distances, commands = numpy.array([[0.09], [0.088]]), numpy.array([[1.0], [-1.0]])
    for _ in range(20):
        first.step(distances, commands, 1e-3)
    second.restore(first.save())
    assert second.time == first.time
    for of in (first, second):
        of.step(distances, commands, 1e-3)
    numpy.testing.assert_array_equal(second.observe(), first.observe())


def test_restored_plants_continue_bit_identically(examples):
    """The clock is as many spans as there were from its origin: one that began at the time of the state rounds the fifth step from there
    to another time, and with it the edges of pulses."""
    scenario = mckibben.Scenario.from_file(examples / "isometric-charge.toml")

    def made() -> mckibben.HostedPlant:
        return mckibben.HostedPlant(scenario, 2, command_mode="duty", pulse_frequency=37.0)

    first, other, rate = made(), made(), numpy.array([[0.3], [0.7]])
    distances = numpy.full((2, 1), mckibben.Actuator(scenario, pulse_frequency=37.0).initial_length)

    def history(of: mckibben.HostedPlant) -> list[tuple[float, bytes, bytes]]:
        seen = []
        for _ in range(200):
            of.step(distances, rate, 1e-3)
            seen.append((of.time, of.observe().tobytes(), of.compute(distances, 0.0 * distances).tobytes()))
        return seen

    for of in (first, other):
        of.begin(distances, numpy.zeros((2, 1)))
    for _ in range(100):
        first.step(distances, rate, 1e-3)
    states = first.save()
    expected = history(first)
    assert expected[4][0] == 105 * 1e-3 != 0.1 + 5 * 1e-3
    first.restore(states)
    other.restore(states)
    assert history(first) == expected and history(other) == expected
    numpy.testing.assert_array_equal(first.save(), other.save())


def test_a_clock_that_is_not_at_the_time_of_the_states_is_refused():
    mine = plant()
    for _ in range(3):
        mine.step(numpy.array([[0.09]]), numpy.ones((1, 1)), 1e-3)
    states = mine.save()
    # Behind the mark: where the clock began, the duration of a step, and how many there were.
    assert states[0, 1:4].tolist() == [0.0, 1e-3, 3.0]
    for at, wrong in itertools.product((2, 3), (-1.0, 2.5, math.nan, math.inf, 1e300)):
        with pytest.raises(mckibben.InputError, match="clock"):
            mine.restore(numpy.where(numpy.arange(states.shape[1]) == at, wrong, states))
    numpy.testing.assert_array_equal(mine.save(), states)


def test_arrays_have_a_row_for_each_plant():
    with pytest.raises(mckibben.InputError, match="shape"):
        plant(2).step(numpy.array([[0.09]]), numpy.ones((1, 1)), 1e-3)
    with pytest.raises(mckibben.InputError, match="no finite number"):
        plant().step(numpy.array([[numpy.nan]]), numpy.ones((1, 1)), 1e-3)


def test_a_step_of_very_many_parts_is_that_of_shorter_steps():
    """It is taken in spans, between which Ctrl-C is handled: the end is that of steps along the same line, to rounding."""
    scenario = plant().scenario
    whole, shorter = (mckibben.HostedPlant(scenario, 2, command_mode="request", max_step=1e-5) for _ in range(2))
    begin, end = numpy.array([[0.09], [0.088]]), numpy.array([[0.087], [0.089]])
    fill = numpy.array([[1.0], [-1.0]])
    for of in (whole, shorter):
        of.begin(begin, numpy.zeros((2, 1)))
    whole.step(end, fill, 0.05)
    for step in range(1, 51):
        shorter.step(begin + step / 50 * (end - begin), fill, 1e-3)
    assert whole.time == pytest.approx(shorter.time, rel=1e-12)
    numpy.testing.assert_allclose(whole.observe(), shorter.observe(), rtol=1e-6, atol=1e-9)
    numpy.testing.assert_array_equal(whole.distances, end)
    before = whole.save()
    with pytest.raises(mckibben.InputError, match="more than 1e7"):
        whole.step(end, fill, 1000.0)
    numpy.testing.assert_array_equal(whole.save(), before)


def test_plants_together_are_those_alone():
    count = 200
    many, alone = plant(count), [plant() for _ in range(3)]
    number = numpy.arange(count)
    for step in range(30):
        distances = 0.09 - 1e-3 * numpy.sin(0.2 * step + number)[:, None] ** 2
        commands = ((number + step // 10) % 2 * 2 - 1.0)[:, None]
        many.step(distances, commands, 1e-3)
        for at, of in zip((0, 77, 199), alone, strict=True):
            of.step(distances[at : at + 1], commands[at : at + 1], 1e-3)
    velocities = numpy.full((count, 1), 0.01)
    tensions, observed = many.compute(distances, velocities), many.observe()
    for at, of in zip((0, 77, 199), alone, strict=True):
        numpy.testing.assert_array_equal(observed[at], of.observe()[0])
        numpy.testing.assert_array_equal(tensions[at], of.compute(distances[at : at + 1], velocities[:1])[0])


def test_a_plant_that_stops_leaves_the_others():
    two, one = plant(2), plant()
    fill = numpy.ones((2, 1))
    beyond_the_thread = numpy.array([[0.09], [0.5]])
    for step in (1, 2):
        with pytest.raises(mckibben.SimulationError, match="plant 1"):
            two.step(beyond_the_thread if step == 1 else numpy.full((2, 1), 0.09), fill, 1e-3)
        one.step(numpy.array([[0.09]]), fill[:1], 1e-3)
    assert two.time == one.time == 2e-3
    with pytest.raises(mckibben.SimulationError, match="plant 1"):
        two.observe()
    two.begin(numpy.full((2, 1), 0.09), numpy.zeros((2, 1)))
    two.step(numpy.full((2, 1), 0.09), fill, 1e-3)
    numpy.testing.assert_array_equal(two.observe()[0], two.observe()[1])


def of(**sections) -> mckibben.Scenario:
    """The scenario of `plant`, with other sections."""
    return mckibben.Scenario.from_dict(plant().scenario.to_dict() | sections)


def test_states_of_other_plants_are_refused():
    """Their numbers may be as many, and showed an impossible temperature."""
    mine = plant(2)
    before = mine.save()
    for other in (
        mckibben.HostedPlant(of(supply={"gauge_pressure": "90 psi"}), 2, command_mode="request"),
        mckibben.HostedPlant(
            of(actuator={"preset": "festo-dmsp-20-300"}, initial={"length": "250 mm", "gauge_pressure": "1 bar"}), 2
        ),
        mckibben.HostedPlant(mine.scenario, 2, pulse_frequency=25.0),
    ):
        with pytest.raises(mckibben.InputError, match=r"states\[0\] is of another plant"):
            mine.restore(other.save())
    # The first row alone is from a plant that fits.
    mixed = numpy.where([[True], [False]], before, before + 1.0)
    with pytest.raises(mckibben.InputError, match=r"states\[1\] is of another plant"):
        mine.restore(mixed)
    for wrong in (before[:1], before[:, :0], before[:, :-1], before[0], numpy.zeros_like(before), before.astype(numpy.float32)):
        with pytest.raises((mckibben.InputError, TypeError)):
            mine.restore(wrong)
    numpy.testing.assert_array_equal(mine.save(), before)


def test_states_of_another_start_are_restored():
    """Load, start and run take no part in a state."""
    mine = plant(2)
    other = mckibben.HostedPlant(of(initial={"length": "85 mm", "gauge_pressure": "10 psi"}, run={"duration": "2 s"}), 2,
                                 command_mode="request")
    distances, fill = numpy.full((2, 1), 0.09), numpy.ones((2, 1))
    for _ in range(5):
        other.step(distances, fill, 1e-3)
    mine.restore(other.save())
    for its in (mine, other):
        its.step(distances, fill, 1e-3)
    numpy.testing.assert_array_equal(mine.save(), other.save())


def test_no_restored_length_is_below_zero():
    mine = plant()
    mine.begin(numpy.array([[0.0875]]), numpy.zeros((1, 1)))
    states = mine.save()
    wrong = numpy.where(states == 0.0875, -0.0875, states)
    assert (wrong != states).any()
    with pytest.raises(mckibben.InputError, match="no state of this plant"):
        mine.restore(wrong)
    numpy.testing.assert_array_equal(mine.save(), states)


def test_states_of_different_times_name_the_plant():
    mine = plant(2)
    states = mine.save()
    mine.step(numpy.full((2, 1), 0.09), numpy.ones((2, 1)), 1e-3)
    states[1] = mine.save()[1]
    with pytest.raises(mckibben.InputError, match="plant 1: the states are of different times"):
        mine.restore(states)
    assert mine.time == 1e-3


def test_a_plant_begins_again_while_the_others_continue():
    three, whole, late = plant(3), plant(3), plant()
    distances, fill = numpy.array([[0.09], [0.088], [0.089]]), numpy.ones((3, 1))
    for _ in range(20):
        three.step(distances, fill, 1e-3)
        whole.step(distances, fill, 1e-3)
    late.begin(numpy.array([[0.085]]), numpy.array([[0.01]]))
    three.restart(numpy.array([1]), numpy.array([[0.085]]), numpy.array([[0.01]]))
    assert three.time == 20e-3
    assert three.distances[1, 0] == 0.085
    numpy.testing.assert_allclose(three.observe()[1], late.observe()[0], rtol=1e-9, atol=1e-12)
    distances[1] = 0.085
    for _ in range(20):
        three.step(distances, fill, 1e-3)
        whole.step(distances, fill, 1e-3)
        late.step(distances[1:2], fill[:1], 1e-3)
    numpy.testing.assert_array_equal(three.observe()[[0, 2]], whole.observe()[[0, 2]])
    # Only the instants at which the valve moves are rounded at another time.
    numpy.testing.assert_allclose(three.observe()[1], late.observe()[0], rtol=1e-6, atol=1e-9)
    assert (three.observe()[1] != whole.observe()[1]).any()


def test_a_plant_that_has_stopped_begins_again():
    two = plant(2)
    fill, distances = numpy.ones((2, 1)), numpy.full((2, 1), 0.09)
    with pytest.raises(mckibben.SimulationError, match="plant 1"):
        two.step(numpy.array([[0.09], [0.5]]), fill, 1e-3)
    two.restart(numpy.array([1]), distances[:1], numpy.zeros((1, 1)))
    two.step(distances, fill, 1e-3)
    assert two.time == 2e-3 and numpy.isfinite(two.observe()).all()


@pytest.mark.parametrize(
    ("rows", "distances", "velocities", "words"),
    [
        ([3], [[0.09]], [[0.0]], r"rows\[0\] = 3"),
        ([-1], [[0.09]], [[0.0]], r"rows\[0\] = -1"),
        ([0, 0], [[0.09], [0.09]], [[0.0], [0.0]], r"rows\[1\] = 0"),
        ([0, 1], [[0.09], [-0.09]], [[0.0], [0.0]], r"distances\[1, 0\]"),
        ([0, 1], [[0.09], [0.5]], [[0.0], [0.0]], "plant 1: .* thread"),
        ([0, 1], [[0.09], [0.09]], [[0.0], [1e9]], r"velocities\[1, 0\]"),
        ([0, 1], [[0.09]], [[0.0]], r"shape \(2, 1\)"),
    ],
)
def test_a_restart_that_is_refused_changes_nothing(rows, distances, velocities, words):
    three = plant(3)
    three.step(numpy.full((3, 1), 0.088), numpy.ones((3, 1)), 1e-3)
    before = three.save()
    with pytest.raises(mckibben.InputError, match=words):
        three.restart(numpy.array(rows), numpy.array(distances), numpy.array(velocities))
    numpy.testing.assert_array_equal(three.save(), before)


def test_ends_are_named_by_their_elements():
    two, zero = plant(2), numpy.zeros((2, 1))
    wrong, fast = numpy.array([[0.09], [-0.09]]), numpy.array([[0.0], [1e9]])
    for use in (
        lambda: two.begin(wrong, zero),
        lambda: two.compute(wrong, zero),
        lambda: two.step(wrong, zero, 1e-3),
    ):
        with pytest.raises(mckibben.InputError, match=r"distances\[1, 0\] = -0.09 m"):
            use()
    for use in (lambda: two.begin(numpy.full((2, 1), 0.09), fast), lambda: two.compute(numpy.full((2, 1), 0.09), fast)):
        with pytest.raises(mckibben.InputError, match=r"(?s)velocities\[1, 0\] = 1000000000.0 m/s.*between -1e6 and 1e6"):
            use()
    assert numpy.isfinite(two.compute(numpy.full((2, 1), 0.09), numpy.full((2, 1), 1e6))).all()


@pytest.mark.parametrize("count", [0, -1, True])
def test_there_is_one_plant_or_more(count):
    with pytest.raises(mckibben.InputError, match=f"count = {count} .*\n.*from 1 on"):
        plant(count)
