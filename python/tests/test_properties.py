"""What holds for any scenario: nothing but the package's own errors, no number that is none, one state for one instant."""

from __future__ import annotations

import tomllib
import typing

import hypothesis
import numpy
import pytest
from hypothesis import strategies as st

import mckibben
from scenarios import KINDS, Sections, mistaken

#: The same examples each time, so that a check that passed here passes there.
STEADY = hypothesis.settings(
    derandomize=True, deadline=None, database=None, print_blob=False,
    suppress_health_check=[hypothesis.HealthCheck.too_slow, hypothesis.HealthCheck.data_too_large],
)
#: Columns that are a state of what is simulated, or where its ends are.
STATES = {"time_s", "length_m", "velocity_m_s", "absolute_pressure_pa", "air_mass_kg", "temperature_k", "volume_m3", "tension_n"}


def simulated(sections: Sections) -> mckibben.Trajectory | None:
    """The run, or none where a scenario is refused or cannot go on; anything else is a fault, a panic above all."""
    try:
        return mckibben.simulate(mckibben.Scenario.from_dict(sections))
    except mckibben.Error as error:
        assert type(error) in (mckibben.InputError, mckibben.SimulationError) and str(error).startswith("error: ")
        return None


@pytest.mark.parametrize("kind", KINDS)
def test_a_run_has_only_numbers_and_one_state_for_one_instant(kind):
    went = {True: 0, False: 0}

    @hypothesis.settings(STEADY, max_examples=20)
    @hypothesis.given(KINDS[kind])
    def check(sections):
        run = simulated(sections)
        went[run is not None] += 1
        if run is not None:
            judge(run)

    check()
    # Otherwise it would hold of nothing.
    assert went[True] > 2 * went[False], went


def judge(run: mckibben.Trajectory) -> None:
    assert STATES <= set(run.columns)
    for name in run.units:
        assert numpy.isfinite(run[name]).all(), name
    for whose in ["", "antagonist_"] if "angle_rad" in run.columns else [""]:
        assert (run[f"{whose}tension_n"] >= 0.0).all()
        assert (run[f"{whose}absolute_pressure_pa"] > 0.0).all() and (run[f"{whose}air_mass_kg"] > 0.0).all()
    assert run.t[0] == 0.0 and (numpy.diff(run.t) > 0.0).all()
    between = run.at_times(run.t)
    for name in run.columns:
        numpy.testing.assert_array_equal(between[name], run[name], err_msg=name)
    row = len(run) // 2
    assert run.at(run.t[row]) == {name: run[name][row].item() for name in run.columns}


@hypothesis.settings(STEADY, max_examples=250)
@hypothesis.given(mistaken())
def test_a_mistake_raises_the_input_error_and_nothing_else(sections):
    run = simulated(sections)
    if run is not None:
        assert all(numpy.isfinite(run[name]).all() for name in STATES)


@hypothesis.settings(STEADY, max_examples=40)
@hypothesis.given(st.one_of(*KINDS.values()))
def test_what_was_understood_is_understood_again(sections):
    """Through a dictionary, through text and through `with_values` that changes nothing."""
    try:
        scenario = mckibben.Scenario.from_dict(sections)
    except mckibben.InputError:
        return
    assert mckibben.Scenario.from_dict(scenario.to_dict()) == scenario
    assert mckibben.Scenario(scenario.to_toml()) == scenario
    assert tomllib.loads(scenario.to_toml()) == scenario.to_dict()
    assert scenario.with_values({"load.kind": sections["load"]["kind"]}) == scenario


@hypothesis.settings(STEADY, max_examples=12)
@hypothesis.given(sections=st.one_of(*KINDS.values()), columns=st.sampled_from(["parquet", "csv"]))
def test_the_program_writes_the_same_bytes(sections, columns, program, tmp_path_factory):
    """With the same exit code and the same words where it cannot."""
    folder = tmp_path_factory.mktemp("program")
    codes: dict[type[Exception], int] = {mckibben.InputError: 2, mckibben.SimulationError: 3}
    text = toml(sections)
    (folder / "scenario.toml").write_text(text)
    arguments = ("simulate", "scenario.toml", "--output", f"program.{columns}")
    try:
        run = mckibben.simulate(mckibben.Scenario(text, "scenario.toml"))
    except mckibben.Error as error:
        assert program(folder, *arguments, code=codes[type(error)]).stderr.rstrip("\n") == str(error)
        return
    program(folder, *arguments)
    getattr(run, f"to_{columns}")(folder / f"own.{columns}")
    assert (folder / f"own.{columns}").read_bytes() == (folder / f"program.{columns}").read_bytes()


def toml(sections: Sections) -> str:
    """A dictionary as a file has it."""

    def value(of: typing.Any) -> str:
        if isinstance(of, dict):
            return "{ " + ", ".join(f"{key} = {value(inner)}" for key, inner in of.items()) + " }"
        if isinstance(of, list):
            return "[" + ", ".join(map(value, of)) + "]"
        return f'"{of}"' if isinstance(of, str) else repr(of)

    lines = []
    for section, keys in sections.items():
        lines += [f"[{section}]", *(f"{key} = {value(of)}" for key, of in keys.items())]
    return "\n".join(lines) + "\n"
