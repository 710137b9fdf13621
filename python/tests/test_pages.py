"""The pages of the book: their Python and their commands run, their scenario files are read, and their keys exist.

`test_tutorial.py` compares what the tutorial prints; the examples of docs/api.md are those of the docstrings.
"""

from __future__ import annotations

import pathlib
import re
import shlex
import tomllib
import typing

import numpy
import pandas
import pytest

import mckibben

ROOT = pathlib.Path(__file__).parents[2]
LEFT_OUT = {"api.md", "tutorial.md"}
PAGES = [ROOT / "README.md", *sorted(page for page in (ROOT / "docs").glob("*.md") if page.name not in LEFT_OUT)]
#: FMPy runs in `test_fmu.py` with files that this page only names.
PYTHON = [page for page in PAGES if "```python" in page.read_text(encoding="utf-8") and page.name != "fmu.md"]
#: Commands that are run; the others need a unit's library, hours, or a file that no page has.
COMMANDS = ("check", "curves", "design", "identify", "init", "linearize", "simulate", "size")
#: Files that pages speak of as the reader's own.
OWN = ("muscle", "light", "heavy", "a", "b")


#: A mass that a motor pulls, as the page on MuJoCo asks for.
PULLED = """
<mujoco>
  <worldbody>
    <site name="anchor"/>
    <body pos="0 0 -0.09">
      <joint type="slide" axis="0 0 1"/>
      <geom type="sphere" size="0.02" mass="2.27"/>
      <site name="hook"/>
    </body>
  </worldbody>
  <tendon><spatial name="muscle"><site site="anchor"/><site site="hook"/></spatial></tendon>
  <actuator><motor name="muscle" tendon="muscle"/></actuator>
</mujoco>
"""


def blocks(page: pathlib.Path, language: str) -> list[str]:
    return re.findall(rf"^```{language}\n(.*?)^```", page.read_text(encoding="utf-8"), re.MULTILINE | re.DOTALL)


@pytest.fixture
def folder(tmp_path, program, monkeypatch) -> pathlib.Path:
    """A folder with what the pages name: the repository's files and the reader's own."""
    for shared in ("examples", "models", "validation"):
        (tmp_path / shared).symlink_to(ROOT / shared)
    (tmp_path / "docs").mkdir()
    for name in OWN:
        program(tmp_path, "init", f"{name}.toml")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def given() -> dict[str, typing.Any]:
    """What the code of pages takes as there: a scenario, records of a rig, a model of MuJoCo."""
    scenario = mckibben.Scenario.from_file("examples/paper/fig-12.toml").with_values({"run.duration": "0.2 s"})

    def record(mass: float) -> pandas.DataFrame:
        run = mckibben.simulate(scenario.with_values({"load.mass": mass}))
        return pandas.DataFrame({"t": run["time_s"], "L": 1e3 * run.length, "P": 1e-5 * run["gauge_pressure_pa"]})

    here = {"mckibben": mckibben, "numpy": numpy, "scenario": scenario, "rig": scenario}
    return here | {"frame": record(2.27), "other": record(3.6)}


@pytest.mark.parametrize("page", PYTHON, ids=lambda page: page.name)
def test_the_python_of_a_page_runs(page, folder):
    """Block after block, as a reader would type them."""
    here = given()
    for block in blocks(page, "python"):
        if "Driver(model" in block:
            here |= {"model": here["mujoco"].MjModel.from_xml_string(PULLED), "commands": numpy.full((64, 1), 0.5)}
        exec(compile(block, page.name, "exec"), here)


def commands(page: pathlib.Path) -> list[list[str]]:
    lines = page.read_text(encoding="utf-8").replace("\\\n", " ").splitlines()
    lines = [line.strip().removeprefix("$ ") for line in lines]
    parts = [shlex.split(line, comments=True) for line in lines if line.startswith("mckibben ") and "|" not in line]
    named = [part for part in parts if part[1:2] and part[1] in COMMANDS and "study.toml" not in part]
    return [part[1:] for part in named]


@pytest.mark.parametrize("page", [page for page in PAGES if commands(page)], ids=lambda page: page.name)
def test_the_commands_of_a_page_run(page, folder, program):
    for arguments in commands(page):
        if arguments[0] == "init":
            (folder / arguments[-1]).unlink(missing_ok=True)
        program(folder, *arguments)


def keys_of(table: dict[str, typing.Any], path: str = "") -> list[str]:
    """Return the paths of all keys in a table."""
    found = []
    for key, value in table.items():
        here = f"{path}.{key}" if path else key
        found += keys_of(value, here) if isinstance(value, dict) else [here]
    return found


#: Sections of plants, whose keys have names of parts in them.
OF_PLANTS = {"actuators", "supplies", "mechanism", "mechanisms", "coupling", "sweep"}
SCENARIOS = [
    (page, text)
    for page in PAGES
    for text in blocks(page, "toml")
    + [
        # What the program prints of a file may stand below it.
        re.sub(r"^    ", "", block, flags=re.MULTILINE).split("\n$ ")[0]
        for block in re.findall(r"(?:^(?:    .*)?\n)+", page.read_text(encoding="utf-8"), re.MULTILINE)
        if re.match(r"\s*    (#.*\n\s*)?\[[a-z][\w.\"]*\]\n", block)
    ]
]


@pytest.mark.parametrize(("page", "text"), SCENARIOS, ids=lambda part: getattr(part, "name", None) or str(len(part)))
def test_the_files_of_a_page_are_files(page, text, program, tmp_path):
    """Whole ones describe something that runs, as far as checks know it; of parts every key exists."""
    table = tomllib.loads(text)
    if {"study", "flow", "tank", "pulses", "columns", "fit"} & set(table):
        return
    if "run" in table:
        mckibben.Scenario(text, page.name)
        return
    for key in keys_of({name: value for name, value in table.items() if name not in OF_PLANTS}):
        program(tmp_path, "keys", key)
