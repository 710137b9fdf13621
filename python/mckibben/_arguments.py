"""Numbers, counts and scenarios that are given as arguments: what is none is refused by the argument's name."""

from __future__ import annotations

import numbers
import typing

import numpy
from numpy.typing import NDArray

from mckibben._mckibben import Scenario, _si


def array_of(name: str, given: typing.Any) -> NDArray[numpy.float64]:
    """Return numbers as an array; what a mask hides is missing, and NaN. Truth values, lists of texts and `None` are no numbers.

    One text is a quantity with its unit: the name says whether a length, a force or a pressure.
    """
    if isinstance(given, str):
        given = _si(name, given)
    of = numpy.asarray(given)
    hidden = numpy.ma.getmaskarray(given) if isinstance(given, numpy.ma.MaskedArray) else False
    if of.dtype.kind == "O" and all(is_number(item) for item in of.ravel()) and of.size:
        of = of.astype(float)
    if of.dtype.kind not in "iuf":
        what = f"an array of {of.dtype}" if of.ndim else repr(given)
        raise TypeError(f"`{name}` is {what}; give a number or an array of numbers in SI")
    return numpy.where(hidden, numpy.nan, of.astype(float))


def is_number(given: typing.Any) -> bool:
    """Return whether this is a number and no truth value."""
    return isinstance(given, numbers.Real) and not isinstance(given, (bool, numpy.bool_))


def check_progress(given: typing.Any) -> None:
    """Refuse what cannot be called with how far work has come."""
    if not (given is None or callable(given)):
        raise TypeError(f"`progress` is of type {type(given).__name__}; give a function, such as print")


def check_scenario(given: typing.Any) -> None:
    """Refuse what is no scenario."""
    if not isinstance(given, Scenario):
        remedy = f"mckibben.Scenario.from_file({given!r})" if isinstance(given, str) else "a mckibben.Scenario"
        raise TypeError(f"`scenario` is of type {type(given).__name__}; give {remedy}")
