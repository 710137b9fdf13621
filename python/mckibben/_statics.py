"""Static force of an actuator and its inverses on arrays, and its curves."""

from __future__ import annotations

import collections.abc
import typing

import numpy
from numpy.typing import ArrayLike, NDArray

from mckibben._arguments import array_of
from mckibben._mckibben import Scenario, _curves, _Statics
from mckibben.errors import InputError

if typing.TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure
    import pandas

Numbers = NDArray[numpy.float64]


class Statics:
    """The actuator of a scenario at rest, without friction: force, stiffness, volume, and what pressure or length a force needs.

    Arguments are numbers or arrays in SI that are broadcast against each other as by NumPy; pressures are gauge pressures in Pa.
    A single quantity may be text with its unit, such as "85 mm", "2 bar" or "20 N".
    A result is NaN where the actuator does not reach: beyond its shortest and longest length, or beyond the supply's pressure. It
    is also NaN where an argument is, or is masked, so that what an inverse has returned can be passed on; infinite arguments are
    refused.

    Parameters
    ----------
    scenario : Scenario
        One actuator, or a joint, whose agonist counts.

    Examples
    --------
    >>> import mckibben
    >>> statics = mckibben.Statics(mckibben.Scenario('''
    ... [actuator]
    ... preset = "colbrunn-2001"
    ... [supply]
    ... gauge_pressure = "100 psi"
    ... [load]
    ... kind = "isometric"
    ... [initial]
    ... length = "3.4 in"
    ... [run]
    ... duration = "1 s"
    ... '''))
    >>> pressure = statics.gauge_pressure_for(length=[0.075, 0.085], force=22.0)
    >>> statics.force([0.075, 0.085], pressure).round(6)
    array([22., 22.])
    """

    def __init__(self, scenario: Scenario) -> None:
        self._of = _Statics(scenario)
        self._scenario = scenario

    def __reduce__(self) -> tuple[type[Statics], tuple[Scenario]]:
        return type(self), (self._scenario,)

    @property
    def scenario(self) -> Scenario:
        """The scenario that the actuator is of."""
        return self._scenario

    @property
    def min_length(self) -> float:
        """Shortest length in m."""
        return self._of.reach[0]

    @property
    def max_length(self) -> float:
        """Longest length in m, at which the braid is taut."""
        return self._of.reach[1]

    @property
    def supply_gauge_pressure(self) -> float | None:
        """Gauge pressure of the scenario's supply in Pa; `None` without a supply."""
        return self._of.supply

    def force(self, length: ArrayLike, gauge_pressure: ArrayLike) -> Numbers:
        """Tension in N, zero where the braid would push.

        Parameters
        ----------
        length : array_like
            Distance between the ends in m.
        gauge_pressure : array_like
            Gauge pressure in Pa.

        Returns
        -------
        numpy.ndarray
            Of the common shape; NaN out of reach.
        """
        return self._both(self._of.force, length=length, gauge_pressure=gauge_pressure)

    def stiffness(self, length: ArrayLike, gauge_pressure: ArrayLike, *, sealed: bool = False) -> Numbers:
        """Return the stiffness at constant pressure, equation (7), or with the valve shut, equation (5).

        Parameters
        ----------
        length : array_like
            Distance between the ends in m.
        gauge_pressure : array_like
            Gauge pressure in Pa.
        sealed : bool, optional
            Whether the valve is shut. False by default.

        Returns
        -------
        numpy.ndarray
            Stiffness in N/m, of the common shape; NaN out of reach.
        """
        return self._both(self._of.sealed_stiffness if sealed else self._of.stiffness, length=length, gauge_pressure=gauge_pressure)

    def volume(self, length: ArrayLike) -> Numbers:
        """Return the volume of the air, in the braid and outside it.

        Parameters
        ----------
        length : array_like
            Distance between the ends in m.

        Returns
        -------
        numpy.ndarray
            Volume in m^3, of the shape of `length`; NaN out of reach.
        """
        lengths = array_of("length", length)
        return self._of.volume(lengths.ravel()).reshape(lengths.shape)

    def gauge_pressure_for(
        self, length: ArrayLike, force: ArrayLike, *, max_gauge_pressure: float | str | None = None
    ) -> Numbers:
        """The least gauge pressure in Pa at which the actuator bears a force at a length.

        Parameters
        ----------
        length : array_like
            Distance between the ends in m.
        force : array_like
            Tension in N, zero or above.
        max_gauge_pressure : float or str, optional
            The highest gauge pressure in Pa, or text with a unit; that of the scenario's supply unless given.

        Returns
        -------
        numpy.ndarray
            Of the common shape; NaN where no pressure up to the highest is enough, or out of reach.

        Raises
        ------
        InputError
            The scenario has no supply, and no highest pressure is given.
        """
        most = self.supply_gauge_pressure if max_gauge_pressure is None else max_gauge_pressure
        if most is None:
            raise InputError("the scenario has no supply; give `max_gauge_pressure` in Pa")
        return self._both(lambda first, second: self._of.gauge_pressure_for(first, second, most), length=length, force=force)

    def length_for(self, gauge_pressure: ArrayLike, force: ArrayLike) -> Numbers:
        """Return the length at which the actuator bears a force at a gauge pressure.

        Parameters
        ----------
        gauge_pressure : array_like
            Gauge pressure in Pa.
        force : array_like
            Tension in N, zero or above.

        Returns
        -------
        numpy.ndarray
            Length in m, of the common shape; NaN where the actuator pulls harder even at its shortest length, or bears less at
            its longest.
        """
        return self._both(self._of.length_for, gauge_pressure=gauge_pressure, force=force)

    @staticmethod
    def _both(function: collections.abc.Callable[..., Numbers], **arguments: ArrayLike) -> Numbers:
        pair = numpy.broadcast_arrays(*(array_of(name, given) for name, given in arguments.items()))
        return function(*(numpy.ravel(of) for of in pair)).reshape(pair[0].shape)

    def __repr__(self) -> str:
        ends = f"{1e3 * self.min_length:.1f} to {1e3 * self.max_length:.1f} mm"
        return f"<mckibben.Statics of {self._scenario.name!r}, {ends}>"


class Curves(collections.abc.Mapping[str, Numbers]):
    """Force, stiffness and volume over length at several gauge pressures: arrays by their names.

    Each array has a row for each gauge pressure and a column for each length, from the shortest to the longest; its name ends
    with its unit. `stiffness_n_m` is at constant pressure, equation (7); `sealed_stiffness_n_m` with the valve shut, (5).
    """

    def __init__(self, arrays: collections.abc.Mapping[str, Numbers]) -> None:
        self._arrays = dict(arrays)

    def __getitem__(self, name: str) -> Numbers:
        if name not in self._arrays:
            raise KeyError(f"there is no `{name}` but {', '.join(self._arrays)}")
        return self._arrays[name]

    def __iter__(self) -> collections.abc.Iterator[str]:
        return iter(self._arrays)

    def __len__(self) -> int:
        return len(self._arrays)

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, Curves):
            return NotImplemented
        names = list(self)
        return names == list(other) and all(numpy.array_equal(self[name], other[name], equal_nan=True) for name in names)

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        pressures, lengths = self["length_m"].shape
        return f"<mckibben.Curves, {pressures} gauge pressures and {lengths} lengths: {', '.join(self)}>"

    def to_pandas(self) -> pandas.DataFrame:
        """Return a tidy frame.

        Returns
        -------
        pandas.DataFrame
            A row for each gauge pressure and length.
        """
        import pandas

        return pandas.DataFrame({name: values.ravel() for name, values in self._arrays.items()})

    def plot(
        self,
        column: str = "force_n",
        over: str = "length_m",
        ax: matplotlib.axes.Axes | None = None,
    ) -> matplotlib.figure.Figure:
        """A column over another, a line for each gauge pressure.

        Parameters
        ----------
        column, over : str, optional
            Names of columns.
        ax : matplotlib.axes.Axes, optional
            Axes to draw into.

        Returns
        -------
        matplotlib.figure.Figure
        """
        import matplotlib.pyplot as plt

        axes = plt.subplots(layout="constrained")[1] if ax is None else ax
        for gauge, x, y in zip(self["gauge_pressure_pa"][:, 0], self[over], self[column]):
            axes.plot(x, y, label=f"{1e-5 * gauge:.3g} bar")
        axes.set_xlabel(over)
        axes.set_ylabel(column)
        axes.legend(title="gauge pressure")
        figure = axes.get_figure()
        assert figure is not None
        return typing.cast("matplotlib.figure.Figure", figure)


def curves(scenario: Scenario, gauge_pressures: ArrayLike | str | None = None) -> Curves:
    """Force, stiffness and volume of a scenario's actuator over length, at rest: the table of `mckibben curves`.

    Parameters
    ----------
    scenario : Scenario
        One actuator.
    gauge_pressures : array_like or str, optional
        Numbers in Pa, or text such as "35, 45, 55 psi". By default round ones up to the greatest of the
        scenario: that of its supply, its given pressure or its start.

    Returns
    -------
    Curves
        Arrays by their names; `to_pandas` makes a tidy frame of them.

    Raises
    ------
    InputError
        The scenario or a pressure is wrong.
    """
    return Curves(_curves(scenario, gauge_pressures))
