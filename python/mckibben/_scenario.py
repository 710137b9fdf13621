"""Sections of a scenario as attributes, the difference of two scenarios, and a table for notebooks."""

from __future__ import annotations

import collections.abc
import html
import typing

from mckibben._mckibben import _quantity

if typing.TYPE_CHECKING:
    from mckibben import Scenario


def _value(value: typing.Any, path: str) -> typing.Any:
    """Return the value of an attribute at a path: a quantity as a number in SI, a section as a `Section`."""
    if isinstance(value, dict):
        return Section(value, path)
    if isinstance(value, list):
        return [_value(item, f"{path}[{place}]") for place, item in enumerate(value)]
    if isinstance(value, str):
        number = _quantity(value)
        return value if number is None else number
    return value


class Section(collections.abc.Mapping[str, typing.Any]):
    """A section of a scenario: `scenario.load.mass` is a number in SI, `scenario.load.kind` a word.

    It is also a mapping, for names that are no identifiers: `scenario.actuators["knee-back"]`. It is immutable; use
    `Scenario.with_values` to make a scenario with other values.
    """

    _values: dict[str, typing.Any]
    _path: str

    def __init__(self, values: dict[str, typing.Any], path: str) -> None:
        # A section refuses to be changed, so its own attributes are set past `__setattr__`.
        self.__dict__.update(_values=values, _path=path)

    def __getitem__(self, name: str) -> typing.Any:
        return _value(self._values[name], f"{self._path}.{name}")

    def __getattr__(self, name: str) -> typing.Any:
        # Pickle and copy look for methods before there are values.
        if name.startswith("_"):
            raise AttributeError(f"a section has no attribute `{name}`")
        if name not in self._values:
            raise AttributeError(f"the section has no `{name}`; it has {', '.join(self._values)}")
        return self[name]

    def __setattr__(self, name: str, value: typing.Any) -> typing.NoReturn:
        path = f"{self._path}.{name}"
        raise AttributeError(
            f"`{path}` cannot be set, as a scenario is immutable; make another one by "
            f'`scenario.with_values({{"{path}": {value!r}}})`'
        )

    def __delattr__(self, name: str) -> typing.NoReturn:
        raise AttributeError(f"`{self._path}.{name}` cannot be deleted, as a scenario is immutable; make one without it")

    def __reduce__(self) -> tuple[type[Section], tuple[dict[str, typing.Any], str]]:
        return Section, (self._values, self._path)

    def __iter__(self) -> collections.abc.Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._values]

    def __repr__(self) -> str:
        return "\n".join(f"{path} = {value!r}" for path, value in _flat(self._values))


def _flat(values: dict[str, typing.Any], above: str = "") -> collections.abc.Iterator[tuple[str, typing.Any]]:
    """Yield the paths of keys with their values."""
    for name, value in values.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{above}{name}.")
        else:
            yield above + name, value


def attribute(sections: dict[str, typing.Any], name: str) -> typing.Any:
    """Return a section or value of a scenario by its name."""
    if name.startswith("_") or name not in sections:
        raise AttributeError(f"the scenario has no section `{name}`; it has {', '.join(sections)}")
    return _value(sections[name], name)


def names(scenario: Scenario, sections: dict[str, typing.Any]) -> list[str]:
    """Return the names of the attributes of a scenario: its methods and its sections."""
    return [*object.__dir__(scenario), *sections]


def diff(here: dict[str, typing.Any], there: dict[str, typing.Any]) -> dict[str, tuple[typing.Any, typing.Any]]:
    """Return the values in which two scenarios differ by the paths of their keys; `None` where one has no such key."""
    ours, theirs = dict(_flat(here)), dict(_flat(there))
    paths = dict.fromkeys([*ours, *theirs])
    return {path: (ours.get(path), theirs.get(path)) for path in paths if ours.get(path) != theirs.get(path)}


def to_html(title: str, sections: dict[str, typing.Any]) -> str:
    """Return a scenario as a table of HTML with a row for each key."""
    rows = []
    for name, section in sections.items():
        keys = list(_flat(section)) if isinstance(section, dict) else [("", section)]
        for place, (path, value) in enumerate(keys):
            head = f'<th rowspan="{len(keys)}" style="vertical-align: top">{html.escape(name)}</th>' if place == 0 else ""
            rows.append(f"<tr>{head}<td>{html.escape(path)}</td><td>{html.escape(str(value))}</td></tr>")
    return f"<table><caption>{html.escape(title)}</caption>{''.join(rows)}</table>"
