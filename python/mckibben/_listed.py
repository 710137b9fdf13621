"""Lists that are given as arguments."""

from __future__ import annotations

import collections.abc
import typing

Item = typing.TypeVar("Item")


def listed(name: str, items: collections.abc.Iterable[Item]) -> list[Item]:
    """Return the items of an argument as a list; one text is no list of its letters."""
    if isinstance(items, (str, bytes, collections.abc.Mapping)) or not isinstance(items, collections.abc.Iterable):
        raise TypeError(f"`{name}`: a list is wanted and no {type(items).__name__}; give [{items!r}]")
    return list(items)
