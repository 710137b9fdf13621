"""The plugin in a program in C: `crates/mckibben-mujoco/examples/step.c`, under Valgrind and with sanitizers."""

from __future__ import annotations

import os
import pathlib
import subprocess

import mujoco

ROOT = pathlib.Path(__file__).resolve().parents[2]
MODELS = [f"models/{name}.xml" for name in ("elbow", "arm", "leg", "hanging-mass")]


def program(folder: pathlib.Path, *flags: str) -> list[str]:
    """The example compiled against the MuJoCo of this Python, with the plugin and the models as its arguments."""
    home = pathlib.Path(mujoco.__file__).parent
    library = home / f"libmujoco.so.{mujoco.__version__}"
    source, built = ROOT / "crates/mckibben-mujoco/examples/step.c", folder / "step"
    compiler = ["cc", "-std=c11", "-O1", "-g", "-Wall", "-Wextra", "-Wpedantic", "-Werror", *flags]
    subprocess.run([*compiler, "-I", home / "include", source, "-o", built, library, f"-Wl,-rpath,{home}"], check=True)
    plugin = os.environ.get("MCKIBBEN_MUJOCO", str(ROOT / "target/debug/libmckibben_mujoco.so"))
    return [str(built), plugin, *MODELS]


def run(command: list[str]) -> None:
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT)
    assert done.returncode == 0, done.stdout + done.stderr
    lines = done.stdout.splitlines()
    for model in MODELS:
        assert any(line.startswith(f"{model}: ") for line in lines), done.stdout
    assert "refused: Error: unrecognized attribute 'plugin:muscle.thread_lenght'" in done.stdout
    assert "initial.gauge_pressure" in done.stdout and "-3 bar" in done.stdout, done.stdout


def test_valgrind_finds_no_invalid_access_and_no_leak(tmp_path):
    # Optimised, an enum is compared before its kind is looked at, which Valgrind takes for a jump on a value never written.
    checks = ["--quiet", "--error-exitcode=9", "--leak-check=full", "--undef-value-errors=no"]
    run(["valgrind", *checks, *program(tmp_path)])


def test_sanitizers_of_the_compiler_find_nothing(tmp_path):
    run(program(tmp_path, "-fsanitize=address,undefined", "-fno-sanitize-recover=all"))
