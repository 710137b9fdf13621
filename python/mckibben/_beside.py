"""What is done with packages that may be there: pandas, Polars, Matplotlib, JAX. They are imported when asked for."""

from __future__ import annotations

import collections.abc
import math
import typing

from mckibben.errors import InputError

if typing.TYPE_CHECKING:
    import matplotlib.figure
    import pandas
    import polars

    from mckibben import Differentiable, Trajectory


def to_pandas(run: Trajectory) -> pandas.DataFrame:
    """The columns as a data frame, with the units in `attrs`."""
    import pandas

    frame = pandas.DataFrame(run.to_dict())
    frame.attrs["units"] = run.units
    return frame


def to_polars(run: Trajectory) -> polars.DataFrame:
    """The columns as a data frame."""
    import polars

    return polars.DataFrame(run.to_dict())


#: What is drawn below each other: the label, the factor from SI, and the columns with their names in the legend.
_PANELS = (
    ("angle (deg)", 180 / math.pi, {"angle_rad": ""}),
    ("length (mm)", 1e3, {"length_m": ""}),
    ("absolute pressure (bar)", 1e-5, {"pressure_pa": "agonist", "antagonist_pressure_pa": "antagonist"}),
    ("tension (N)", 1.0, {"tension_n": "agonist", "antagonist_tension_n": "antagonist"}),
)


def plot(run: Trajectory) -> matplotlib.figure.Figure:
    """Length, pressure and tension over time; angle, pressures and tensions of a joint."""
    import matplotlib.pyplot as plt

    joint = "angle_rad" in run.columns
    panels = [panel for panel in _PANELS if ("length_m" if joint else "angle_rad") not in panel[2]]
    figure, axes = plt.subplots(len(panels), sharex=True, layout="constrained")
    for axis, (label, factor, columns) in zip(axes, panels):
        for column, name in columns.items():
            if column in run.columns:
                axis.plot(run.t, factor * run[column], label=name if joint else None)
        axis.set_ylabel(label)
    if joint:
        axes[1].legend()
    axes[-1].set_xlabel("time (s)")
    return figure


def for_jax(run: Differentiable) -> collections.abc.Callable[..., typing.Any]:
    """A run as a function of JAX with the derivatives of the simulator."""
    import jax
    import numpy

    if not jax.config.jax_enable_x64:
        raise InputError('JAX counts in 32 bits here: call jax.config.update("jax_enable_x64", True) first')
    shape = (len(run.at), len(run.of))
    value = jax.ShapeDtypeStruct(shape, numpy.float64)
    slopes = jax.ShapeDtypeStruct((*shape, len(run.by)), numpy.float64)

    def simulated(values: typing.Any) -> typing.Any:
        return jax.pure_callback(run, value, values, vmap_method="sequential")

    def forward(primals: typing.Any, tangents: typing.Any) -> typing.Any:
        read, by = jax.pure_callback(run.with_slopes, (value, slopes), primals[0], vmap_method="sequential")
        return read, by @ tangents[0]

    function: typing.Any = jax.custom_jvp(simulated)
    function.defjvp(forward)
    return typing.cast("collections.abc.Callable[..., typing.Any]", function)
