"""Tables of the package as data classes: the quantities of a scenario, and the named actuators and valves."""

from __future__ import annotations

import dataclasses

from mckibben._mckibben import _parameters, _presets


@dataclasses.dataclass(frozen=True)
class Parameter:
    """A quantity of a scenario."""

    #: Path of its key. In the keys of a file of many actuators `*` stands for a name.
    key: str
    #: Its meaning in one sentence.
    meaning: str
    #: Symbol of the paper, or the usual one.
    symbol: str
    #: SI unit; empty for a pure number.
    unit: str
    #: Range in words.
    range: str
    #: Ends of the range, `None` where there is none, and whether they belong to it.
    minimum: float | None
    minimum_included: bool
    maximum: float | None
    maximum_included: bool
    #: Default in that unit; `None` where it must be given or follows from other keys. A preset may replace it.
    default: float | None
    #: Source of definition and default.
    source: str
    #: Remedy where a value is refused.
    remedy: str
    #: Example as a scenario file has it.
    example: str


@dataclasses.dataclass(frozen=True)
class PresetValue:
    """A value of a preset."""

    #: Value in SI, a list of values, or a word.
    value: float | list[float] | str
    #: SI unit; empty for a pure number or a word.
    unit: str = ""
    #: Symbol of the paper, or the usual one; empty for a word.
    symbol: str = ""
    #: Its meaning in one sentence; empty for a word.
    meaning: str = ""
    #: Value as the source writes it; empty for a word.
    text: str = ""
    #: Its source; empty for a word.
    source: str = ""
    #: Whether it is assumed, as no source states it.
    assumed: bool = False


@dataclasses.dataclass(frozen=True)
class Preset:
    """A named actuator or valve."""

    #: Name, which a scenario gives as `preset` of the section.
    name: str
    #: Section: "actuator" or "valve".
    section: str
    #: Its meaning in one sentence.
    meaning: str
    #: Values by the paths of keys.
    values: dict[str, PresetValue]


def parameters() -> dict[str, Parameter]:
    """Return the quantities of a scenario by the paths of their keys, in the order of the file.

    Returns
    -------
    dict of str to Parameter
        Those of an antagonist have `antagonist.` before them. In the keys of a file of many actuators `*` stands for a name:
        `actuators.flexor.valve.efficiency` has the range of `valve.efficiency`, and `supplies.tank.inlet.kv` that of
        `supplies.*.inlet.kv`.

    Examples
    --------
    >>> import mckibben
    >>> mass = mckibben.parameters()["load.mass"]
    >>> mass.unit, mass.minimum, mass.minimum_included
    ('kg', 0.0, False)
    """
    return {key: Parameter(key=key, **of) for key, of in _parameters().items()}


def presets() -> dict[str, Preset]:
    """Return the named actuators and valves of `mckibben presets` by their names.

    Returns
    -------
    dict of str to Preset
        Each number with its unit, its source, and whether it is assumed.

    Examples
    --------
    >>> import mckibben
    >>> mckibben.presets()["colbrunn-2001"].values["actuator.max_length"].text
    '3.85 in'
    """

    def preset(name: str, of: dict[str, object]) -> Preset:
        values = of["values"]
        assert isinstance(values, dict)
        made = {key: PresetValue(**value) for key, value in values.items()}
        return Preset(name=name, section=str(of["section"]), meaning=str(of["meaning"]), values=made)

    return {name: preset(name, of) for name, of in _presets().items()}
