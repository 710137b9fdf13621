"""Functions that need optional packages: pandas, Polars, Matplotlib, JAX, PyTorch. These are imported on use."""

from __future__ import annotations

import collections.abc
import concurrent.futures
import math
import os
import typing

from mckibben._axes import axes_for, label
from mckibben.errors import InputError

if typing.TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure
    import pandas
    import polars

    from mckibben import Differentiable, DifferentiableStep, Trajectory


def to_pandas(run: Trajectory) -> pandas.DataFrame:
    """Return the columns as a data frame of pandas, with the units in `attrs`."""
    import pandas

    frame = pandas.DataFrame(run.to_dict())
    frame.attrs["units"] = run.units
    return frame


def to_polars(run: Trajectory) -> polars.DataFrame:
    """Return the columns as a data frame of Polars."""
    import polars

    return polars.DataFrame(run.to_dict())


#: What is drawn below each other: the label, the factor from SI, and the columns with their names in the legend.
_PANELS = (
    ("angle (deg)", 180 / math.pi, {"angle_rad": ""}),
    ("length (mm)", 1e3, {"length_m": ""}),
    ("absolute pressure (bar)", 1e-5, {"absolute_pressure_pa": "agonist", "antagonist_absolute_pressure_pa": "antagonist"}),
    ("tension (N)", 1.0, {"tension_n": "agonist", "antagonist_tension_n": "antagonist"}),
)


def _panels(run: Trajectory) -> list[tuple[str, float, dict[str, str]]]:
    """Return the panels of a run: label, factor, and the columns with their names in the legend."""
    if "length_m" in run.columns:
        joint = "angle_rad" in run.columns
        panels = [panel for panel in _PANELS if ("length_m" if joint else "angle_rad") not in panel[2]]
        names = [{column: name if joint else "" for column, name in panel[2].items()} for panel in panels]
        return [(label, factor, its) for (label, factor, _), its in zip(panels, names)]
    found = []
    for label, factor, columns in _PANELS:
        ending = "." + next(iter(columns))
        named = {column: column.rpartition(".")[0] for column in run.columns if column.endswith(ending)}
        found += [(label, factor, named)] if named else []
    return found


def plot(
    run: Trajectory,
    columns: collections.abc.Sequence[str] | None = None,
    ax: collections.abc.Sequence[matplotlib.axes.Axes] | None = None,
) -> matplotlib.figure.Figure:
    """Draw columns over time, in a panel for each; by default angle or length, pressure and tension."""
    if columns is None:
        panels = _panels(run)
    else:
        if not columns:
            raise InputError("`columns` is empty: name what is to be drawn, or leave it out")
        panels = [(label(name, run.units.get(name, "")), 1.0, {name: ""}) for name in columns]
    remedy, size = f" for {len(panels)} panels; give one for each", (6.4, 0.6 + 2.0 * len(panels))
    axes, figure = axes_for(ax, len(panels), remedy, figsize=size)
    for axis, (title, factor, its) in zip(axes, panels):
        drawn = [(run[column], name) for column, name in its.items() if columns is not None or column in run.columns]
        for values, name in drawn:
            values = values if values.dtype.kind == "U" else factor * values
            axis.plot(run.t, values, label=name or None)
        axis.set_ylabel(title)
        if any(name for _, name in drawn):
            axis.legend()
    axes[-1].set_xlabel("time (s)")
    return figure


def _over_batches(
    function: collections.abc.Callable[..., typing.Any], shapes: collections.abc.Sequence[tuple[int, ...]], width: int
) -> collections.abc.Callable[..., typing.Any]:
    """Return a function of arrays of sets of values, from that of one set; threads of this process evaluate it in parallel.

    `shapes` are those of its results for one set of `width` values: a batch may be empty.
    """
    import numpy

    def over(values: typing.Any) -> typing.Any:
        values = numpy.asarray(values, dtype=float)
        if values.ndim == 1:
            return function(values)
        batch = values.shape[:-1]
        if values.shape[-1] != width:
            raise InputError(f"sets of {values.shape[-1]} values were given for {width} arguments; give {width} in the last dimension")
        if 0 in batch:
            empty = tuple(numpy.zeros((*batch, *shape)) for shape in shapes)
            return empty if len(empty) > 1 else empty[0]
        with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
            found = list(pool.map(function, values.reshape(-1, values.shape[-1])))

        def stacked(parts: collections.abc.Sequence[typing.Any]) -> typing.Any:
            return numpy.stack(parts).reshape(*batch, *parts[0].shape)

        return tuple(stacked(parts) for parts in zip(*found)) if isinstance(found[0], tuple) else stacked(found)

    return over


def for_jax(
    run: Differentiable | DifferentiableStep, shape: tuple[int, ...], width: int
) -> collections.abc.Callable[..., typing.Any]:
    """Return a run or a step as a function of JAX with the derivatives of the simulator; those of a `vmap` use all cores.

    `shape` is that of its result, and `width` the number of its arguments.
    """
    import jax
    import numpy

    if not jax.config.jax_enable_x64:
        raise InputError('JAX counts in 32 bits here: call jax.config.update("jax_enable_x64", True) first')
    value = jax.ShapeDtypeStruct(shape, numpy.float64)
    slopes = jax.ShapeDtypeStruct((*shape, width), numpy.float64)
    shapes = [shape, (*shape, width)]
    values_of, both_of = _over_batches(run, shapes[:1], width), _over_batches(run.value_and_jacobian, shapes, width)

    def simulated(values: typing.Any) -> typing.Any:
        return jax.pure_callback(values_of, value, values, vmap_method="expand_dims")

    def forward(primals: typing.Any, tangents: typing.Any) -> typing.Any:
        read, by = jax.pure_callback(both_of, (value, slopes), primals[0], vmap_method="expand_dims")
        return read, by @ tangents[0]

    function: typing.Any = jax.custom_jvp(simulated)
    function.defjvp(forward)
    return typing.cast("collections.abc.Callable[..., typing.Any]", function)


def for_torch(
    run: Differentiable | DifferentiableStep, shape: tuple[int, ...], width: int
) -> collections.abc.Callable[..., typing.Any]:
    """Return a run or a step as a function of a tensor of PyTorch with the derivatives of the simulator.

    `shape` is that of its result, and `width` the number of its arguments. Those of a `vmap`, or of leading dimensions of the
    tensor, use all cores.
    """
    import torch

    both_of = _over_batches(run.value_and_jacobian, [shape, (*shape, width)], width)

    # Types of PyTorch change from one version to the next, and it need not be there.
    Function: typing.Any = torch.autograd.Function

    class Slopes(Function):  # type: ignore[misc]
        """Jacobian whose own derivative is refused: the simulator has no second derivatives, and they are not zero."""

        generate_vmap_rule = True

        @staticmethod
        def forward(values: typing.Any, slopes: typing.Any) -> typing.Any:
            return slopes.clone()

        @staticmethod
        def setup_context(context: typing.Any, inputs: typing.Any, output: typing.Any) -> None:
            pass

        @staticmethod
        def backward(context: typing.Any, *along: typing.Any) -> typing.Any:
            raise InputError("a run has no second derivatives: differentiate it once")

        @staticmethod
        def jvp(context: typing.Any, *along: typing.Any) -> typing.Any:
            raise InputError("a run has no second derivatives: differentiate it once")

    class Simulated(Function):  # type: ignore[misc]
        """Values and Jacobian of a run, or of a batch of runs."""

        @staticmethod
        def forward(values: typing.Any) -> typing.Any:
            both = both_of(values.detach().cpu().numpy())
            return tuple(torch.from_numpy(array).to(values.device) for array in both)

        @staticmethod
        def setup_context(context: typing.Any, inputs: typing.Any, output: typing.Any) -> None:
            context.mark_non_differentiable(output[1])
            context.save_for_backward(inputs[0], output[1])
            context.save_for_forward(inputs[0], output[1])

        @staticmethod
        def backward(context: typing.Any, along: typing.Any, _: typing.Any) -> typing.Any:
            slopes = Slopes.apply(*context.saved_tensors)
            flat = along.flatten(-len(shape)), slopes.flatten(-len(shape) - 1, -2)
            return torch.einsum("...m,...mp->...p", *flat)

        @staticmethod
        def jvp(context: typing.Any, along: typing.Any) -> typing.Any:
            slopes = Slopes.apply(*context.saved_tensors)
            return (slopes @ along.reshape(*along.shape[:-1], *[1] * (len(shape) - 1), -1, 1)).squeeze(-1), None

        @staticmethod
        def vmap(info: typing.Any, in_dims: typing.Any, values: typing.Any) -> typing.Any:
            return Simulated.apply(values.movedim(in_dims[0], 0)), (0, 0)

    def simulated(values: typing.Any) -> typing.Any:
        if values.dtype != torch.float64:
            raise InputError(f"the values are {values.dtype}: give a tensor with dtype=torch.float64")
        return Simulated.apply(values)[0]

    return simulated
