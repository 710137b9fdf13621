"""What the notebooks of this folder share: where the examples lie, where pictures go, and how they look.

python size_a_muscle.py [--out FOLDER]          # else into `out` in the working directory
"""

from __future__ import annotations

import pathlib
import sys

import matplotlib

# A script draws into files alone; a notebook has chosen its own way to show figures by now.
if "ipykernel" not in sys.modules:
    matplotlib.use("Agg")

import matplotlib.figure
import matplotlib.pyplot as plt

#: The scenario files that come with the project.
EXAMPLES = pathlib.Path(__file__).resolve().parents[1]

#: Blue, vermilion, green, purple, orange, sky: distinct also with colour blindness (Okabe & Ito).
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9"]

plt.rcParams.update(
    {
        "axes.edgecolor": "#55585c",
        "axes.grid": True,
        "axes.prop_cycle": plt.cycler(color=COLOURS),
        "axes.spines.right": False,
        "axes.spines.top": False,
        "axes.titlesize": 9,
        "figure.dpi": 110,
        "figure.figsize": (6.2, 3.6),
        "figure.constrained_layout.use": True,
        "font.size": 8.5,
        "grid.color": "#e2e4e6",
        "legend.frameon": False,
        "lines.linewidth": 1.3,
        "savefig.dpi": 150,
        # Letters stay letters, and the same picture has the same bytes.
        "svg.fonttype": "none",
        "svg.hashsalt": "mckibben",
    }
)


def folder() -> pathlib.Path:
    """Where pictures go: what follows `--out`, else `out` in the working directory. It is made if it is not there."""
    given = sys.argv[sys.argv.index("--out") + 1] if "--out" in sys.argv[:-1] else "out"
    path = pathlib.Path(given)
    path.mkdir(parents=True, exist_ok=True)
    return path


def save(figure: matplotlib.figure.Figure, name: str) -> None:
    """Writes a figure as SVG and as PNG."""
    figure.savefig(folder() / f"{name}.svg", metadata={"Date": None})
    figure.savefig(folder() / f"{name}.png")
