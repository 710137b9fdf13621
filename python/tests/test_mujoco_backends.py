"""MJX and MuJoCo-Warp, which take no plugins, refuse models with muscles and take all others."""

from __future__ import annotations

import pathlib
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).resolve().parents[2]

CODE = """
import importlib
import mujoco
{imports}
from mckibben import InputError

muscles = mujoco.MjModel.from_xml_path("models/elbow.xml")
plain = mujoco.MjModel.from_xml_string("<mujoco><worldbody><body><freejoint/><geom size='0.1'/></body></worldbody></mujoco>")
backend = importlib.import_module("{backend}")
try:
    backend.put_model(muscles)
except InputError as error:
    assert "{backend} takes no plugins" in str(error), error
    print("refused")
print(backend.put_model(plain).nq)
"""


@pytest.mark.parametrize("backend", ["mujoco.mjx", "mujoco_warp"])
@pytest.mark.parametrize("first", ["package", "backend"])
def test_a_backend_without_plugins_refuses_muscles(backend, first):
    """Whichever of the two is imported first."""
    load = "import mckibben.mujoco\nmckibben.mujoco.load()"
    imports = f"{load}\nimport {backend}" if first == "package" else f"import {backend}\n{load}"
    code = CODE.format(imports=imports, backend=backend)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=ROOT)
    lines = done.stdout.splitlines()
    assert "refused" in lines and lines[-1:] == ["7"], done.stdout + done.stderr
