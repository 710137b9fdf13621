"""Docstrings in the style of numpydoc: everything public has one, examples run, and docs/api.md is made from them."""

from __future__ import annotations

import builtins
import doctest
import importlib.util
import inspect
import typing

import matplotlib
import pytest

import mckibben
from conftest import ROOT

_spec = importlib.util.spec_from_file_location("reference", ROOT / "python/reference.py")
assert _spec is not None and _spec.loader is not None
reference = importlib.util.module_from_spec(_spec)
_spec.loader.exec_module(reference)

NAMES = sorted(set(mckibben.__all__) - {"__version__"})
CLASSES = [name for name in NAMES if isinstance(getattr(mckibben, name), type)]
#: Classes that the package returns; their constructors serve the package and pickling.
RETURNED = {
    "Constrained", "Curves", "DesignResult", "Error", "Estimate", "Event", "Identification", "InputError", "LinearModel", "OtherMinimum",
    "OutputError", "Parameter", "Prediction", "Preset", "PresetValue", "Response", "SimulationError", "SizedMuscle", "Sizes", "StepInfo", "StepResponse",
    "SweepResult", "SweepWarning", "Trajectory",
}
#: What every user calls, and what has an example therefore.
EXEMPLARY = {
    "simulate", "linearize", "identify", "size", "design", "parameters", "presets", "sweep", "Actuator", "ActuatorState", "Actuators",
    "Differentiable", "DifferentiableStep", "Error", "Event", "InputError", "LinearModel", "OutputError", "Response", "Scenario",
    "SimulationError", "Statics", "Sweep", "SweepResult", "Trajectory", "VectorPlant",
}
#: In their order.
SECTIONS = ["", "Parameters", "Attributes", "Returns", "Raises", "Warns", "See Also", "Notes", "Examples"]


def documented() -> dict[str, typing.Any]:
    """Everything public: functions, classes, and the methods and properties of classes, by dotted names."""
    found = {name: getattr(mckibben, name) for name in NAMES}
    for name in CLASSES:
        found |= {f"{name}.{member}": of for member, of in reference.members(found[name])}
    return found


DOCUMENTED = documented()


def doc_of(of: typing.Any) -> str:
    return inspect.cleandoc(reference.unwrapped(of).__doc__ or "")


@pytest.mark.parametrize("name", DOCUMENTED)
def test_it_has_a_summary_and_no_section_but_those_of_numpydoc(name):
    doc = doc_of(DOCUMENTED[name])
    summary = reference.summary(doc)
    assert summary.endswith((".", ";", ":")) and summary[0].isupper(), summary
    assert not summary.startswith("The same"), summary
    sections = reference.sections(doc)
    assert list(sections) == [known for known in SECTIONS if known in sections]
    if summary.startswith("Return ") and not reference.is_property(DOCUMENTED[name]):
        assert "Returns" in sections, "it returns something: say what"
    for section in set(sections) & {"Parameters", "Attributes"}:
        for item, kind, text in reference.items(sections[section]):
            assert kind and text, f"{section}: {item}"
    for exception, _, text in reference.items(sections.get("Raises", [])):
        assert text and (hasattr(mckibben, exception) or hasattr(builtins, exception)), exception


def is_called(name: str, of: typing.Any) -> bool:
    """Whether users call it with arguments."""
    return not reference.is_property(of) and name not in RETURNED


@pytest.mark.parametrize("name", [name for name, of in DOCUMENTED.items() if is_called(name, of)])
def test_each_parameter_is_described_by_its_name(name):
    of = DOCUMENTED[name]
    due = [one.name for one in reference.parameters_of(of)]
    items = reference.items(reference.sections(doc_of(of)).get("Parameters", []))
    assert [word for names, _, _ in items for word in names.split(", ")] == due


@pytest.mark.parametrize("name", [name for name, of in DOCUMENTED.items() if ">>>" in doc_of(of)])
def test_its_examples_hold(name, monkeypatch, tmp_path):
    matplotlib.use("agg")
    monkeypatch.chdir(tmp_path)
    test = doctest.DocTestParser().get_doctest(doc_of(DOCUMENTED[name]), {}, name, None, 0)
    printed: list[str] = []
    outcome = doctest.DocTestRunner().run(test, out=printed.append)
    assert outcome.attempted > 0 and outcome.failed == 0, "".join(printed)


def test_what_every_user_calls_has_an_example():
    assert {name for name in EXEMPLARY if ">>>" not in doc_of(DOCUMENTED[name])} == set()


def test_the_reference_is_what_the_package_has():
    assert reference.outdated() == ""


def test_a_default_that_a_signature_leaves_out_is_no_empty_tuple():
    def command(count=..., values=(), over="time"): ...

    assert reference.call("command", command).splitlines()[1] == "command(count=..., values=(), over='time')"


def test_an_outdated_line_is_reported_with_the_remedy(monkeypatch, tmp_path):
    page = tmp_path / "api.md"
    page.write_text(reference.page().replace("### Scenario\n", "### Scenarios\n", 1), encoding="utf-8")
    monkeypatch.setattr(reference, "PAGE", page)
    assert "### Scenario" in reference.outdated() and "python python/reference.py" in reference.outdated()
