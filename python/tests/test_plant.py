"""Scenarios of many actuators with names: their runs, sweeps and linear models are those of the command line."""

from __future__ import annotations

import csv
import json
import pickle
import tomllib

import numpy
import polars
import pytest

import mckibben

SHORT = {"run.duration": "80 ms", "run.sample_interval": "1 ms"}

SWEEP = """
[sweep]
reductions = ["thick.absolute_pressure.final", "paper.length.min"]
[sweep.vary]
"actuators.thick.load.mass" = ["20 lb", "25 lb"]
"""


@pytest.mark.parametrize("name", ["bottle", "hose-joint", "controlled"])
def test_a_run_is_that_of_the_command_line(name, program, examples, tmp_path):
    path = examples / "plant" / f"{name}.toml"
    run = mckibben.simulate(mckibben.Scenario.from_file(path).with_values(SHORT))
    options = [word for key, value in SHORT.items() for word in ("--set", f'{key}="{value}"')]
    program(tmp_path, "simulate", str(path), *options, "--quiet", "--output", "run.csv")
    with open(tmp_path / "run.csv", newline="") as file:
        header, *rows = csv.reader(file)
    assert run.columns == header and len(run) == len(rows)
    for column, written in zip(header, zip(*rows)):
        if column in run.units:
            numpy.testing.assert_array_equal(run[column], [float(number) for number in written])
        else:
            assert list(run[column]) == list(written)
    run.to_csv(tmp_path / "own.csv")
    assert (tmp_path / "own.csv").read_bytes() == (tmp_path / "run.csv").read_bytes()
    again = pickle.loads(pickle.dumps(run))
    assert again.columns == run.columns and again.at(0.0123) == run.at(0.0123)
    assert len(run.plot().axes) >= 3


def test_a_scenario_is_what_it_says(examples):
    scenario = mckibben.Scenario.from_file(examples / "plant" / "bottle.toml")
    heavier = scenario.with_values({"actuators.thick.load.mass": "30 lb"})
    assert heavier != scenario and mckibben.Scenario(scenario.to_toml()) == scenario
    assert tomllib.loads(heavier.to_toml())["actuators"]["thick"]["load"]["mass"] == "30 lb"
    assert mckibben.Scenario.from_dict(heavier.to_dict()) == heavier
    with pytest.raises(mckibben.InputError, match="thick"):
        scenario.with_values({"actuators.thick.load.mass": "-1 lb"})


def test_a_sweep_is_its_runs(examples, tmp_path):
    text = (examples / "plant" / "bottle.toml").read_text()
    scenario = mckibben.Scenario(text + SWEEP).with_values({"run.duration": "0.2 s"})
    mckibben.sweep(scenario, tmp_path, jobs=1)
    table = polars.read_parquet(tmp_path / "*.parquet").sort("run")
    for row, mass in enumerate(["20 lb", "25 lb"]):
        single = mckibben.Scenario(text).with_values({"run.duration": "0.2 s", "actuators.thick.load.mass": mass})
        run = mckibben.simulate(single)
        assert table["thick_absolute_pressure_final_pa"][row] == run["thick.absolute_pressure_pa"][-1]
        assert table["paper_length_min_m"][row] == run["paper.length_m"].min()


def test_a_linear_model_has_names(program, examples, tmp_path):
    path = examples / "plant" / "hose-joint.toml"
    model = mckibben.linearize(mckibben.Scenario.from_file(path))
    program(tmp_path, "linearize", str(path), "--output", "model.json")
    written = json.loads((tmp_path / "model.json").read_text())
    assert model.states == [state["name"] for state in written["states"]]
    assert "elbow.angle" in model.states and "agonist.supply_opening" in model.inputs
    assert model.units["elbow.angle"] == "rad"
    numpy.testing.assert_array_equal(model.A, written["A"])
    assert model.operating_point["agonist.length_m"] == written["operating_point"]["agonist.length_m"]


def test_what_takes_one_actuator_says_so(examples):
    scenario = mckibben.Scenario.from_file(examples / "plant" / "bottle.toml")
    with pytest.raises(mckibben.InputError, match="in which actuators have names"):
        mckibben.Actuators(scenario, 2)
    with pytest.raises(mckibben.InputError, match="in which actuators have names"):
        mckibben.Actuator(scenario)
