"""The tables of the package as data classes: the quantities of a scenario, and the named actuators and valves."""

from __future__ import annotations

import dataclasses

from mckibben._mckibben import _parameters, _presets


@dataclasses.dataclass(frozen=True)
class Parameter:
    """A quantity of a scenario."""

    #: The path of its key. In the keys of a file of many actuators `*` stands for a name.
    key: str
    #: What it is.
    meaning: str
    #: The paper's symbol, or the usual one.
    symbol: str
    #: SI unit; empty for a pure number.
    unit: str
    #: The range in words.
    range: str
    #: The ends of the range, `None` where there is none, and whether they are in it.
    minimum: float | None
    minimum_included: bool
    maximum: float | None
    maximum_included: bool
    #: The default in that unit; `None` where it must be given or follows from other keys. A preset may stand in for it.
    default: float | None
    #: Where definition and default come from.
    source: str
    #: What to do where a value is refused.
    remedy: str
    #: An example as a scenario file has it.
    example: str


@dataclasses.dataclass(frozen=True)
class PresetValue:
    """A value of a preset."""

    #: The value in SI, or a word.
    value: float | str
    #: SI unit; empty for a pure number or a word.
    unit: str = ""
    #: The paper's symbol, or the usual one; empty of a word.
    symbol: str = ""
    #: What it is; empty of a word.
    meaning: str = ""
    #: The value as the source writes it; empty of a word.
    text: str = ""
    #: Where it comes from; empty of a word.
    source: str = ""
    #: Whether no source states it.
    assumed: bool = False


@dataclasses.dataclass(frozen=True)
class Preset:
    """A named actuator or valve."""

    #: Its name, which a scenario gives as `preset` of the section.
    name: str
    #: The section: "actuator" or "valve".
    section: str
    #: What it is.
    meaning: str
    #: Its values by the paths of keys.
    values: dict[str, PresetValue]


def parameters() -> dict[str, Parameter]:
    """Quantities of a scenario by the paths of their keys, in the order of the file: what `mckibben schema` says of them.

    Returns
    -------
    dict of str to Parameter
        Those of an antagonist have `antagonist.` before them. In the keys of a file of many actuators `*` stands for a name:
        `actuators.flexor.valve.efficiency` takes what `valve.efficiency` takes, and `supplies.tank.inlet.drop` what
        `supplies.*.inlet.drop` takes.

    Examples
    --------
    >>> import mckibben
    >>> mass = mckibben.parameters()["load.mass"]
    >>> mass.unit, mass.minimum, mass.minimum_included
    ('kg', 0.0, False)
    """
    return {key: Parameter(key=key, **of) for key, of in _parameters().items()}


def presets() -> dict[str, Preset]:
    """Named actuators and valves by their names: what `mckibben presets` shows.

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
