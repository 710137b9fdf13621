"""Numbers, counts and scenarios that are given as arguments: what is none is refused by the argument's name."""

from __future__ import annotations

import numbers
import typing

import numpy
from numpy.typing import NDArray

from mckibben._mckibben import Scenario, _si
from mckibben.errors import InputError


def array_of(name: str, given: typing.Any) -> NDArray[numpy.float64]:
    """Return numbers as those of `numbers_of`; what a mask hides is missing, and NaN.

    One text is a quantity with its unit: the name says whether a length, a force or a pressure.
    """
    if isinstance(given, str):
        given = _si(name, given)
    if isinstance(given, numpy.ma.MaskedArray):
        return numpy.where(numpy.ma.getmaskarray(given), numpy.nan, numbers_of(name, numpy.ma.getdata(given)))
    return numbers_of(name, given)


def numbers_of(name: str, given: typing.Any) -> NDArray[numpy.float64]:
    """Return numbers as a new array. Truth values, texts, `None` and what a mask hides are no numbers."""
    if isinstance(given, numpy.ma.MaskedArray) and numpy.ma.getmaskarray(given).any():
        raise InputError(f"`{name}` is a masked array whose mask hides entries; give {name}.filled(…), with numbers in their place")
    remedy = "give a number or an array of numbers in SI"
    try:
        of = numpy.asarray(given)
        # An empty list has no entries of another kind.
        if of.dtype.kind == "O" and all(is_number(item) for item in of.ravel()) and of.size:
            of = of.astype(float)
    except (TypeError, ValueError, RuntimeError, OverflowError) as error:
        raise TypeError(f"`{name}` holds no numbers ({error}); {remedy}") from error
    if of.dtype.kind not in "iuf":
        raise TypeError(f"`{name}` is {f'an array of {of.dtype}' if of.ndim else repr(given)}; {remedy}")
    if _holds_truth(given):
        raise TypeError(f"`{name}` is a list with truth values; {remedy}")
    return of.astype(float)


def _holds_truth(given: typing.Any) -> bool:
    """Return whether a truth value is among the items of a list, where NumPy counts it as 0 or 1."""
    if isinstance(given, (list, tuple)):
        return any(_holds_truth(item) for item in given)
    return isinstance(given, (bool, numpy.bool_))


def whole_of(name: str, given: typing.Any, least: int, most: float, remedy: str) -> int:
    """Return a whole number within bounds. Truth values are none."""
    is_whole = isinstance(given, numbers.Integral) and not isinstance(given, (bool, numpy.bool_))
    if not is_whole or not least <= given <= most:
        raise InputError(f"`{name}` = {given!r} is {'out of range' if is_whole else 'no whole number'}; {remedy}")
    return int(given)


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
