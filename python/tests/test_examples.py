"""The notebooks of `examples/python`: each runs, its assertions hold, and it writes its pictures."""

from __future__ import annotations

import os
import pathlib
import re
import subprocess
import sys
import xml.etree.ElementTree

import pytest

import mckibben

#: What the notebooks share.
SHARED = "pictures.py"
FOLDER = pathlib.Path(__file__).parents[2] / "examples" / "python"
NOTEBOOKS = sorted(path.name for path in FOLDER.glob("*.py") if path.name != SHARED)


def rests_on_matrices(name: str) -> bool:
    """Whether a notebook designs a controller: its figures then rest on eigenvalues and matrix equations."""
    return "import control\n" in (FOLDER / name).read_text()


MARKED = [pytest.param(name, marks=[pytest.mark.blas] * rests_on_matrices(name)) for name in NOTEBOOKS]


def run(name: str, folder: pathlib.Path, *arguments: str) -> None:
    """Runs a notebook as a user of the package does: in another folder, with only what is installed on the path."""
    package = pathlib.Path(mckibben.__file__).parents[1]
    # Threads that wait for each other in matrices of four rows take minutes on cores that others use.
    environment = os.environ | {
        "PYTHONPATH": os.pathsep.join([str(package), os.environ.get("PYTHONPATH", "")]),
        "OPENBLAS_NUM_THREADS": "1",
    }
    command = [sys.executable, "-W", "error::DeprecationWarning:__main__", str(FOLDER / name), *arguments]
    done = subprocess.run(command, cwd=folder, env=environment, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"


def test_the_notebooks_are_there():
    assert len(NOTEBOOKS) >= 5
    assert any(rests_on_matrices(name) for name in NOTEBOOKS)


@pytest.mark.parametrize("name", MARKED)
def test_it_runs_and_leaves_its_pictures(name, tmp_path):
    run(name, tmp_path, "--out", "pictures")
    drawn = re.findall(r'pictures\.save\(\w+, "([\w-]+)"\)', (FOLDER / name).read_text())
    assert drawn, "no notebook is without a picture"
    written = {path.name for path in (tmp_path / "pictures").iterdir()}
    assert written == {f"{stem}.{ending}" for stem in drawn for ending in ("svg", "png")}
    for stem in drawn:
        svg, png = ((tmp_path / "pictures" / f"{stem}.{ending}").read_bytes() for ending in ("svg", "png"))
        paths = [part for part in xml.etree.ElementTree.fromstring(svg).iter() if part.tag.endswith(("path", "use"))]
        assert len(paths) > 20 and len(svg) < 100_000, stem
        assert png.startswith(b"\x89PNG") and len(png) > 10_000, stem


@pytest.mark.parametrize("name", NOTEBOOKS)
def test_editors_see_cells_and_no_line_is_too_long(name):
    lines = (FOLDER / name).read_text().splitlines()
    assert lines[0] == "# %% [markdown]" and lines[1].startswith("# # ")
    assert sum(line == "# %%" for line in lines) >= 4 <= sum(line == "# %% [markdown]" for line in lines)
    assert not [line for line in lines if len(line) > 120]


def test_without_ray_a_sweep_goes_on_this_machine_and_pictures_go_into_out(tmp_path):
    """Its page promises so, and that no folder has to be named. Long steps are enough to see it."""
    (tmp_path / "ray.py").write_text("raise ImportError\n")
    source = (FOLDER / "sweep_on_ray.py").read_text()
    assert source.count('"run.step": "0.2 ms"') == 1
    (tmp_path / "sweep.py").write_text(source.replace('"run.step": "0.2 ms"', '"run.step": "2 ms"'))
    package = pathlib.Path(mckibben.__file__).parents[1]
    path = os.pathsep.join([str(tmp_path), str(FOLDER), str(package)])
    done = subprocess.run(
        [sys.executable, "sweep.py"],
        cwd=tmp_path,
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    assert "Ray is not installed" in done.stdout and (tmp_path / "out" / "sweep-map.svg").exists()


@pytest.mark.parametrize("page", ["README.md"])
def test_the_code_of_a_page_runs(page, tmp_path):
    """Its Python blocks, one after the other, in a folder that has the examples."""
    root = pathlib.Path(__file__).parents[2]
    (tmp_path / "examples").symlink_to(root / "examples")
    blocks = re.findall(r"```python\n(.*?)```", (root / page).read_text(), flags=re.DOTALL)
    (tmp_path / "page.py").write_text("import matplotlib\nmatplotlib.use('agg')\n" + "\n".join(blocks))
    done = subprocess.run([sys.executable, "page.py"], cwd=tmp_path, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, f"{done.stdout}\n{done.stderr}"
    assert "length.settled" in done.stdout and (tmp_path / "run.png").stat().st_size > 10_000
