"""Sweeps: on every executor the files have the same bytes as those of the command line."""

from __future__ import annotations

import concurrent.futures
import multiprocessing
import os
import pathlib
import pickle
import signal
import subprocess
import sys
import time
from concurrent.futures.process import BrokenProcessPool

import polars
import pytest

import mckibben

SWEEP = """\
[load]
kind = "hanging-mass"
[initial]
gauge_pressure = "60 psi"
length = "85 mm"
[run]
duration = "20 ms"
[sweep]
reductions = ["length.final", "tension.peak"]
part_rows = 25
[sweep.vary]
"load.mass" = { from = "2 lb", to = "9 lb", count = 20 }
"initial.gauge_pressure" = { from = "30 psi", to = "90 psi", count = 10 }
"""


def parts(folder: pathlib.Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


@pytest.fixture(scope="module")
def swept() -> mckibben.Scenario:
    return mckibben.Scenario(SWEEP, "sweep.toml")


@pytest.fixture(scope="module")
def expected(program, tmp_path_factory) -> dict[str, bytes]:
    """What the command line writes."""
    folder = tmp_path_factory.mktemp("sweep")
    (folder / "sweep.toml").write_text(SWEEP)
    program(folder, "sweep", "sweep.toml", "--output", "runs")
    files = parts(folder / "runs")
    assert len(files) == 9, "eight parts and sweep.json"
    return files


def test_threads_of_this_process_write_what_the_program_does(swept, expected, tmp_path):
    done = mckibben.sweep(swept, tmp_path, jobs=2)
    assert parts(tmp_path) == expected
    assert (done.rows, done.failed, len(done.parts)) == (200, 0, 8)
    assert done.units["load_mass_kg"] == "kg"
    frame = done.to_polars()
    assert frame.height == 200 and frame["run"].to_list() == list(range(200))
    assert done.to_pandas()["length_final_m"].tolist() == frame["length_final_m"].to_list()


def test_any_executor_gives_the_same_bytes(swept, expected, tmp_path):
    spawn = multiprocessing.get_context("spawn")
    seen: list[tuple[int, int]] = []
    for name, pool in [
        ("threads", concurrent.futures.ThreadPoolExecutor(3)),
        ("processes", concurrent.futures.ProcessPoolExecutor(2, mp_context=spawn)),
    ]:
        with pool:
            mckibben.sweep(swept, tmp_path / name, executor=pool, progress=lambda *at: seen.append(at))
        assert parts(tmp_path / name) == expected
    assert seen == 2 * [(done, 8) for done in range(1, 9)]


def test_progress_is_called_also_where_this_process_computes(swept, expected, tmp_path):
    """With the parts that are finished and all there are; an exception there ends the sweep, and what is done is kept."""
    seen: list[tuple[int, int]] = []
    mckibben.sweep(swept, tmp_path / "whole", jobs=1, progress=lambda *at: seen.append(at))
    assert seen == [(part, 8) for part in range(1, 9)]

    class Enough(Exception):
        pass

    def stop(done: int, parts: int) -> None:
        raise Enough

    with pytest.raises(Enough):
        mckibben.sweep(swept, tmp_path / "stopped", jobs=1, progress=stop)
    left = mckibben.Sweep(swept).missing(tmp_path / "stopped")[0]
    assert left == list(range(1, 8)), "the part that was finished is kept, and no other was begun"
    seen.clear()
    mckibben.sweep(swept, tmp_path / "stopped", jobs=1, progress=lambda *at: seen.append(at))
    assert seen == [(part, 8) for part in range(2, 9)]
    assert parts(tmp_path / "whole") == parts(tmp_path / "stopped") == expected


def test_what_is_there_is_kept_and_what_is_missing_is_done(swept, expected, tmp_path):
    mckibben.sweep(swept, tmp_path)
    (tmp_path / "part-00003.parquet").unlink()
    before = (tmp_path / "part-00000.parquet").stat()
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        mckibben.sweep(swept, tmp_path, executor=pool)
    after = (tmp_path / "part-00000.parquet").stat()
    assert parts(tmp_path) == expected and (before.st_ino, before.st_mtime_ns) == (after.st_ino, after.st_mtime_ns)


class Breaking(concurrent.futures.ThreadPoolExecutor):
    """As a pool of processes of which one is killed: what was submitted is lost, and nothing more can be."""

    def submit(self, function, /, *arguments, **named):
        if self.left == 0:
            raise BrokenProcessPool("it broke before")
        self.left -= 1
        future = super().submit(function, *arguments, **named)
        if self.left > 1:
            return future
        lost: concurrent.futures.Future[bytes] = concurrent.futures.Future()
        lost.set_exception(BrokenProcessPool("a worker was killed"))
        return lost


class Confused(concurrent.futures.ThreadPoolExecutor):
    """As a cluster that loses what was done already: of three futures one fails by an error of the executor's own."""

    count = 0

    def submit(self, function, /, *arguments, **named):
        self.count += 1
        if self.count % 3:
            return super().submit(function, *arguments, **named)
        confused: concurrent.futures.Future[bytes] = concurrent.futures.Future()
        confused.set_exception(ValueError("too many values to unpack"))
        return confused


def test_a_part_that_an_executor_fails_at_is_done_again(swept, expected, tmp_path):
    with Confused(2) as pool, pytest.warns(RuntimeWarning, match="too many values .* the 2 parts"):
        mckibben.sweep(swept, tmp_path, executor=pool)
    assert parts(tmp_path) == expected


@pytest.mark.parametrize("healthy", [0, 1, 4, 8])
def test_the_parts_of_a_killed_worker_are_done_again(swept, expected, tmp_path, healthy):
    with Breaking(2) as pool:
        pool.left = healthy
        with pytest.warns(RuntimeWarning, match="the executor failed"):
            mckibben.sweep(swept, tmp_path, executor=pool)
    assert parts(tmp_path) == expected


def test_dask_gives_the_same_bytes_though_a_worker_is_killed(swept, expected, tmp_path):
    import distributed

    with distributed.LocalCluster(2, threads_per_worker=1, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client, client.get_executor() as executor:
            client.submit(os.getpid).result()
            worker = next(iter(cluster.workers.values()))

            def kill(done: int, _: int) -> None:
                if done == 1:
                    os.kill(worker.pid, signal.SIGKILL)

            mckibben.sweep(swept, tmp_path, executor=executor, progress=kill)
    assert parts(tmp_path) == expected


def test_ray_gives_the_same_bytes_though_a_node_is_lost(swept, expected, tmp_path):
    import ray
    from ray.cluster_utils import Cluster

    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 1})
    other = cluster.add_node(num_cpus=1)
    ray.init(address=cluster.address, log_to_driver=False)
    try:
        assert len([node for node in ray.nodes() if node["Alive"]]) == 2

        def lose(done: int, _: int) -> None:
            if done == 1:
                cluster.remove_node(other, allow_graceful=False)

        mckibben.sweep(swept, tmp_path, executor="ray", progress=lose)
    finally:
        ray.shutdown()
        cluster.shutdown()
    assert parts(tmp_path) == expected


#: Enough runs that they are not done when the first part is there.
LONG = """
import sys, mckibben
sweep = mckibben.Scenario(open("sweep.toml").read(), "sweep.toml").with_values({
    "run.duration": "0.2 s", "sweep.part_rows": 20, "sweep.vary": {
        "load.mass": {"from": "2 lb", "to": "9 lb", "count": 200},
        "initial.gauge_pressure": {"from": "30 psi", "to": "90 psi", "count": 200}}})
print(mckibben.Sweep(sweep).parts, flush=True)
mckibben.sweep(sweep, "runs", jobs=2)
"""


def test_ctrl_c_stops_a_sweep_and_what_is_done_is_kept(tmp_path):
    (tmp_path / "sweep.toml").write_text(SWEEP)
    process = subprocess.Popen([sys.executable, "-c", LONG], cwd=tmp_path, text=True, stdout=subprocess.PIPE,
                               stderr=subprocess.PIPE)
    while process.poll() is None and not list(tmp_path.glob("runs/part-*.parquet")):
        time.sleep(0.01)
    process.send_signal(signal.SIGINT)
    count, wrong = process.communicate()
    assert wrong.rstrip().endswith("KeyboardInterrupt") and process.returncode != 0, wrong
    done = list(tmp_path.glob("runs/part-*.parquet"))
    assert 0 < len(done) < int(count)
    assert polars.read_parquet(done[0]).height == 20, "it is there whole"


def test_runs_that_fail_say_why(swept, tmp_path):
    """The thread is shorter than the muscle in the second run."""
    varied = {"load.mass": ["5 lb"], "actuator.thread_length": ["4.3218 in", "3 in"]}
    changed = swept.with_values({"actuator.preset": "colbrunn-2001", "sweep.vary": varied})
    done = mckibben.sweep(changed, tmp_path)
    assert (done.rows, done.failed) == (2, 1)
    assert "thread_length" in done.to_polars()["error"][1]


def test_keys_that_runs_leave_out_are_listed(swing, tmp_path):
    """An end factor has a meaning under its own law alone."""
    laws = {"actuator.force.law": ["ideal-braid", "tondu-lopez"], "actuator.force.end_factor": [1.05]}
    done = mckibben.sweep(swing, tmp_path, vary=laws, reductions=["tension.final"])
    assert done.left_out == ("actuator.force.end_factor in rows with actuator.force.law = ideal-braid",)
    assert done.failed == 0


def test_impossible_arguments_are_refused(swing, swept, tmp_path):
    with pytest.raises(mckibben.InputError, match="no section \\[sweep\\]"):
        mckibben.sweep(swing, tmp_path)
    mckibben.sweep(swept, tmp_path)
    with pytest.raises(mckibben.InputError, match="holds another sweep"):
        mckibben.sweep(swept.with_values({"sweep.part_rows": 10}), tmp_path)
    with pytest.raises(mckibben.InputError, match="no executor"):
        mckibben.sweep(swept, tmp_path, executor="slurm")
    with pytest.raises(mckibben.InputError, match="its own workers"):
        mckibben.sweep(swept, tmp_path, executor="ray", jobs=2)
    with pytest.raises(mckibben.InputError, match="no part 8"):
        mckibben.Sweep(swept).part(8)
    for part in (-1, True, 2**70):
        with pytest.raises(mckibben.InputError, match=f"no part {part}"):
            mckibben.Sweep(swept).part(part)


def test_only_the_whole_part_is_put_in_its_place(swept, tmp_path):
    """A part cut short, another part and anything else are refused, and the good part that is there stays."""
    todo = mckibben.Sweep(swept)
    good = todo.part(0)
    todo.put(tmp_path, 0, good)
    for bad in (b"", b"PAR1", good[:-10], good[:40] + b"x" + good[41:], todo.part(1)):
        with pytest.raises(mckibben.InputError, match="not part 0 of this sweep"):
            todo.put(tmp_path, 0, bad)
    with pytest.raises(mckibben.InputError, match="no part 8"):
        todo.put(tmp_path, 8, good)
    assert (tmp_path / "part-00000.parquet").read_bytes() == good
    assert 0 not in todo.missing(tmp_path)[0]


def test_a_sweep_can_be_pickled_with_its_step(swept):
    stepped = mckibben.Sweep(swept)
    again = pickle.loads(pickle.dumps(stepped))
    assert again.step == stepped.step is not None
    assert again.part(7) == stepped.part(7)


def test_a_sweep_without_a_folder_is_a_data_frame(swing, tmp_path):
    """Of a scenario without a section `[sweep]`: what varies and what is kept are arguments."""
    vary = {"load.mass": ["4 lb", "5 lb", "6 lb"], "initial.gauge_pressure": ["50 psi", "60 psi"]}
    reductions = ["length.final", "tension.max"]
    frame = mckibben.sweep(swing, vary=vary, reductions=reductions, jobs=2)
    assert len(frame) == 6 and frame["error"].isna().all()
    assert frame.attrs["units"]["length_final_m"] == "m"
    kept = mckibben.sweep(swing, tmp_path / "runs", vary=vary, reductions=reductions)
    assert frame.equals(kept.to_pandas())
    step = mckibben.Sweep(swing.with_values({"sweep.vary": vary, "sweep.reductions": reductions})).step
    one = {"load.mass": "6 lb", "initial.gauge_pressure": "60 psi", "run.engine": "fixed-step", "run.step": f"{step!r} s"}
    assert frame["length_final_m"].iloc[-1] == mckibben.simulate(swing.with_values(one)).length[-1]
    with pytest.raises(mckibben.InputError, match="load.weight"):
        mckibben.sweep(swing, vary={"load.weight": ["4 lb"]}, reductions=reductions)


def test_what_is_spaced_logarithmically_is_drawn_so(swing, tmp_path):
    """A range and a distribution by their logarithm have logarithmic axes; what is listed or spaced evenly does not."""
    vary = {
        "load.mass": {"from": "1 kg", "to": "4 kg", "count": 3, "spacing": "logarithmic"},
        "initial.gauge_pressure": {"from": "50 psi", "to": "60 psi", "count": 2},
    }
    done = mckibben.sweep(swing, tmp_path / "runs", vary=vary, reductions=["length.final"])
    assert done.logarithmic == ("load_mass_kg",)
    assert done.to_pandas()["load_mass_kg"].unique() == pytest.approx([1.0, 2.0, 4.0])
    (axis,) = done.plot(["length_final_m"], over="load_mass_kg").axes
    assert (axis.get_xscale(), axis.get_yscale()) == ("log", "linear")
    (axis,) = done.plot(["load_mass_kg"], over="initial_gauge_pressure_pa").axes
    assert (axis.get_xscale(), axis.get_yscale()) == ("linear", "log")
    drawn = swing.with_values({
        "sweep.design": "sobol", "sweep.rows": 4, "sweep.reductions": ["length.final"],
        "sweep.vary": {"load.mass": {"log-normal": {"median": "2 kg", "factor": 1.2}}},
    })
    assert mckibben.Sweep(drawn).logarithmic == ["load_mass_kg"]


def test_a_figure_has_a_point_for_each_run(swept, tmp_path):
    done = mckibben.sweep(swept, tmp_path / "runs", jobs=2)
    frame = done.to_pandas()
    figure = done.plot()
    assert [axis.get_ylabel() for axis in figure.axes] == [
        f"{name} ({done.units[name]})" for name in list(frame) if name in done.units and name != "load_mass_kg"
    ]
    assert figure.axes[-1].get_xlabel() == "load_mass_kg (kg)"
    (line,) = done.plot(["tension_peak_n"], over="initial_gauge_pressure_pa").axes[0].lines
    assert line.get_xdata().tolist() == frame["initial_gauge_pressure_pa"].tolist()
    assert line.get_ydata().tolist() == frame["tension_peak_n"].tolist()
    with pytest.raises(mckibben.InputError, match="`tension` is no column of numbers"):
        done.plot(["tension"])

THROWN = {
    "supply": {"gauge_pressure": "100 psi"},
    "valve": {"preset": "matrix-eight-channel"},
    "command": {"kind": "pwm", "frequency": "25 Hz", "duty": 0.5},
    "load": {"kind": "hanging-mass", "mass": "5 lb"},
    "run": {"duration": "0.3 s"},
    "sweep": {"part_rows": 2},
}


@pytest.mark.parametrize("workers", [0, 2])
def test_warnings_of_the_runs_are_counted(workers, tmp_path):
    """A load of 0.05 lb is thrown above the attachment, also where the parts are computed elsewhere."""
    scenario = mckibben.Scenario.from_dict({**THROWN, "sweep": {"part_rows": 2, "vary": {"load.mass": ["5 lb"]}}})
    executor = concurrent.futures.ThreadPoolExecutor(workers) if workers else None
    masses = {"load.mass": ["5 lb", "0.05 lb", "6 lb", "0.04 lb"]}
    done = mckibben.sweep(scenario, tmp_path, vary=masses, reductions=["length.final"], executor=executor)
    (warning,) = done.warnings
    assert (warning.code, warning.runs, warning.first) == ("thrown", 2, 1) and "above the attachment" in warning.text
    assert done.to_polars()["warnings"].to_list() == [None, "thrown", None, "thrown"]
    assert done.to_pandas().attrs["warnings"] == done.warnings
    plain = mckibben.sweep(scenario, vary={"load.mass": ["5 lb", "6 lb"]}, reductions=["length.final"])
    assert plain.attrs["warnings"] == () and plain["warnings"].isna().all()


def test_repeats_and_texts_in_place_of_lists_are_refused(swing, tmp_path):
    vary = {"load.mass": ["4 lb"]}
    with pytest.raises(mckibben.InputError, match="the reduction `length.final` is named twice"):
        mckibben.sweep(swing, tmp_path / "runs", vary=vary, reductions=["length.final", "length.final"])
    assert not (tmp_path / "runs").exists()
    with pytest.raises(TypeError, match="`reductions`: a list is wanted and no str"):
        mckibben.sweep(swing, vary=vary, reductions="length.final")  # type: ignore[arg-type]
