"""Sections of a scenario as attributes, what differs between two, and a table for notebooks."""

from __future__ import annotations

import collections.abc
import html
import typing

from mckibben._mckibben import _quantity

if typing.TYPE_CHECKING:
    from mckibben import Scenario


def _value(value: typing.Any) -> typing.Any:
    """A value as an attribute has it: a quantity as a number in SI, a section as a `Section`."""
    if isinstance(value, dict):
        return Section(value)
    if isinstance(value, list):
        return [_value(item) for item in value]
    if isinstance(value, str):
        number = _quantity(value)
        return value if number is None else number
    return value


class Section(collections.abc.Mapping[str, typing.Any]):
    """A section of a scenario: `scenario.load.mass` is a number in SI, `scenario.load.kind` a word.

    It is a mapping too, for names that are no identifiers: `scenario.actuators["knee-back"]`. It cannot be changed; a scenario
    with other values is made by `Scenario.with_values`.
    """

    def __init__(self, values: dict[str, typing.Any]) -> None:
        self._values = values

    def __getitem__(self, name: str) -> typing.Any:
        return _value(self._values[name])

    def __getattr__(self, name: str) -> typing.Any:
        if name.startswith("_") or name not in self._values:
            raise AttributeError(f"the section has no `{name}`; it has {', '.join(self._values)}")
        return self[name]

    def __iter__(self) -> collections.abc.Iterator[str]:
        return iter(self._values)

    def __len__(self) -> int:
        return len(self._values)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._values]

    def __repr__(self) -> str:
        return "\n".join(f"{path} = {value!r}" for path, value in _flat(self._values))


def _flat(values: dict[str, typing.Any], above: str = "") -> collections.abc.Iterator[tuple[str, typing.Any]]:
    """Paths of keys with their values."""
    for name, value in values.items():
        if isinstance(value, dict):
            yield from _flat(value, f"{above}{name}.")
        else:
            yield above + name, value


def attribute(scenario: Scenario, name: str) -> typing.Any:
    """A section or value of a scenario by its name."""
    values = {} if name.startswith("_") else scenario.to_dict()
    if name not in values:
        raise AttributeError(f"the scenario has no section `{name}`; it has {', '.join(values)}")
    return _value(values[name])


def names(scenario: Scenario) -> list[str]:
    """What a scenario has by a point: its methods, and its sections."""
    return [*object.__dir__(scenario), *scenario.to_dict()]


def diff(scenario: Scenario, other: Scenario) -> dict[str, tuple[typing.Any, typing.Any]]:
    """What differs between two scenarios: the values of both by the paths of keys, `None` where there is none."""
    here, there = dict(_flat(scenario.to_dict())), dict(_flat(other.to_dict()))
    paths = dict.fromkeys([*here, *there])
    return {path: (here.get(path), there.get(path)) for path in paths if here.get(path) != there.get(path)}


def to_html(scenario: Scenario) -> str:
    """A scenario as a table, a row for each key."""
    rows = []
    for name, section in scenario.to_dict().items():
        keys = list(_flat(section)) if isinstance(section, dict) else [("", section)]
        for place, (path, value) in enumerate(keys):
            head = f'<th rowspan="{len(keys)}" style="vertical-align: top">{html.escape(name)}</th>' if place == 0 else ""
            rows.append(f"<tr>{head}<td>{html.escape(path)}</td><td>{html.escape(str(value))}</td></tr>")
    return f"<table><caption>{html.escape(scenario.name)}</caption>{''.join(rows)}</table>"
