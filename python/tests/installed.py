"""Tries the installed package as a new user would, in an environment that has it and NumPy alone.

Run by the check and by `cargo xtask dist` where there is no Cargo; no test of pytest.
"""

import pathlib
import shutil
import sys

import mckibben

assert shutil.which("cargo") is None, "this is to be tried without Cargo"
assert pathlib.Path(mckibben.__file__).is_relative_to(sys.prefix), f"{mckibben.__file__} is not the installed package"
run = mckibben.simulate(mckibben.Scenario.from_file(sys.argv[1]))
# 5 lb at 100 psi and half a duty of 25 Hz: the paper's muscle is between its ends and bears its load on average.
assert 0.06 < run.length[-1] < 0.10 and abs(run.tension[-1] - 5 * 0.45359237 * 9.80665) < 20.0
print(f"mckibben {mckibben.__version__}, {len(run.t)} samples, {1e3 * run.length[-1]:.2f} mm at the end")
