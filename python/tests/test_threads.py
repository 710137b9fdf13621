"""Many threads at once, and processes that were forked."""

from __future__ import annotations

import concurrent.futures
import functools
import os
import signal
import subprocess
import sys
import threading

import numpy
import pytest

import mckibben
from conftest import same

STEP = 1e-3
THREADS = 6


@pytest.fixture(scope="module")
def scenario(examples) -> mckibben.Scenario:
    return mckibben.Scenario.from_file(examples / "paper/fig-12.toml")


def at_once(work, count: int) -> list:
    """What `work(0)`, `work(1)` and so on give, on a thread each, all begun at one time."""
    gate = threading.Barrier(count)

    def one(number: int):
        gate.wait()
        return work(number)

    with concurrent.futures.ThreadPoolExecutor(count) as pool:
        return list(pool.map(one, range(count)))


def test_one_actuator_serves_many_threads(scenario):
    """Each thread goes its own way with it: another duty, and lengths that differ."""
    actuator = mckibben.Actuator(scenario)

    def work(number: int) -> list[tuple[mckibben.ActuatorState, float, mckibben.Response]]:
        state, went = actuator.start(), []
        length = state.length
        for row in range(200):
            length -= 1e-5 * (1 + number % 3)
            went.append(actuator.step(state, length, -0.01, (number + 1) / (THREADS + 1) if row == 0 else None, STEP))
            state = went[-1][0]
        return went

    alone = [work(number) for number in range(THREADS)]
    assert at_once(work, THREADS) == alone
    assert len({went[-1][1] for went in alone}) == THREADS


def test_many_actuators_on_many_threads(scenario):
    """Enough of them to be shared among cores, from several threads at once."""
    count = 300

    def work(number: int) -> numpy.ndarray:
        many, found = mckibben.Actuators(scenario, count), numpy.zeros((2, count))
        duty = numpy.linspace(0.0, 1.0, count) * (number + 1) / THREADS
        for row in range(5):
            length = numpy.full(count, 0.09 - 1e-5 * row)
            many.step(length, numpy.zeros(count), duty, STEP, found[0], absolute_pressure=found[1])
        return found

    alone = [work(number) for number in range(THREADS)]
    for one, other in zip(at_once(work, THREADS), alone):
        numpy.testing.assert_array_equal(one, other)


def test_concurrent_calls_return_what_single_calls_return(scenario, swing):
    heavy = [swing.with_values({"load.mass": f"{mass} lb"}) for mass in range(4, 4 + THREADS)]
    length = mckibben.Differentiable(swing, ["load.mass", "initial.gauge_pressure"], ["length"], [0.05, 0.1])

    def work(number: int):
        values = length.defaults * (1 + 0.01 * number)
        return mckibben.simulate(heavy[number]), length.value_and_jacobian(values), mckibben.curves(heavy[number])["stiffness_n_m"]

    for (run, slopes, curves), (run_alone, slopes_alone, curves_alone) in zip(
        at_once(work, THREADS), [work(number) for number in range(THREADS)]
    ):
        same(run, run_alone)
        for one, other in zip((*slopes, curves), (*slopes_alone, curves_alone)):
            numpy.testing.assert_array_equal(one, other)


#: What is done before and after a fork, each on threads: more rows than are stepped on one, derivatives by more numbers than one
#: pass takes, a study of time series, a sweep.
FORKED = """
import multiprocessing, os, sys, numpy, mckibben
examples = sys.argv[2]
scenario = mckibben.Scenario.from_file(f"{examples}/paper/fig-12.toml").with_values({"run.duration": "20 ms"})
BY = ["load.mass", "command.duty", "actuator.turns", "valve.efficiency", "supply.gauge_pressure", "initial.temperature",
      "actuator.friction.viscous", "actuator.external_volume", "valve.opening_delay"]

def rows():
    count = 1000
    many, tension = mckibben.Actuators(scenario, count), numpy.zeros(count)
    for _ in range(3):
        many.step(numpy.full(count, 0.09), numpy.zeros(count), numpy.linspace(0, 1, count), 1e-3, tension)
    return tension.tobytes()

def slopes():
    run = mckibben.Differentiable(scenario, BY, ["length", "tension"], [0.01, 0.02])
    return b"".join(array.tobytes() for array in run.value_and_jacobian(run.defaults))

def sweep():
    many = mckibben.Sweep(scenario.with_values({"sweep.vary": {"load.mass": {"from": "2 lb", "to": "9 lb", "count": 40}}}))
    import tempfile
    with tempfile.TemporaryDirectory() as folder:
        return b"".join(part.read_bytes() for part in mckibben.sweep(many.scenario, folder, jobs=2).parts)

def run():
    return mckibben.simulate(scenario).tension.tobytes()

work = {"rows": rows, "slopes": slopes, "sweep": sweep, "run": run}[sys.argv[1]]

if __name__ == "__main__":
    expected = work()
    # By hand, and again from the child.
    child = os.fork()
    if child == 0:
        grandchild = -1
        if work() == expected:
            grandchild = os.fork()
            if grandchild == 0:
                os._exit(0 if work() == expected else 3)
        os._exit(4 if grandchild < 0 else os.waitstatus_to_exitcode(os.waitpid(grandchild, 0)[1]))
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == 0, "a child that was forked finds something else"
    # The parent goes on, and so does a pool of forked processes.
    assert work() == expected
    with multiprocessing.get_context("fork").Pool(2) as pool:
        assert pool.starmap(work, [()] * 4) == [expected] * 4
    print("done")
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here")
@pytest.mark.parametrize("work", ["rows", "slopes", "sweep", "run"])
def test_after_a_fork_a_child_goes_on(work, examples, tmp_path):
    """In a separate process with its children, which are killed where they wait for threads that are not there."""
    script = tmp_path / "forked.py"
    script.write_text(FORKED)
    command = [sys.executable, "-W", "ignore", str(script), work, str(examples)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True)
    try:
        printed, wrong = process.communicate(timeout=120)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.communicate()
        pytest.fail("a child that was forked waits for ever")
    assert process.returncode == 0 and printed == "done\n", wrong


@pytest.fixture
def interrupted():
    """Calls with one argument, and interrupts the call by the signal that Ctrl-C sends.

    No clock decides when: another thread sends the signal once the call is next, after some work of its own, and again until
    the call handles it. Were the interpreter kept from other threads, none would be sent; were it not handled, the call would
    come to its end.
    """
    before = signal.getsignal(signal.SIGINT)

    def interrupted(call, argument):
        begun, is_handled, ended = threading.Event(), threading.Event(), []

        def arguments():
            begun.set()
            yield argument

        def handle(_, frame):
            # A signal handled in these lines of Python, before the call or after its end, does not test the call.
            while frame is not None and frame.f_code is not arguments.__code__:
                frame = frame.f_back
            if frame is None and not ended and not is_handled.is_set():
                is_handled.set()
                raise KeyboardInterrupt

        def send():
            begun.wait()
            for _ in range(10_000):
                pass
            while not is_handled.is_set():
                signal.raise_signal(signal.SIGINT)
                is_handled.wait(0.01)

        signal.signal(signal.SIGINT, handle)
        other = threading.Thread(target=send, daemon=True)
        other.start()
        try:
            # From the argument to the call, and from its end to where that is noted, there is no line of Python.
            next(map(ended.append, map(call, arguments())))
            return ended[0]
        finally:
            is_handled.set()
            other.join()

    yield interrupted
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("engine", [{"engine": "event-located"}, {"engine": "fixed-step", "step": "0.1 ms"}])
def test_a_run_lets_other_threads_go_on_and_ends_at_an_interrupt(scenario, engine, interrupted):
    """A run of an hour is interrupted; nothing is left of it, and another goes on."""
    engine = {f"run.{key}": value for key, value in engine.items()}
    long = scenario.with_values({"run.duration": "3600 s", **engine})
    with pytest.raises(KeyboardInterrupt):
        interrupted(mckibben.simulate, long)
    same(mckibben.simulate(scenario), mckibben.simulate(scenario))


def endless(scenario: mckibben.Scenario, what: str):
    """A call that takes many seconds at least, and what it must leave as it was."""
    if what == "actuator":
        actuator = mckibben.Actuator(scenario)
        state = actuator.start()
        call = functools.partial(actuator.step, state, 0.09, 0.0, 0.5, 9.0, max_step=1e-6)
        return call, lambda: actuator.step(state, 0.09, 0.0, 0.5, STEP)[1]
    if what == "actuators":
        many = mckibben.Actuators(scenario, 40)
        length, velocity, duty, tension = numpy.full(40, 0.09), numpy.zeros(40), numpy.full(40, 0.5), numpy.zeros(40)
        call = functools.partial(many.step, length, velocity, duty, 9.0, tension, max_step=1e-6)
        return call, lambda: many.__getstate__().tobytes()
    if what == "plants":
        plants = mckibben.VectorPlant(scenario.with_values({"run.engine": "fixed-step", "run.step": "1 us"}), 40)
        shown, stopped = numpy.zeros((40, len(plants.columns))), numpy.zeros(40, dtype=bool)
        return functools.partial(plants.step, numpy.full((40, 1), 0.5), 9.0, shown, stopped), lambda: len(plants)
    if what == "hosted":
        hosted = mckibben.HostedPlant(scenario, 2, command_mode="request", max_step=1e-6)
        call = functools.partial(hosted.step, numpy.full((2, 1), 0.085), numpy.ones((2, 1)), 9.0)
        return call, lambda: (hosted.time, hosted.distances.tobytes(), hosted.save().tobytes())
    long = scenario.with_values({"run.duration": "3600 s"})
    if what == "study":
        data = {"t": numpy.linspace(0.0, 3600.0, 100), "L": numpy.full(100, 0.09)}
        columns, fit = {"time": "t", "length": "L"}, {"load.mass": (1.0, 5.0)}
        study = mckibben.Study(kind="trajectories", scenario=long, runs=[data], columns=columns, fit=fit)
        return functools.partial(mckibben.identify, study), lambda: long.to_toml()
    function = mckibben.Differentiable(long, ["load.mass", "command.duty"], ["length"], [3600.0])
    short = mckibben.Differentiable(scenario, ["load.mass", "command.duty"], ["length"], [0.01])
    call = function if what == "values" else function.value_and_jacobian
    return functools.partial(call, function.defaults), lambda: short(short.defaults).tobytes()


@pytest.mark.parametrize("what", ["actuator", "actuators", "plants", "hosted", "study", "values", "slopes"])
def test_a_long_call_ends_at_an_interrupt(what, scenario, interrupted):
    """The signal that Ctrl-C sends arrives while the call is under way; what there was before is there after it."""
    call, seen = endless(scenario, what)
    before = seen()
    with pytest.raises(KeyboardInterrupt):
        # By a call without a line of Python.
        interrupted(functools.partial.__call__, call)
    assert seen() == before


@pytest.mark.parametrize("work", [
    "mckibben.Scenario.from_file(FILE).with_values({'run.duration': '2000 s'}).settle()",
    "mckibben.size(load='5 kg', stroke='30 mm', gauge_pressure='4 bar', time=0.3, ripple='0.2 mm',"
    " braid_angles=[f'{angle / 100} deg' for angle in range(1500, 3500)])",
    "mckibben.sweep(mckibben.Scenario.from_file(FILE).with_values({'run.duration': '20000 s', 'run.engine': 'fixed-step',"
    " 'run.step': '0.1 ms', 'run.sample_interval': '1 s'}), vary={'load.mass': [2.0, 2.5]}, reductions=['length.final'])",
    "mckibben.sweep(mckibben.Scenario.from_file(FILE).with_values({'run.duration': '20000 s', 'run.engine': 'event-located',"
    " 'run.sample_interval': '1 s'}), vary={'load.mass': [2.0, 2.5]}, reductions=['length.final'])",
])
def test_what_takes_long_ends_by_ctrl_c(work, examples):
    """In a separate process, since the signal interrupts the main thread."""
    program = f"""
import mckibben, os, signal, threading, time
FILE = {str(examples / "linearize-pwm.toml")!r}
# What is started in the background ignores it.
signal.signal(signal.SIGINT, signal.default_int_handler)
mckibben.size(load="5 kg", stroke="30 mm", gauge_pressure="4 bar")
threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT)).start()
begun = time.monotonic()
try:
    {work}
except KeyboardInterrupt:
    print(time.monotonic() - begun)
"""
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, timeout=120, check=True)
    assert 0.4 < float(done.stdout) < 5.0
