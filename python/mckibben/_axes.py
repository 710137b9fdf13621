"""Axes of Matplotlib to draw into: new ones below each other, or those that the caller gives."""

from __future__ import annotations

import collections.abc
import typing

import numpy

from mckibben.errors import InputError

if typing.TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure


def axes_for(
    ax: collections.abc.Sequence[matplotlib.axes.Axes] | matplotlib.axes.Axes | None,
    count: int,
    remedy: str,
    **options: typing.Any,
) -> tuple[list[matplotlib.axes.Axes], matplotlib.figure.Figure]:
    """So many axes with their figure. `remedy` follows the number of axes where the caller gives others; `options` are those of
    `matplotlib.pyplot.subplots` for new ones, which share the horizontal axis."""
    import matplotlib.pyplot as plt

    if ax is None:
        figure, grid = plt.subplots(count, sharex=True, layout="constrained", squeeze=False, **options)
        return list(grid[:, 0]), figure
    axes = list(numpy.atleast_1d(numpy.asarray(ax, dtype=object)))
    if len(axes) != count:
        raise InputError(f"`ax` has {len(axes)} axes{remedy}")
    return axes, axes[0].figure


def label(name: str, unit: str) -> str:
    """A name with its unit, if there is one."""
    return f"{name} ({unit})" if unit else name
