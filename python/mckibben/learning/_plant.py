"""Parameters of the plant of a scenario in SI, whether its actuators have names or not."""

from collections.abc import Mapping
from typing import Any

from mckibben._mckibben import Scenario, VectorPlant
from mckibben.errors import InputError
from mckibben.learning._named import JOINT
from mckibben.learning._options import ActionMode

# Sections that `[actuators.NAME]` has in addition to the keys of `[actuator]`.
SECTIONS = ("valve", "hose", "command", "controller", "pressure", "tendon", "load", "initial", "coupling", "supply")
ACTION_MODES: tuple[ActionMode, ...] = ("request", "duty", "position", "set-point")


class Plant:
    """Keys of a scenario by their paths.

    Parameters
    ----------
    scenario
        Any scenario of a plant whose valves can be commanded.

    Raises
    ------
    InputError
        For a plant without a valve.

    Attributes
    ----------
    tree
        The sections as a dictionary; quantities are text, with units as they were written.
    actuators
        The names of the actuators; none where the scenario describes one actuator or an antagonistic joint.
    """

    def __init__(self, scenario: Scenario) -> None:
        self.tree: Mapping[str, Any] = scenario.to_dict()
        self.actuators = list(self.tree.get("actuators", {}))
        # With a step the engine searches for none.
        self._scenario = scenario.with_values({"run.step": "1 ms"})
        self._mode = self._taken()

    def _taken(self) -> ActionMode:
        """Return an action mode that the valves take."""
        for mode in ACTION_MODES:
            try:
                VectorPlant(self._scenario, 1, action_mode=mode)
            except InputError as error:
                refused = error
            else:
                return mode
        raise refused

    def number(self, *paths: str) -> float | None:
        """Return the value in SI of the first of these keys that is a parameter of the plant, or None."""
        for path in paths:
            try:
                return float(VectorPlant(self._scenario, 1, parameters=[path], action_mode=self._mode).defaults[0])
            except InputError:
                continue
        return None

    def numbers(self, path: str) -> list[float]:
        """Return the values in SI of a key that is a parameter or a list of parameters; none where the plant does not have it."""
        given = self.at(path)
        paths = [f"{path}[{place}]" for place in range(len(given))] if isinstance(given, list) else [path]
        return [value for value in map(self.number, paths) if value is not None]

    def angles(self, path: str) -> list[float]:
        """Return the angles in rad of a table; none where there is none."""
        # They are no parameters: the scenario of a joint reads them, whatever their unit.
        joint = Scenario(JOINT)
        read = (joint.with_values({"load.hanging_angle": angle}).to_dict() for angle in self.at(path) or [])
        return [float(sections["load"]["hanging_angle"].partition(" ")[0]) for sections in read]

    def at(self, path: str) -> Any:
        """Return the value at this path as it was written, or None."""
        value: Any = self.tree
        for key in path.split("."):
            value = value.get(key) if isinstance(value, Mapping) else None
        return value

    def section(self, actuator: str, name: str) -> dict[str, Any]:
        """Return a section of an actuator, completed by that of all actuators. The actuator without a name is ""."""
        of_all = self.at(name) or {}
        own = self.at(f"actuators.{actuator}") or {}
        if name == "actuator":
            own = {key: value for key, value in own.items() if key not in SECTIONS}
        else:
            own = own.get(name, {}) if isinstance(own.get(name, {}), Mapping) else {}
        return _merged(of_all, own)

    def mechanisms(self) -> dict[str, Mapping[str, Any]]:
        """Return the sections of the mechanisms by their paths."""
        named = {f"mechanisms.{name}": section for name, section in self.tree.get("mechanisms", {}).items()}
        return named | ({"mechanism": self.tree["mechanism"]} if "mechanism" in self.tree else {})

    def supply_pressure(self, actuator: str = "") -> float | None:
        """Return the gauge pressure in Pa of the supply of an actuator, or None where it has none."""
        own = self.at(f"actuators.{actuator}.supply")
        if isinstance(own, Mapping):
            return self.number(f"actuators.{actuator}.supply.gauge_pressure")
        supplies: Mapping[str, Any] = self.tree.get("supplies", {})
        feeding = {section.get("from") for section in supplies.values()}
        name = own or next(iter([] if "supply" in self.tree else set(supplies) - feeding), "supply")
        # A supply without a pressure has that of the supply that feeds it.
        while name in supplies:
            pressure = self.number(f"supplies.{name}.gauge_pressure") if "gauge_pressure" in supplies[name] else None
            if pressure is not None:
                return pressure
            name = supplies[name].get("from")
        return self.number("supply.gauge_pressure")


def _merged(of_all: Mapping[str, Any], own: Mapping[str, Any]) -> dict[str, Any]:
    """Return a section in which the keys of another replace its own, level by level."""
    merged = dict(of_all)
    for key, value in own.items():
        both = isinstance(value, Mapping) and isinstance(merged.get(key), Mapping)
        merged[key] = _merged(merged[key], value) if both else value
    return merged
