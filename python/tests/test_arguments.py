"""What no calculation can begin with is refused by the argument's name; nothing ends the interpreter or never comes back."""

from __future__ import annotations

import collections.abc
import concurrent.futures
import functools
import itertools
import math
import pathlib
import re
import typing

import numpy
import pytest

import mckibben

STEP = 1e-3
NOT_FINITE = [math.nan, math.inf, -math.inf]


@pytest.fixture(scope="module")
def scenario(examples) -> mckibben.Scenario:
    return mckibben.Scenario.from_file(examples / "paper/fig-12.toml")


def arrays(count: int) -> dict[str, numpy.ndarray]:
    """What `Actuators.step` takes."""
    return {"length": numpy.full(count, 0.09), "velocity": numpy.zeros(count), "command": numpy.full(count, 0.5),
            "tension": numpy.full(count, -1.0)}


def nested(depth: int) -> typing.Any:
    value: typing.Any = "5 lb"
    for _ in range(depth):
        value = {"a": value}
    return value


# --- values within each other, and what lies about its length -------------------------------------------------------


def test_a_dictionary_that_contains_itself_is_refused_by_its_keys(swing):
    load: dict[str, typing.Any] = {"kind": "hanging-mass"}
    load["again"] = [{"deeper": load}]
    whole: dict[str, typing.Any] = {"load": {"kind": "isometric"}}
    whole["load"]["of"] = whole
    items: list[typing.Any] = [1.0]
    items.append(items)
    with pytest.raises(mckibben.InputError, match=r"`load.again\[0\].deeper` is `load` again: it contains itself"):
        mckibben.Scenario.from_dict({"load": load})
    with pytest.raises(mckibben.InputError, match="`load.of` is the whole dictionary again"):
        mckibben.Scenario.from_dict(whole)
    with pytest.raises(mckibben.InputError, match=r"`load.mass\[1\]` is `load.mass` again"):
        swing.with_values({"load.mass": items})
    # One value in two places is no circle.
    shared = {"temperature": "20 degC"}
    with pytest.raises(mckibben.InputError, match="not a key|unknown|no section"):
        mckibben.Scenario.from_dict({"a": shared, "b": shared})


@pytest.mark.parametrize("depth", [65, 10_000, 200_000])
def test_values_nested_deeper_than_any_scenario_are_refused(depth, swing):
    with pytest.raises(mckibben.InputError, match=r"`load(\.a)+` lies deeper than 64 levels"):
        mckibben.Scenario.from_dict({"load": nested(depth)})
    with pytest.raises(mckibben.InputError, match="lies deeper than 64 levels"):
        swing.with_values({"load.mass": nested(depth)})


@pytest.mark.parametrize("text", ["a = " + 20_000 * "[", "a" + 20_000 * ".a" + " = 1", "a = " + 20_000 * "{a=", 20_000 * "[a." ])
def test_text_nested_deeper_than_any_scenario_is_refused(text):
    with pytest.raises(mckibben.InputError):
        mckibben.Scenario(text)


def test_a_path_of_very_many_keys_is_refused(swing):
    with pytest.raises(mckibben.InputError):
        swing.with_values({".".join(20_000 * ["a"]): 1.0})


class Liar(collections.abc.Sequence):
    """Says that it has more items than there is memory for."""

    def __init__(self, *items: typing.Any) -> None:
        self.items = items

    def __len__(self) -> int:
        return 2**62

    def __getitem__(self, place: typing.Any) -> typing.Any:
        return self.items[place]


class LyingList(list):  # type: ignore[type-arg]
    def __len__(self) -> int:
        return 2**62


@pytest.mark.parametrize("lying", [Liar, lambda *items: LyingList(items)])
def test_a_sequence_that_lies_about_its_length_counts_by_its_items(lying, swing, examples):
    made, honest = (
        swing.with_values({"actuator.preset": "colbrunn-2001", "actuator.effectiveness.pressure_unit": "psi",
                           "actuator.effectiveness.polynomial": coefficients}) for coefficients in (lying(0.5, 0.001), [0.5, 0.001])
    )
    assert made == honest != swing
    driven = mckibben.Scenario.from_file(examples / "paper/fig-12.toml")
    plants = mckibben.VectorPlant(driven, 2, parameters=lying("load.mass"), action_mode="request")
    assert plants.parameters == ["load.mass"]
    of = mckibben.Differentiable(swing, lying("load.mass"), lying("length"), [0.1])
    assert of.parameters == ["load.mass"] and of.quantities == ["length"]
    assert mckibben.Scenario(swing.text, "swing", lying(("load.mass", '"6 lb"'))) == swing.with_values({"load.mass": "6 lb"})
    assert mckibben.Event(1.0, lying("event"), lying("stick")).kind == "stick"


def test_a_sequence_without_end_is_refused(swing):
    with pytest.raises(mckibben.InputError, match="more than 2000000 values up to `load.mass"):
        swing.with_values({"load.mass": itertools.repeat(1.0)})
    with pytest.raises(mckibben.InputError, match="more than 2000000 items"):
        mckibben.Differentiable(swing, itertools.repeat("load.mass"), ["length"], [0.1])  # type: ignore[arg-type]


# --- counts ---------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("count", [10**9, 10**12, 2**61, 2**63, 2**64 - 1])
def test_more_than_memory_holds_is_refused_before_anything_is_made(count, scenario):
    for made in [lambda: mckibben.Actuators(scenario, count), lambda: mckibben.VectorPlant(scenario, count)]:
        with pytest.raises(MemoryError, match=rf"^{count} (actuators|plants) need .* [TPE]B .*of memory.*count of \d+ at most"):
            made()


@pytest.mark.parametrize("count", [-1, 2**64, -(10**30), 10**4000])
def test_what_is_no_count_is_refused(count, scenario):
    for made in [lambda: mckibben.Actuators(scenario, count), lambda: mckibben.VectorPlant(scenario, count)]:
        with pytest.raises(mckibben.InputError, match="count = "):
            made()


def test_more_threads_than_can_be_started_are_refused(swing, tmp_path):
    swept = swing.with_values({"sweep.vary": {"load.mass": ["5 lb", "6 lb"]}, "run.duration": "1 ms"})
    with pytest.raises(mckibben.InputError, match="1000000000 jobs"):
        mckibben.sweep(swept, tmp_path, jobs=10**9)


# --- numbers --------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("wrong", NOT_FINITE)
def test_a_number_that_is_none_is_refused_by_its_argument(wrong, scenario):
    actuator = mckibben.Actuator(scenario)
    state = actuator.start()
    right = {"length": 0.09, "velocity": 0.0, "command": 0.5, "dt": STEP, "max_step": None}
    for name in right:
        with pytest.raises(mckibben.InputError, match=rf"{name} = -?(NaN|inf)"):
            actuator.step(state, **right | {name: wrong})
    with pytest.raises(mckibben.InputError, match="velocity = "):
        actuator.respond(state, wrong)
    with pytest.raises(mckibben.InputError, match="gauge_pressure = "):
        actuator.rest_length(wrong)
    for counted in [(), (2,)]:
        kind = mckibben.Actuators if counted else mckibben.Actuator
        with pytest.raises(mckibben.InputError, match="pulse_frequency = "):
            kind(scenario, *counted, pulse_frequency=wrong)
    with pytest.raises(mckibben.InputError, match="pulse_frequency = "):
        mckibben.VectorPlant(scenario, 2, pulse_frequency=wrong)
    with pytest.raises(mckibben.InputError, match="duty"):
        mckibben.linearize(scenario, duty=wrong)


@pytest.mark.parametrize("velocity", [1e300, -1e300, 2e6])
def test_a_velocity_beyond_all_physics_gives_no_answer(velocity, scenario):
    actuator = mckibben.Actuator(scenario)
    with pytest.raises(mckibben.InputError, match="(?s)velocity = .* between -1e6 and 1e6"):
        actuator.step(actuator.start(), 0.09, velocity, 0.5, STEP)
    assert all(math.isfinite(number) for number in actuator.respond(actuator.start(), math.copysign(1e6, velocity)).__getnewargs__())


@pytest.mark.parametrize("wrong", NOT_FINITE)
@pytest.mark.parametrize("count", [4, 300])
@pytest.mark.parametrize("name", ["length", "velocity", "command"])
def test_an_element_that_is_no_number_is_refused_by_its_place(name, count, wrong, scenario):
    many, given = mckibben.Actuators(scenario, count), arrays(count)
    given[name][2] = wrong
    with pytest.raises(mckibben.InputError, match=rf"{name}\[2\] = -?(NaN|inf)"):
        many.step(dt=STEP, **given)
    assert (given["tension"] == -1.0).all()
    before = many.__getstate__()
    with pytest.raises(mckibben.InputError):
        many.step(dt=wrong, **arrays(count))
    with pytest.raises(mckibben.InputError, match="max_step"):
        many.step(dt=STEP, **arrays(count), max_step=wrong)
    numpy.testing.assert_array_equal(many.__getstate__(), before)


@pytest.mark.parametrize("wrong", NOT_FINITE)
def test_plants_refuse_numbers_that_are_none_by_their_place(wrong, scenario):
    plants = mckibben.VectorPlant(scenario, 3, parameters=["load.mass", "initial.temperature"])
    shown, stopped, duties = numpy.zeros((3, len(plants.columns))), numpy.zeros(3, dtype=bool), numpy.full((3, 1), 0.5)
    duties[2, 0] = wrong
    with pytest.raises(mckibben.InputError, match=r"actions\[2, 0\] = -?(NaN|inf)"):
        plants.step(duties, STEP, shown, stopped)
    duties[2, 0] = 0.5
    with pytest.raises(mckibben.InputError, match="dt = "):
        plants.step(duties, wrong, shown, stopped)
    values = numpy.tile(plants.defaults, (3, 1))
    values[1, 1] = wrong
    with pytest.raises(mckibben.InputError, match=r"values\[1, 1\] = -?(NaN|inf)"):
        plants.start(values)
    with pytest.raises(mckibben.InputError, match=r"values\[1, 1\] = -?(NaN|inf)"):
        plants.restart(numpy.array([0, 2]), values[:2])
    plants.step(duties, STEP, shown, stopped)
    assert numpy.isfinite(shown).all() and not stopped.any()


@pytest.mark.parametrize("wrong", NOT_FINITE)
def test_functions_of_numbers_refuse_those_that_are_none(wrong, swing):
    of = mckibben.Differentiable(swing, ["load.mass", "initial.temperature"], ["length"], [0.1])
    for call in [of, of.value_and_jacobian]:
        with pytest.raises(mckibben.InputError, match=r"values\[1\] \(initial.temperature\) = "):
            call([2.0, wrong])
    with pytest.raises(mckibben.InputError, match=r"times\[1\] = "):
        mckibben.Differentiable(swing, ["load.mass"], ["length"], [0.1, wrong])
    with pytest.raises(mckibben.InputError, match=r"times\[1\] = "):
        mckibben.simulate(swing).at_times([0.0, wrong])


# --- steps that would never end -------------------------------------------------------------------------------------


def test_a_step_without_end_is_refused_with_what_it_would_take(scenario):
    fast = mckibben.Actuator(scenario, pulse_frequency=1e300)
    with pytest.raises(mckibben.InputError, match=r"dt = 0.001 s would be divided into 2\.000e297 parts.*more than 1e7"):
        fast.step(fast.start(), 0.09, 0.0, 0.5, STEP)
    state, _, _ = fast.step(fast.start(), 0.09, 0.0, None, 1.0)
    with pytest.raises(mckibben.InputError, match="parts"):
        fast.step(state, 0.09, 0.0, 0.5, STEP)
    with pytest.raises(mckibben.InputError, match="parts"):
        mckibben.Actuators(scenario, 2, pulse_frequency=1e300).step(dt=STEP, **arrays(2))
    slow = mckibben.Actuator(scenario)
    with pytest.raises(mckibben.InputError, match="parts"):
        slow.step(slow.start(), 0.09, 0.0, 0.5, 1e300)
    with pytest.raises(mckibben.InputError, match="parts"):
        slow.step(slow.start(), 0.09, 0.0, None, STEP, max_step=1e-300)
    with pytest.raises(mckibben.InputError, match="parts"):
        mckibben.Actuators(scenario, 2).step(dt=STEP, **arrays(2), max_step=1e-300)
    for frequency, dt in [(1e300, STEP), (25.0, 1e300)]:
        plants = mckibben.VectorPlant(scenario, 2, pulse_frequency=frequency)
        shown, stopped = numpy.zeros((2, len(plants.columns))), numpy.zeros(2, dtype=bool)
        with pytest.raises(mckibben.InputError, match="steps and edges of pulses"):
            plants.step(numpy.full((2, 1), 0.5), dt, shown, stopped)
    state, _, _ = slow.step(slow.start(), 0.09, 0.0, None, 1.0)
    with pytest.raises(mckibben.InputError, match="lost in the rounding of the 1"):
        slow.step(state, 0.09, 0.0, None, 1e-20)


# --- states of other actuators, arrays in use -----------------------------------------------------------------------


def test_a_state_of_another_actuator_is_refused(scenario, examples):
    actuator = mckibben.Actuator(scenario)
    others = [scenario.with_values({"actuator.turns": 2.2}), scenario.with_values({"valve.opening_delay": "3 ms"}),
              *(mckibben.Scenario.from_file(examples / f"{name}.toml") for name in ["line/hanging-mass", "friction/maxwell-slip"])]
    for other in others:
        state = mckibben.Actuator(other, pulse_frequency=25.0).start()
        for use in [lambda: actuator.step(state, 0.09, 0.0, None, STEP), lambda: actuator.respond(state)]:
            with pytest.raises(mckibben.InputError, match="`state` is of another actuator"):
                use()
        many = mckibben.Actuators(other, 2, pulse_frequency=25.0)
        with pytest.raises(mckibben.InputError, match="of another actuator"):
            mckibben.Actuators(scenario, 2).__setstate__(many.__getstate__())
    with pytest.raises(mckibben.InputError, match="of another actuator"):
        actuator.step(mckibben.Actuator(scenario, pulse_frequency=50.0).start(), 0.09, 0.0, None, STEP)
    # What does not belong to the actuator may differ.
    same = scenario.with_values({"load.mass": "9 lb", "run.duration": "1 s", "initial.gauge_pressure": "20 psi"})
    state = mckibben.Actuator(same).start()
    assert actuator.step(state, 0.09, 0.0, 0.5, STEP)[0] == mckibben.Actuator(same).step(state, 0.09, 0.0, 0.5, STEP)[0]


def test_arrays_that_share_memory_are_refused_by_name(scenario):
    many, given = mckibben.Actuators(scenario, 4), arrays(4)
    for name, aliased in [("tension", "length"), ("tension", "velocity"), ("tension", "command")]:
        with pytest.raises(mckibben.InputError, match=f"`{name}` shares memory with another argument"):
            many.step(dt=STEP, **given | {name: given[aliased]})
    with pytest.raises(mckibben.InputError, match="`absolute_pressure` shares memory"):
        many.step(dt=STEP, **given, absolute_pressure=given["tension"])
    given["tension"].setflags(write=False)
    with pytest.raises(mckibben.InputError, match="`tension` cannot be written to"):
        many.step(dt=STEP, **given)
    plants = mckibben.VectorPlant(scenario, 4, action_mode="duty")
    shown, stopped = numpy.zeros((4, len(plants.columns))), numpy.zeros(4, dtype=bool)
    with pytest.raises(mckibben.InputError, match="`observations` shares memory"):
        plants.step(shown.ravel()[:4].reshape(4, 1), STEP, shown, stopped)


def test_arrays_of_another_kind_are_refused_by_name(scenario):
    many, given = mckibben.Actuators(scenario, 4), arrays(4)
    for wrong, words in [(numpy.zeros(4, dtype="f4"), "an array of float32 with 1 dim"), ([0.0] * 4, "of type list"),
                         (numpy.zeros((2, 2)), "an array of float64 with 2 dim"), (None, "of type NoneType")]:
        with pytest.raises(TypeError, match=f"`velocity` is {words}.*give a NumPy array of float64 with 1 dim"):
            many.step(dt=STEP, **given | {"velocity": wrong})


def test_what_another_thread_is_stepping_is_refused(scenario):
    """A step of very many parts in one thread, while another reads its state for as long as that takes."""
    many = mckibben.Actuators(scenario, 2)
    fine = scenario.with_values({"run.engine": "fixed-step", "run.step": "5 us"})
    plants = mckibben.VectorPlant(fine, 2)
    shown, stopped = numpy.zeros((2, len(plants.columns))), numpy.zeros(2, dtype=bool)
    hosted, ends = mckibben.HostedPlant(scenario, max_step=5e-6), numpy.full((1, 1), 0.09)
    hosted.begin(ends, numpy.zeros((1, 1)))
    for step, other, name in [
        (lambda: many.step(dt=1.0, **arrays(2), max_step=5e-6), many.reset, "Actuators"),
        (lambda: plants.step(numpy.full((2, 1), 0.5), 1.0, shown, stopped), plants.start, "VectorPlant"),
        (lambda: hosted.step(ends, numpy.full((1, 1), 0.5), 1.0), hosted.observe, "HostedPlant"),
        (lambda: hosted.step(ends, numpy.full((1, 1), 0.5), 1.0), lambda: hosted.time, "HostedPlant"),
    ]:
        refused = []
        with concurrent.futures.ThreadPoolExecutor(1) as pool:
            run = pool.submit(step)
            while not run.done():
                try:
                    other()
                except mckibben.InputError as error:
                    refused.append(str(error))
            run.result()
        busy = f"these {name} are" if name.endswith("s") else f"this {name} is"
        assert refused and all(f"{busy} being stepped by another thread" in words for words in refused)
        other()


# --- layouts in memory ----------------------------------------------------------------------------------------------


def layouts(table: numpy.ndarray) -> list[numpy.ndarray]:
    """A table with the rows of a C-contiguous one, lying in memory in other ways."""
    made = [numpy.asfortranarray(table), numpy.ascontiguousarray(table.T).T, numpy.repeat(table, 2, axis=1)[:, ::2],
            numpy.ascontiguousarray(table[::-1])[::-1]]
    assert not any(of.flags.c_contiguous for of in made)
    return made


def test_values_of_actuators_may_have_any_layout(scenario):
    values = numpy.array([[2.4, 1e5], [2.5, 2e5], [2.6, 3e5]])
    made = functools.partial(mckibben.Actuators, scenario, 3, parameters=["actuator.turns", "initial.gauge_pressure"])

    def tensions(many: mckibben.Actuators) -> numpy.ndarray:
        given = arrays(3)
        many.step(dt=STEP, **given)
        return given["tension"]

    expected = tensions(made(values=values))
    assert len(set(expected)) == 3
    for other in layouts(values):
        many = made(values=other)
        numpy.testing.assert_array_equal(many.__getnewargs_ex__()[1]["values"], values)
        numpy.testing.assert_array_equal(tensions(many), expected)
    with pytest.raises(mckibben.InputError, match=r"values of shape \(2, 3\) are given for 3 actuators"):
        made(values=values.T)
    states = made(values=values).__getstate__()
    restored = made(values=values)
    for other in layouts(states):
        restored.__setstate__(other)
        numpy.testing.assert_array_equal(restored.__getstate__(), states)


def test_values_of_instances_may_have_any_layout(scenario):
    values = numpy.array([[2.0, 1e5], [2.5, 2e5], [3.0, 3e5]])
    made = functools.partial(mckibben.VectorPlant, scenario, 3, parameters=["load.mass", "initial.gauge_pressure"])
    plants, rows = made(), numpy.array([2, 0, 1])

    def observed() -> numpy.ndarray:
        shown, stopped = numpy.zeros((3, len(plants.columns))), numpy.zeros(3, dtype=bool)
        plants.step(numpy.full((3, 1), 0.5), 0.02, shown, stopped)
        return shown

    plants.start(values)
    started = observed()
    plants.start(values)
    plants.restart(rows, values)
    restarted = observed()
    assert len({row.tobytes() for row in started}) == 3 and (started != restarted).any()
    for other in layouts(values):
        plants.start(other)
        numpy.testing.assert_array_equal(observed(), started)
        plants.start(values)
        plants.restart(numpy.repeat(rows, 2)[::2], other)
        numpy.testing.assert_array_equal(observed(), restarted)
    for call in (plants.start, lambda of: plants.restart(rows, of)):
        with pytest.raises(mckibben.InputError, match=r"(?s)values of shape \(2, 3\) are given for 3.*shape \(3, 2\)"):
            call(values.T)


def test_tables_used_in_place_must_be_c_contiguous(examples):
    leg = mckibben.Scenario.from_file(examples / "plant" / "leg.toml").with_values({"run.step": "1 ms"})
    plants = mckibben.VectorPlant(leg, 2, action_mode="set-point")
    width = len(plants.columns)
    shown, stopped = numpy.full((2, width), -1.0), numpy.zeros(2, dtype=bool)
    actions = 1e5 + 1e4 * numpy.arange(2.0 * plants.valves).reshape(2, -1)
    for other in layouts(actions):
        with pytest.raises(mckibben.InputError, match=r"(?s)`actions` is not C-contiguous.*numpy.ascontiguousarray\(actions\)"):
            plants.step(other, 0.01, shown, stopped)
    for other in layouts(shown):
        with pytest.raises(mckibben.InputError, match="(?s)`observations` is not C-contiguous.*numpy.ascontiguousarray"):
            plants.step(actions, 0.01, other, stopped)
        with pytest.raises(mckibben.InputError, match="`observations` is not C-contiguous"):
            plants.observe(numpy.arange(2), other)
        assert (other == -1.0).all()
    for wrong in (actions.reshape(-1, 2), actions.reshape(1, -1)):
        with pytest.raises(mckibben.InputError, match=rf"actions is of another shape, \({wrong.shape[0]}, {wrong.shape[1]}\)"):
            plants.step(wrong, 0.01, shown, stopped)
    assert (shown == -1.0).all() and (plants.time == 0.0).all()


def test_tables_of_a_hosted_plant_must_be_c_contiguous(examples):
    arm = mckibben.Scenario.from_file(examples / "plant" / "arm.toml")
    plants = mckibben.HostedPlant(arm, 2, command_mode="request")
    distances, commands = plants.distances.copy(), numpy.ones((2, len(plants.commands)))
    distances[1] -= 1e-3
    still = numpy.zeros_like(distances)
    for other in layouts(distances):
        for call in (lambda of: plants.begin(of, still), lambda of: plants.compute(of, still),
                     lambda of: plants.step(of, commands, STEP)):
            with pytest.raises(mckibben.InputError, match="`distances` is not C-contiguous"):
                call(other)
    for other in layouts(commands):
        with pytest.raises(mckibben.InputError, match="`commands` is not C-contiguous"):
            plants.step(distances, other, STEP)
    assert plants.time == 0.0
    plants.begin(distances, still)
    states = plants.save()
    for other in layouts(states):
        plants.step(distances, commands, STEP)
        plants.restore(other)
        numpy.testing.assert_array_equal(plants.save(), states)


def test_an_array_at_odd_addresses_is_refused(scenario):
    odd = numpy.frombuffer(bytearray(8 * 6 + 1), dtype=numpy.float64, offset=1).reshape(3, 2)
    assert odd.flags.c_contiguous and not odd.flags.aligned
    odd[...] = [[2.0, 1e5], [2.5, 2e5], [3.0, 3e5]]
    plants = mckibben.VectorPlant(scenario, 3, parameters=["load.mass", "initial.gauge_pressure"])
    with pytest.raises(mckibben.InputError, match=r"(?s)`values` is not aligned.*values.copy\(\)"):
        plants.start(odd)
    plants.start(odd.copy())


def test_a_number_counts_as_one_time(swing):
    run = mckibben.simulate(swing)
    numpy.testing.assert_array_equal(run.at_times(0.01)["length_m"], run.at_times([0.01])["length_m"])
    with pytest.raises(TypeError, match="2 dimensions"):
        run.at_times(numpy.zeros((1, 2)))


# --- words ----------------------------------------------------------------------------------------------------------


def test_a_length_out_of_reach_is_said_in_lengths(scenario):
    actuator, many = mckibben.Actuator(scenario), mckibben.Actuators(scenario, 3)
    words = r"length(\[1\])? = 0\.2 m is longer than its thread of 109\.8 mm"
    with pytest.raises(mckibben.SimulationError, match=words) as raised:
        actuator.step(actuator.start(), 0.2, 0.0, 0.5, STEP)
    given = arrays(3)
    given["length"][1] = 0.2
    with pytest.raises(mckibben.SimulationError, match=f"actuator 1: {words}") as of_many:
        many.step(dt=STEP, **given)
    for error in [raised, of_many]:
        assert "run.step" not in str(error.value) and "move_to" not in str(error.value)
    for length in [0.0, -0.1]:
        with pytest.raises(mckibben.InputError, match="(?s)length = .* above zero"):
            actuator.step(actuator.start(), length, 0.0, 0.5, STEP)


def refusals(scenario: mckibben.Scenario, examples: pathlib.Path) -> list[typing.Callable[[], object]]:
    """Mistakes in arguments, of each function that says something of them in the program's words."""
    joint = mckibben.Scenario.from_file(examples / "antagonistic-joint.toml")
    force = scenario.with_values({"load": {"kind": "constant-force", "mass": "1 kg", "force": "10 N"}})
    held = scenario.with_values({"load": {"kind": "isometric"}, "initial.length": "85 mm"})
    linearize, actuator = mckibben.linearize, mckibben.Actuator(scenario)
    plants = mckibben.VectorPlant(scenario, 2, parameters=["load.mass"])
    shown, stopped = numpy.zeros((2, len(plants.columns))), numpy.zeros(2, dtype=bool)
    of = mckibben.Differentiable(scenario, ["load.mass", "command.duty"], ["length"], [0.1])
    return [
        lambda: linearize(scenario, gauge_pressure="60 mm"),
        lambda: linearize(scenario, gauge_pressure="1 bar", duty=0.5),
        lambda: linearize(scenario, duty=0.5, pwm=True),
        lambda: linearize(scenario, angle="3 deg"),
        lambda: linearize(scenario, angle="3 deg", stiffness="1 N*m/rad"),
        lambda: linearize(held, amplitude="1 mm"),
        lambda: linearize(scenario, gauge_pressure="1 bar", length="85 mm", load="2 kg"),
        lambda: linearize(force, load="2 kg"),
        lambda: linearize(held, load="2 kg"),
        lambda: linearize(joint, gauge_pressure="2 bar"),
        lambda: linearize(joint, amplitude="1 mm"),
        lambda: mckibben.curves(scenario, "-3 bar"),
        lambda: mckibben.curves(scenario, "3 mm"),
        lambda: mckibben.identify("nothing.toml"),
        lambda: mckibben.Sweep(scenario),
        lambda: mckibben.simulate(scenario.with_values({"run.engine": "fixed-step", "run.duration": "1 ms"})).at(2.0),
        lambda: mckibben.simulate(scenario.with_values({"run.duration": "1 ms"})).to_csv("nowhere/at/all.csv"),
        lambda: mckibben.simulate(scenario.with_values({"run.duration": "1 ms"})).to_svg("mass"),
        lambda: actuator.step(actuator.start(), 0.09, 0.0, 1.5, STEP),
        lambda: actuator.step(actuator.start(), 0.09, 0.0, "hold", STEP),
        lambda: actuator.step(actuator.start(), 0.09, 0.0, 0.5, 0.0),
        lambda: actuator.step(actuator.start(), 0.2, 0.0, 0.5, STEP),
        lambda: actuator.rest_length(-3e5),
        lambda: plants.start(numpy.array([[1.0], [-1.0]])),
        lambda: plants.step(numpy.array([[0.5], [1.5]]), STEP, shown, stopped),
        lambda: of([-1.0, 0.5]),
        lambda: of.value_and_jacobian([1.0, 1.5]),
    ]


def test_errors_speak_of_what_the_caller_can_do_in_python(scenario, examples, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    said = []
    for number, call in enumerate(refusals(scenario, examples)):
        with pytest.raises(mckibben.Error) as raised:
            call()
            pytest.fail(f"call {number} was not refused")
        said.append(str(raised.value))
    for words in said:
        assert not re.search(r"(^|[\s'`\"(])--[a-z]|move_to|<[A-Z]+>|mckibben \w+ --help", words), words
        # Nothing of these came from a line of the scenario.
        assert " --> " not in words and "^^^" not in words, words
    for words, named in [(said[0], "`gauge_pressure`"), (said[3], "`stiffness`"), (said[-4], "plant 1"), (said[-3], "plant 1"),
                         (said[-2], "load.mass = -1")]:
        assert named in words, words


def test_flags_that_a_caller_wrote_stay_as_they_are(tmp_path):
    """What stands in quotation marks of the caller's own, such as the name of a file, is not taken for an option."""
    for name in ["my--output.toml", "a --set b.toml"]:
        with pytest.raises(mckibben.InputError, match="cannot be read") as raised:
            mckibben.Scenario.from_file(tmp_path / name)
        assert str(tmp_path / name) in str(raised.value)


def test_a_folder_that_is_of_no_sweep_is_named(swing, tmp_path):
    swept = swing.with_values({"sweep.vary": {"load.mass": ["5 lb", "6 lb"]}, "run.duration": "1 ms"})
    (tmp_path / "something.txt").write_text("mine")
    with pytest.raises(mckibben.InputError, match="no folder of a sweep: it holds `something.txt`") as raised:
        mckibben.sweep(swept, tmp_path)
    assert str(tmp_path) in str(raised.value) and "--" not in str(raised.value).replace(str(tmp_path), "")


# --- collections ----------------------------------------------------------------------------------------------------


def test_a_run_is_a_collection_of_its_columns(swing, examples):
    run = mckibben.simulate(swing)
    assert list(run) == run.keys() == run.columns
    assert {name: id(column) for name, column in dict(run).items()} == {name: id(run[name]) for name in run.columns}
    assert "length_m" in run and "hose_absolute_pressure_pa" not in run and 3 not in run
    assert len(run) == len(run.t)
    with pytest.raises(TypeError, match="columns have names.*length_m"):
        run[0]  # type: ignore[index]
    found = mckibben.identify(examples / "identify/tank.toml")
    assert list(found) == list(found.keys()) == [estimate.name for estimate in found.estimates]
    assert dict(found) == {estimate.name: estimate for estimate in found.estimates}


def test_what_holds_after_an_event_has_types(swing, examples):
    run = mckibben.simulate(swing)
    clamped = [event.after["tension_clamped"] for event in run.events]
    assert clamped and all(type(value) is bool for value in clamped)
    thrown = swing.with_values({"initial.velocity": "-3 m/s", "run.duration": "0.3 s"})
    assert {event.after["tension_clamped"] for event in mckibben.simulate(thrown).events} == {False, True}
    words = {name: value for name, value in run.events[0].after.items() if name != "tension_clamped"}
    assert words and all(type(value) is str for value in words.values())
    event = mckibben.Event(1.0, ["event", "a", "b", "c", "d"], ["stick", "-2.5e-3", "infinite", "true", ""])
    assert event.after == {"a": -2.5e-3, "b": "infinite", "c": True, "d": ""}

# --- parameters -----------------------------------------------------------------------------------------------------


def test_one_text_is_no_list_of_parameters(scenario, swing):
    for made in [
        lambda: mckibben.VectorPlant(scenario, 2, parameters="load.mass"),  # type: ignore[arg-type]
        lambda: mckibben.Actuators(scenario, 2, parameters="load.mass"),  # type: ignore[arg-type]
        lambda: mckibben.Differentiable(swing, "load.mass", ["length"], [0.1]),  # type: ignore[arg-type]
    ]:
        with pytest.raises(TypeError, match=r"^`parameters`: a list is wanted and no str; give \['load.mass'\]"):
            made()
    with pytest.raises(TypeError, match="^`quantities`: a list is wanted and no str"):
        mckibben.Differentiable(swing, ["load.mass"], "length", [0.1])  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="^`columns`: a list is wanted and no str"):
        mckibben.simulate(swing).plot("length_m")  # type: ignore[arg-type]


def test_a_parameter_that_is_named_twice_is_refused(scenario, swing):
    twice = ["load.mass", "actuator.turns", "load.mass"]
    with pytest.raises(mckibben.InputError, match="`parameters` names `load.mass` twice"):
        mckibben.VectorPlant(scenario, 2, parameters=twice, action_mode="request")
    with pytest.raises(mckibben.InputError, match="`parameters` names `load.mass` twice"):
        mckibben.Actuators(scenario, 2, parameters=twice, values=numpy.zeros((2, 3)))
    with pytest.raises(mckibben.InputError, match="`parameters` names `load.mass` twice"):
        mckibben.Differentiable(swing, twice, ["length"], [0.1])
    with pytest.raises(mckibben.InputError, match=r"`parameters` names `a\[01\]` twice, also as `a\[1\]`"):
        mckibben.VectorPlant(scenario, 2, parameters=["a[1]", "a[01]"], action_mode="request")


def test_parameters_that_change_nothing_are_refused(scenario, swing):
    for path in ("run.step", "run.duration", "command.duty"):
        driven = scenario.with_values({"run.step": "0.5 ms"})
        with pytest.raises(mckibben.InputError, match=f"`{path}`"):
            mckibben.VectorPlant(driven, 2, parameters=[path], action_mode="request")
        with pytest.raises(mckibben.InputError, match=f"`{path}` changes nothing of these actuators"):
            mckibben.Actuators(driven, 2, parameters=[path], values=numpy.ones((2, 1)))
    with pytest.raises(mckibben.InputError, match="`run.duration` changes nothing of this plant"):
        mckibben.VectorPlant(scenario, 2, parameters=["run.duration"], action_mode="request")
    with pytest.raises(mckibben.InputError, match="`run.duration` changes nothing"):
        mckibben.Differentiable(swing, ["run.duration"], ["length"], [0.1])
    for given, name in [([[], ["length"], [0.1]], "parameters"), ([["load.mass"], [], [0.1]], "quantities"),
                        ([["load.mass"], ["length"], []], "times")]:
        with pytest.raises(mckibben.InputError, match=f"`{name}` is empty"):
            mckibben.Differentiable(swing, *given)


def test_numbers_of_another_shape_are_refused_by_their_argument(swing):
    run = mckibben.simulate(swing)
    with pytest.raises(TypeError, match="`time` is one number, and of type ndarray here; `at_times` takes several"):
        run.at(numpy.array([0.01, 0.02]))  # type: ignore[arg-type]
    of = mckibben.Differentiable(swing, ["load.mass"], ["length"], [0.1])
    for wrong, words in [(numpy.zeros((2, 2)), "an array with 2 dimensions"), (None, "None; give a number")]:
        with pytest.raises(TypeError, match=f"`values` is {words}"):
            of(wrong)  # type: ignore[arg-type]
        with pytest.raises(TypeError, match=f"`times` is {words}"):
            mckibben.Differentiable(swing, ["load.mass"], ["length"], wrong)  # type: ignore[arg-type]


def test_a_load_that_is_no_force_is_refused_by_its_argument(swing):
    with pytest.raises(mckibben.InputError, match="`load` = -5 N"):
        mckibben.linearize(swing, load=-5.0)


# --- kinds of arguments ---------------------------------------------------------------------------------------------


def test_what_is_no_number_is_refused_by_its_argument(scenario):
    muscle = mckibben.Actuator(scenario)
    state, statics = muscle.start(), mckibben.Statics(scenario)
    right = {"length": 0.09, "velocity": 0.0, "command": 0.5, "dt": STEP}
    for name in right:
        for wrong in ([0.1], True, numpy.bool_(True)) if name == "command" else ([0.1], None, True, numpy.bool_(True)):
            with pytest.raises(TypeError, match=f"`{name}` is of type"):
                muscle.step(state, **right | {name: wrong})
        with pytest.raises(mckibben.InputError, match=f"{name}"):
            muscle.step(state, **right | {name: "5 parsec"})
    for wrong in (None, ["80 mm"], True, [True, False]):
        with pytest.raises(TypeError, match="`length` is"):
            statics.force(wrong, 2e5)
        with pytest.raises(TypeError, match="`gauge_pressure` is"):
            statics.force(0.08, wrong)
    for wrong in ("x", "5 parsec", "2"):
        with pytest.raises(mckibben.InputError, match="`length`: "):
            statics.force(wrong, 2e5)
        with pytest.raises(mckibben.InputError, match="`force`: "):
            statics.length_for(2e5, wrong)
    for wrong in (True, [1]):
        with pytest.raises(TypeError, match="`gauge_pressure` is of type"):
            mckibben.linearize(scenario, gauge_pressure=wrong)


def test_what_is_no_number_is_none_in_lists_either(scenario, swing):
    """Truth values would count as 0 or 1, texts of digits as their number, and what a mask hides as what lies behind it."""
    run, model = mckibben.simulate(swing), mckibben.linearize(swing)
    of = mckibben.Differentiable(swing, ["load.mass"], ["length"], [0.1])
    muscle = mckibben.Actuator(scenario)
    step, plants = mckibben.DifferentiableStep(muscle, STEP), mckibben.VectorPlant(scenario, 1, parameters=["load.mass"])
    inputs = step.pack(muscle.start(), 0.09, 0.0, 0.5)
    outputs = step(inputs)
    uses: list[tuple[str, typing.Any, typing.Any]] = [
        ("times", run.at_times, [0.05]),
        ("times", lambda given: mckibben.Differentiable(swing, ["load.mass"], ["length"], given), [0.1]),
        ("values", of, [2.0]),
        ("values", of.value_and_jacobian, [2.0]),
        ("values", step, inputs),
        ("values", step.value_and_jacobian, inputs),
        ("outputs", step.unpack, outputs),
        ("one", lambda given: plants.differ(given, [3.0]), [2.0]),
        ("other", lambda given: plants.differ([3.0], given), [2.0]),
        ("omega", model.response, [1.0]),
        ("gauge_pressures", lambda given: mckibben.curves(scenario, given), [1e5]),
    ]
    for name, use, right in uses:
        use(right)
        use(numpy.ma.array(right, mask=False))
        for wrong in (True, [True, *right[1:]], ["1", *map(str, right[1:])], ["1 kg"], [None], numpy.ones(len(right), dtype=bool)):
            with pytest.raises(TypeError, match=f"`{name}` "):
                use(wrong)
        with pytest.raises(mckibben.InputError, match=f"`{name}` is a masked array whose mask hides entries"):
            use(numpy.ma.array(right, mask=[True] + [False] * (len(right) - 1)))


def test_a_whole_number_beyond_every_float_is_refused_by_its_key(swing):
    with pytest.raises(mckibben.InputError, match="`load.mass` = 10000000… .401 digits. is larger than any number"):
        swing.with_values({"load.mass": 10**400})


def test_quantities_may_be_text_with_a_unit(scenario):
    muscle = mckibben.Actuator(scenario, pulse_frequency="25 Hz")
    state, statics = muscle.start(), mckibben.Statics(scenario)
    _, tension, _ = muscle.step(state, 0.085, 0.01, 0.4, 1e-3, max_step=5e-4)
    assert muscle.step(state, "85 mm", "1 cm/s", "40 %", "1 ms", max_step="0.5 ms")[1] == tension
    assert muscle.rest_length("2 bar") == muscle.rest_length(2e5)
    assert statics.force("80 mm", "2 bar") == statics.force(0.08, 2e5) and statics.volume("80 mm") == statics.volume(0.08)
    assert statics.length_for("2 bar", "20 N") == statics.length_for(2e5, 20.0)
    assert statics.gauge_pressure_for(0.08, 20.0, max_gauge_pressure="4 bar") == statics.gauge_pressure_for(
        0.08, 20.0, max_gauge_pressure=4e5
    )
    step, same = mckibben.DifferentiableStep(muscle, "1 ms"), mckibben.DifferentiableStep(muscle, 1e-3)
    numpy.testing.assert_array_equal(step(step.pack(state, "85 mm", 0.0, "40 %")), same(same.pack(state, 0.085, 0.0, 0.4)))
    model, other = mckibben.linearize(scenario, duty="40 %"), mckibben.linearize(scenario, duty=0.4)
    numpy.testing.assert_array_equal(model.A, other.A)
    with pytest.raises(mckibben.InputError, match="command = \"slowly\" is no command"):
        muscle.step(state, 0.085, 0.0, "slowly", STEP)


def test_what_is_no_scenario_is_refused_with_the_way_to_read_a_file(scenario):
    for call in [mckibben.simulate, mckibben.linearize, mckibben.Statics, mckibben.curves, mckibben.Actuator, mckibben.HostedPlant,
                 mckibben.sweep, mckibben.Sweep]:
        with pytest.raises(TypeError, match=r"`scenario` is of type str; give mckibben.Scenario.from_file\(.x.toml.\)"):
            call("x.toml")
    with pytest.raises(TypeError, match="`scenario` is of type int"):
        mckibben.VectorPlant(5, 1)


def test_arguments_of_a_sweep_are_refused_by_name(scenario):
    of = functools.partial(mckibben.sweep, scenario, vary={"load.mass": [2.0]}, reductions=["length.final"])
    for wrong, words in [({"jobs": 0}, "`jobs` = 0"), ({"jobs": True}, "`jobs` = True"), ({"executor": 5}, "`executor` is of type int"),
                         ({"vary": 5}, "`vary` is of type int")]:
        with pytest.raises(mckibben.InputError, match=words):
            of(**wrong)


def test_entries_that_a_mask_hides_are_refused(scenario):
    many, given = mckibben.Actuators(scenario, 4), arrays(4)
    hidden = numpy.ma.masked_array(given["length"], [False, True, False, False])
    with pytest.raises(mckibben.InputError, match="`length` is a masked array whose mask hides entries"):
        many.step(dt=STEP, **given | {"length": hidden})
    many.step(dt=STEP, **given | {"length": numpy.ma.masked_array(given["length"])})


def test_a_figure_that_a_run_does_not_have_is_named(swing):
    with pytest.raises(KeyError, match="there is no `foo` but length.final, "):
        mckibben.simulate(swing).summary()["foo"]
    with pytest.raises(KeyError, match="there is no `foo` but "):
        swing.settle()["foo"]


def test_very_many_times_are_read_in_parts(swing):
    run = mckibben.simulate(swing)
    times = numpy.linspace(0.0, 0.1, 120_001)
    many = run.at_times(times)
    for place in (0, 49_999, 50_000, 100_000, 120_000):
        assert {name: values[place] for name, values in many.items()} == run.at(times[place])
    assert len(run.at_times([])["length_m"]) == 0


def test_progress_is_a_function(swing, tmp_path):
    """It is refused before the work, also where that would be done before `progress` is called."""
    for call in [
        lambda: mckibben.simulate(swing, progress=3),  # type: ignore[arg-type]
        lambda: mckibben.sweep(swing, tmp_path / "runs", vary={"load.mass": [2.0]}, reductions=["length.final"], progress=3),
        lambda: mckibben.design(swing, {"load.mass": (2.0, 3.0)}, minimize="length.final", progress=3),  # type: ignore[arg-type]
    ]:
        with pytest.raises(TypeError, match="progress.*give a function|a function is wanted, such as print, and no int"):
            call()
    assert not (tmp_path / "runs").exists()


def test_a_truth_value_is_no_count(scenario):
    for call in [
        lambda: mckibben.Actuators(scenario, True),
        lambda: mckibben.HostedPlant(scenario, True),
        lambda: mckibben.VectorPlant(scenario, True),
    ]:
        with pytest.raises(mckibben.InputError, match="count = True"):
            call()


def test_what_cannot_act_in_a_start_or_load_is_refused(scenario, examples):
    """An isometric load does not move, so that its start has no velocity."""
    held = mckibben.Scenario.from_file(examples / "line/waves.toml").with_values({"run.engine": "fixed-step", "run.step": "0.5 ms"})
    with pytest.raises(mckibben.InputError, match="`initial.velocity` changes nothing of this plant"):
        mckibben.VectorPlant(held, 1, parameters=["initial.gauge_pressure", "initial.velocity"], action_mode="request")
    moves = mckibben.VectorPlant(scenario, 1, parameters=["initial.velocity"])
    assert moves.defaults == [0.0]


def test_several_actuators_are_sent_to_what_takes_them(examples):
    arm = mckibben.Scenario.from_file(examples / "plant/arm.toml")
    for call in [
        lambda: mckibben.Actuator(arm),
        lambda: mckibben.Actuators(arm, 2),
        lambda: mckibben.Differentiable(arm, ["load.mass"], ["length"], [0.0]),
    ]:
        with pytest.raises(mckibben.InputError, match="`HostedPlant`, `VectorPlant`"):
            call()


def test_a_value_and_a_valve_are_named_by_their_part(examples):
    """Of actuators with names: a value by its path, and a command by the actuator of its valve."""
    leg = mckibben.Scenario.from_file(examples / "plant/leg.toml").with_values({"run.step": "1 ms"})
    plants = mckibben.VectorPlant(leg, 2, parameters=["mechanism.joints.knee.mass"], action_mode="set-point")
    with pytest.raises(mckibben.InputError, match="plant 1: mechanism.joints.knee.mass = -1 kg is outside"):
        plants.restart(numpy.array([1]), numpy.array([[-1.0]]))
    shown, stopped = numpy.zeros((2, len(plants.columns))), numpy.zeros(2, dtype=bool)
    actions = numpy.zeros((2, plants.valves))
    actions[1, 2] = -1e9
    name = list(leg.actuators)[2]
    with pytest.raises(mckibben.InputError, match=f"plant 1: the valve of {name}: command"):
        plants.step(actions, 1e-2, shown, stopped)
