"""Checks the poles and the shapes of linear models against NumPy and SciPy.

    mckibben linearize FILE --output model.json
    python linear_model.py model.json …

Prints the largest disagreement of each file, and fails above one part in 10⁹ of the fastest pole.
"""

import json
import sys

import numpy as np
from scipy.linalg import eigvals, matrix_balance
from scipy.signal import StateSpace

TOLERANCE = 1e-9


def disagreement(model):
    """Largest distance from a pole to its nearest eigenvalue, each used once, over the fastest."""
    a, b, c, d = (np.array(model[name], dtype=float) for name in "ABCD")
    StateSpace(a, b, c, d)  # refuses matrices that do not fit together
    assert a.shape[0] == len(model["states"]) and b.shape[1] == len(model["inputs"])
    assert c.shape[0] == len(model["outputs"])
    ours = [complex(p["real_1_s"], p["imaginary_rad_s"]) for p in model["poles"]]
    theirs = list(eigvals(matrix_balance(a)[0]))
    assert len(ours) == len(theirs)
    scale = max(abs(pole) for pole in theirs) or 1.0
    worst = 0.0
    for pole in ours:
        nearest = min(theirs, key=lambda other: abs(other - pole))
        theirs.remove(nearest)
        worst = max(worst, abs(nearest - pole) / scale)
    return worst


def main(paths):
    failed = False
    for path in paths:
        with open(path, encoding="utf-8") as file:
            worst = disagreement(json.load(file))
        failed |= not worst <= TOLERANCE
        print(f"{path}: {worst:.1e}")
    return int(failed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
