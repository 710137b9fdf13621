"""Braided pneumatic actuators in MuJoCo: the plugin, models of muscles, and a loop around `mj_step`.

>>> import mckibben.mujoco, mujoco
>>> mckibben.mujoco.load()
>>> muscle = mckibben.mujoco.muscle_mjcf(
...     {"muscle": ["anchor", "hook"]},
...     keys={"supply.gauge_pressure": "100 psi", "valve.preset": "matrix-eight-channel"},
...     pulse_frequency="25 Hz",
... )
>>> model = mujoco.MjModel.from_xml_string(f'''
... <mujoco>
...   {muscle}
...   <worldbody>
...     <site name="anchor" pos="0 0 0.2"/>
...     <body pos="0 0 0.11">
...       <joint type="slide" axis="0 0 1"/>
...       <geom type="sphere" size="0.02" mass="2"/>
...       <site name="hook"/>
...     </body>
...   </worldbody>
... </mujoco>''')
>>> data = mujoco.MjData(model)
>>> data.ctrl[0] = 0.8
>>> while data.time < 0.5:
...     mujoco.mj_step(model, data)
>>> bool(data.qpos[0] > 0.01)
True
"""

import importlib
import importlib.abc
import importlib.util
import math
import numbers
import os
import sys
import types
from collections.abc import Mapping, Sequence
from typing import Any, Literal
from xml.sax.saxutils import quoteattr

import numpy
from numpy.typing import NDArray

from mckibben._arguments import numbers_of
from mckibben._mckibben import HostedPlant, Scenario, _register_mujoco
from mckibben._motors import addresses, check_actuation, check_motor
from mckibben._tables import parameters
from mckibben.errors import InputError, SimulationError

PLUGIN = "mckibben.muscle"
"""Name by which a model refers to the plugin."""

__all__ = ["PLUGIN", "Driver", "load", "muscle_mjcf"]


def load() -> None:
    """Register the plugin with the MuJoCo of this process.

    MuJoCo 4.0 and later calls this when it is imported; with older versions call it before a model is read. A second call
    changes nothing. From then on MJX and MuJoCo-Warp, which take no plugins and would give no force, refuse models with
    these muscles.

    Raises
    ------
    InputError
        MuJoCo is not installed, is of a version that the plugin does not know, or computes in single precision.
    """
    mujoco = _mujoco()
    if getattr(mujoco, "MJTNUM_BYTES", 8) != 8:
        raise InputError("this MuJoCo computes in single precision: install the wheel of PyPI, which computes in double")
    _register_mujoco()
    for name in _BACKENDS:
        if name in sys.modules:
            _refuse_muscles(sys.modules[name], name)
    if not any(isinstance(finder, _Backends) for finder in sys.meta_path):
        sys.meta_path.insert(0, _Backends())


def muscle_mjcf(
    muscles: Mapping[str, Sequence[str]],
    *,
    scenario: str | os.PathLike[str] | Scenario | None = None,
    keys: Mapping[str, str | float] | None = None,
    instance: str = "muscles",
    sensors: str | Sequence[str] = ("gauge_pressure", "tension"),
    command_mode: str | None = None,
    pulse_frequency: str | float | None = None,
    max_step: str | float | None = None,
    length_offset: str | float | None = None,
    max_length: float | None = None,
    width: float = 0.01,
) -> str:
    """Return MJCF of muscles between sites, which share one air network.

    The text has the sections of a model, to be put inside `<mujoco>`: the instance of the plugin, a spatial tendon through the
    sites of each muscle, an actuator with its gauge pressure in `act`, and sensors.

    Parameters
    ----------
    muscles : mapping of str to sequence of str
        Sites of each muscle, from one end to the other, by its name in the scenario; a muscle alone may have any name.
    scenario : str, os.PathLike or Scenario, optional
        Path of a scenario file, which the model then refers to, or a scenario, whose text the model then holds. By default
        one muscle that `keys` describe.
    keys : mapping of str to str or float, optional
        Values of keys of a scenario file by their paths: {"supply.gauge_pressure": "100 psi"}. A number is in SI.
    instance : str, optional
        Name of the instance of the plugin.
    sensors : str or sequence of str, optional
        Quantities to be sensed of each muscle: "gauge_pressure", "tension", "contraction", "mass_flow" and others.
    command_mode : str, optional
        What `ctrl` is, as the attribute of the plugin.
    pulse_frequency, max_step, length_offset : str or float, optional
        As the attributes of the plugin, as text with a unit or as a number in SI: the frequency of pulses ("25 Hz"), the longest
        part of a step ("0.5 ms"), and what is added to the length of a tendon for the distance between the ends of its muscle
        ("-30 mm").
    max_length : float, optional
        Longest length of the tendons in m, above zero, kept by MuJoCo's own limit. Above some milliseconds of time step the taut
        braid is too stiff for MuJoCo's integrators, and this keeps the muscle from becoming taut.
    width : float, optional
        Width in m with which tendons are drawn, zero or more.

    Returns
    -------
    str

    Raises
    ------
    InputError
        There is no muscle, a muscle has fewer than two sites or no name, or a value is out of range.
    """
    if not isinstance(muscles, Mapping) or not muscles:
        raise InputError(f"muscles = {muscles!r} has no muscle: give the sites of each by its name, such as {_MUSCLES}")
    for name, sites in muscles.items():
        if not name or isinstance(sites, str) or len(sites) < 2:
            raise InputError(f"muscle {name!r} goes through {sites!r}: give it a name and two sites or more")
    if not instance:
        raise InputError("instance = '': give the instance of the plugin a name, such as \"muscles\"")
    sensors = [sensors] if isinstance(sensors, str) else sensors
    config = {key: _written(f"keys[{key!r}]", value, _unit(key)) for key, value in (keys or {}).items()}
    if isinstance(scenario, Scenario):
        # Values of presets that were written out would outweigh a preset among the keys.
        config["scenario_text"] = scenario._given()
    elif scenario is not None:
        config["scenario"] = os.fspath(scenario)
    own = {
        "command_mode": command_mode,
        "pulse_frequency": pulse_frequency,
        "max_step": max_step,
        "length_offset": length_offset,
    }
    config |= {key: _written(key, value, _UNITS.get(key, "")) for key, value in own.items() if value is not None}
    lines = ["<extension>", f"  <plugin plugin={quoteattr(PLUGIN)}>", f"    <instance name={quoteattr(instance)}>"]
    lines += [f"      <config key={quoteattr(key)} value={_attribute(value)}/>" for key, value in config.items()]
    lines += ["    </instance>", "  </plugin>", "</extension>", "<tendon>"]
    drawn = _metres("width", width, "zero or more", lambda width: width >= 0.0)
    limit = ""
    if max_length is not None:
        limit = f' limited="true" range="0 {_metres("max_length", max_length, "above zero", lambda most: most > 0.0)}"'
    for name, sites in muscles.items():
        lines.append(f'  <spatial name={quoteattr(name)} width="{drawn}"{limit}>')
        lines += [f"    <site site={quoteattr(site)}/>" for site in sites]
        lines.append("  </spatial>")
    lines += ["</tendon>", "<actuator>"]
    refers = f"plugin={quoteattr(PLUGIN)} instance={quoteattr(instance)}"
    lines += [
        f'  <plugin name={quoteattr(name)} tendon={quoteattr(name)} {refers} actdim="1"/>' for name in muscles
    ]
    lines += ["</actuator>", "<sensor>"]
    for name in muscles:
        lines += [f"  <plugin name={quoteattr(f'{name}.{sensor}')} {refers}/>" for sensor in sensors]
    return "\n".join([*lines, "</sensor>"])


class Driver:
    """Steps the muscles of a scenario and MuJoCo together, in a model with a motor for each muscle.

    For users who keep the loop in Python, for versions of MuJoCo that the plugin does not know, and for many worlds of one
    model. A step is in the order that is stable: tensions at t, MuJoCo's step, then the air and the valves to the new lengths.

    Parameters
    ----------
    model : mujoco.MjModel
        Model with a `<motor>` on a tendon, or on a hinge or slide joint, for each muscle, of its name. The motor has `gear="1"`
        and no `ctrlrange`, `forcerange` or `delay`, and no `actuatorfrcrange` limits the tendon or a joint that it moves: these
        would change the tension.
    scenario : Scenario
        Scenario of any kind; the names of its actuators are those of the motors, and a muscle alone may have any name.
    worlds : int, optional
        Number of worlds, each with its own `MjData`; 1 by default.
    length_offset : float or sequence of float, optional
        What is added to the lengths of MuJoCo for the distances between the ends of the muscles, in m.
    command_mode, pulse_frequency, max_step, precision
        As of `HostedPlant`.

    Raises
    ------
    InputError
        The model has no motor of a muscle's name, an attribute of the model would change the tension, or an argument is out of
        range.

    Notes
    -----
    A world begins again, as at the end of an episode, by `mujoco.mj_resetData` and `restart`, while the others continue.

    Examples
    --------
    >>> import mckibben, mckibben.mujoco, mujoco
    >>> model = mujoco.MjModel.from_xml_string('''
    ... <mujoco>
    ...   <worldbody>
    ...     <site name="anchor" pos="0 0 0.2"/>
    ...     <body pos="0 0 0.11">
    ...       <joint type="slide" axis="0 0 1"/>
    ...       <geom type="sphere" size="0.02" mass="2"/>
    ...       <site name="hook"/>
    ...     </body>
    ...   </worldbody>
    ...   <tendon><spatial name="muscle"><site site="anchor"/><site site="hook"/></spatial></tendon>
    ...   <actuator><motor name="muscle" tendon="muscle"/></actuator>
    ... </mujoco>''')
    >>> scenario = mckibben.Scenario.from_dict({
    ...     "supply": {"gauge_pressure": "100 psi"},
    ...     "valve": {"preset": "matrix-eight-channel"},
    ...     "command": {"kind": "fill"},
    ...     "load": {"kind": "isometric"},
    ...     "initial": {"length": "90 mm"},
    ...     "run": {"duration": "1 s"},
    ... })
    >>> driver = mckibben.mujoco.Driver(model, scenario, command_mode="request")
    >>> data = driver.start()
    >>> for _ in range(200):
    ...     tensions = driver.step(data, [1.0])
    >>> bool(data.qpos[0] > 0.01)
    True
    """

    def __init__(
        self,
        model: Any,
        scenario: Scenario,
        *,
        worlds: int = 1,
        length_offset: float | Sequence[float] = 0.0,
        command_mode: str | None = None,
        pulse_frequency: float | None = None,
        max_step: float | None = None,
        precision: Literal["double", "single"] = "double",
    ) -> None:
        mujoco = _mujoco()
        if not isinstance(model, mujoco.MjModel):
            raise InputError(f"model is of type {type(model).__name__}: give a mujoco.MjModel")
        if not isinstance(worlds, int | numpy.integer) or isinstance(worlds, bool) or worlds < 1:
            raise InputError(f"worlds = {worlds!r} is out of range: give a whole number from 1 on")
        self.model = model
        self.plant = HostedPlant(
            scenario,
            worlds,
            command_mode=command_mode,
            pulse_frequency=pulse_frequency,
            max_step=max_step,
            precision=precision,
        )
        names = self.plant.actuators
        motors = [model.actuator(at) for at in range(_actuators(model))]
        found = {motor.name: motor for motor in motors}
        missing = [name for name in names if name not in found]
        if len(names) == 1 and len(motors) == 1:
            missing, found = [], {names[0]: motors[0]}
        if missing:
            raise InputError(f"the model has no motor {missing}: it has {sorted(found)}; add <motor> of these names")
        motors = [found[name].id for name in names]
        self._motors: list[int] = motors
        self._checked: tuple[int, ...] = ()
        # In SI; text with a unit has been read by the plant.
        self._longest = self.plant.__getnewargs_ex__()[1].get("max_step") or math.inf
        self._lost: dict[int, str] = {}
        self._check_model(mujoco)
        # Since 3.11 an actuator may have several controls and forces; before, both have its number.
        self._controls = addresses(model, "actuator_ctrladr", motors)
        self._outputs = addresses(model, "actuator_outadr", motors)
        self._offset = _offsets(length_offset, names)

    def start(self) -> Any:
        """Return data of the model at its start: one, or a list of one for each world.

        Returns
        -------
        mujoco.MjData or list of mujoco.MjData

        Raises
        ------
        InputError
            A muscle cannot have the length that it has in the model.
        """
        mujoco = _mujoco()
        worlds = [mujoco.MjData(self.model) for _ in range(self.plant.count)]
        data = worlds[0] if len(worlds) == 1 else worlds
        self.restart(data)
        return data

    def restart(self, data: Any, rows: Any = None) -> None:
        """Begin the muscles of some worlds again, where their data have the ends, while the others continue.

        The data belong to the caller: reset them before, by `mujoco.mj_resetData`, and set their positions and velocities. The
        clock of the plant continues, as in `HostedPlant.restart`: the pulses of a duty cycle keep their phase, and tables of
        supplies and of their valves go on. Without `rows` all worlds begin at t = 0, and so does the clock.

        Parameters
        ----------
        data : mujoco.MjData or list of mujoco.MjData
            What `start` returned.
        rows : sequence of int, optional
            Indices of the worlds, from 0, each once. By default all begin again, at t = 0 of the plant.

        Raises
        ------
        InputError
            There is no such world, or a muscle cannot have such a length; no muscle has changed.
        """
        mujoco, worlds = _mujoco(), self._worlds(data)
        begun: list[Any] = [*range(len(worlds))] if rows is None else numpy.atleast_1d(rows).tolist()
        for at, row in enumerate(begun):
            if isinstance(row, bool) or not isinstance(row, int) or not 0 <= row < len(worlds):
                raise InputError(f"rows[{at}] = {row!r} is no world: give indices from 0 to {len(worlds) - 1}")
            if row in begun[:at]:
                raise InputError(f"rows[{at}] = {row!r} is the world of rows[{begun.index(row)}]: give each once")
        if not begun:
            return
        for row in begun:
            mujoco.mj_forward(self.model, worlds[row])
        ends = self._ends([(row, worlds[row]) for row in begun])
        try:
            if rows is None:
                self.plant.begin(*ends)
            else:
                self.plant.restart(numpy.array(begun, dtype=numpy.int64), *ends)
        except InputError as error:
            remedy = "a distance is MuJoCo's length plus length_offset, which is negative where a tendon has cables or fittings"
            raise InputError(f"{error}\n{remedy}") from error
        for row in begun:
            self._lost.pop(row, None)

    def step(self, data: Any, commands: Any) -> NDArray[numpy.float64]:
        """Advance MuJoCo and the muscles by one time step of the model.

        Parameters
        ----------
        data : mujoco.MjData or list of mujoco.MjData
            What `start` returned.
        commands : array_like
            Command of each valve, in the order of `plant.commands`; with several worlds one row for each. A single row or number
            is that of all worlds.

        Returns
        -------
        ndarray
            Tensions in N during the step, of the shape (worlds, muscles).

        Raises
        ------
        InputError
            A valve does not take such a command, a muscle cannot have such a length, there are not as many data as worlds, the
            time step is out of range, or the model now disables its motors or integrates by RK4; nothing has moved.
        SimulationError
            A muscle has come to a non-physical state, or to a length that it cannot have. The other worlds have taken the step;
            until that world begins again by `restart`, later steps raise before anything moves.

        Notes
        -----
        Lengths and velocities are those that the data have. After writing `qpos` or `qvel` between two steps call
        `mujoco.mj_forward(model, data)`, or the tensions of the next step are those of the ends before.
        """
        mujoco, worlds = _mujoco(), self._worlds(data)
        commands = self._commands(commands)
        # Before MuJoCo has moved.
        self._check_model(mujoco)
        self._check_time_step()
        self._check_lost()
        self.plant._check_commands(commands)
        tensions: NDArray[numpy.float64] = self.plant.compute(*self._ends(enumerate(worlds)))
        for world, tension in zip(worlds, tensions, strict=True):
            world.ctrl[self._controls] = -tension
            mujoco.mj_step(self.model, world)
            # Where the ends are now: MuJoCo itself would compute it at its next step.
            mujoco.mj_fwdPosition(self.model, world)
            mujoco.mj_fwdVelocity(self.model, world)
        distances = numpy.array([world.actuator_length[self._outputs] + self._offset for world in worlds])
        for row in numpy.flatnonzero(~((distances > 0.0) & numpy.isfinite(distances)).all(axis=1)).tolist():
            self._lost[row] = self._no_distance(row, distances[row])
            # The others take the step; the muscles of this world wait for its restart.
            distances[row] = self.plant.distances[row]
        self.plant.step(distances, commands, self.model.opt.timestep)
        self._check_lost()
        return tensions

    def _check_model(self, mujoco: types.ModuleType) -> None:
        """Refuse what would change the effect of the tensions; after the first time where an option of the model has changed."""
        options = self.model.opt
        seen = (int(options.disableflags), int(options.disableactuator), int(options.integrator))
        if seen == self._checked:
            return
        if seen[2] == int(mujoco.mjtIntegrator.mjINT_RK4):
            raise InputError(
                "the model has integrator=\"RK4\", which takes the forces at four times in a step, while the muscles have the air "
                'of one of them: write integrator="Euler", "implicit" or "implicitfast"'
            )
        check_actuation(mujoco, self.model)
        for motor in self._motors:
            check_motor(mujoco, self.model, motor)
        self._checked = seen

    def _check_time_step(self) -> None:
        """Refuse a time step of the model that the plant cannot take."""
        step = float(self.model.opt.timestep)
        if not math.isfinite(step) or step <= 0.0:
            raise InputError(f"model.opt.timestep = {step!r} s is out of range: give a finite number in s above zero")
        if step / self._longest > _MOST_PARTS:
            raise InputError(
                f"max_step = {self._longest!r} s divides a time step of {step!r} s into more than 1e7 parts: give a longer max_step"
            )

    def _check_lost(self) -> None:
        """Refuse to go on while the ends of a world have no distance."""
        if self._lost:
            row = min(self._lost)
            which = f"world {row}" if self.plant.count > 1 else "the world"
            raise SimulationError(f"{self._lost[row]}: begin {which} again by `restart`")

    def _no_distance(self, row: int, distances: NDArray[numpy.float64]) -> str:
        """What is wrong with the first distance of a world that is none."""
        at = int(numpy.flatnonzero(~((distances > 0.0) & numpy.isfinite(distances)))[0])
        name, distance, offset = self.plant.actuators[at], distances[at], self._offset[at]
        where = f"world {row}, {name}" if self.plant.count > 1 else name
        return (
            f"{where}: MuJoCo's length of {distance - offset:g} m and length_offset = {offset:g} m give a distance of "
            f"{distance:g} m between the ends, which must be above zero"
        )

    def _worlds(self, data: Any) -> list[Any]:
        """Data of all worlds."""
        worlds = [*data] if isinstance(data, list | tuple) else [data]
        count = self.plant.count
        if len(worlds) != count:
            given = "one MjData" if len(worlds) == 1 else f"a list of {len(worlds)}"
            raise InputError(f"data is {given} for {count} {'world' if count == 1 else 'worlds'}: give what `start` returned")
        kind = _mujoco().MjData
        for at, world in enumerate(worlds):
            if not isinstance(world, kind):
                name = "data" if world is data else f"data[{at}]"
                raise InputError(f"{name} is of type {type(world).__name__}: give what `start` returned, a mujoco.MjData")
            if any(world is other for other in worlds[:at]):
                raise InputError(f"data[{at}] is given twice: give each world its own MjData")
        return worlds

    def _commands(self, commands: Any) -> NDArray[numpy.float64]:
        """Commands of all worlds, a row for each."""
        shape = (self.plant.count, len(self.plant.commands))
        try:
            given = numbers_of("commands", commands)
        except (TypeError, InputError) as error:
            raise InputError(f"commands are no numbers ({error}): give an array of shape {shape}") from error
        try:
            return numpy.array(numpy.broadcast_to(given, shape), order="C")
        except ValueError as error:
            valves = ", ".join(self.plant.commands)
            remedy = f"give an array of shape {shape}, a row for each world with the commands {valves}"
            raise InputError(f"commands are of shape {given.shape}: {remedy}") from error

    def _ends(self, worlds: Any) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
        """Distances and velocities of the ends in worlds, which are given with their numbers."""
        distances, velocities = [], []
        for row, world in worlds:
            distances.append(world.actuator_length[self._outputs] + self._offset)
            # What is not a number is refused by the plant.
            if (distances[-1] <= 0.0).any():
                raise InputError(f"{self._no_distance(row, distances[-1])}: give another length_offset")
            velocities.append(world.actuator_velocity[self._outputs])
        return numpy.array(distances), numpy.array(velocities)


_MOST_PARTS = 1e7
"""Most parts of a step, as of `HostedPlant.step`."""
_MUSCLES = '{"muscle": ["anchor", "hook"]}'
_UNITS = {"pulse_frequency": "Hz", "max_step": "s", "length_offset": "m"}
"""Units of the attributes of the plugin that are quantities."""


def _unit(key: str) -> str:
    """Unit of a key of a scenario or an attribute of the plugin; empty where it has none."""
    known = parameters().get(key)
    return _UNITS.get(key, "") if known is None else known.unit


def _written(name: str, value: Any, unit: str) -> str:
    """A value as an attribute of the plugin has it: text as it is, a number with its unit in SI."""
    if isinstance(value, str):
        return value
    if isinstance(value, bool | numpy.bool_):
        return "true" if value else "false"
    if not isinstance(value, numbers.Real) or not math.isfinite(value):
        kind = "text with a unit or a finite number" + (f" in {unit}" if unit else "")
        raise InputError(f"{name} = {value!r} is no value: give {kind}")
    number = repr(int(value) if isinstance(value, numbers.Integral) else float(value))
    return f"{number} {unit}".strip()


def _metres(name: str, value: Any, words: str, is_in: Any) -> float:
    """A length in m in a range that words say."""
    is_number = isinstance(value, numbers.Real) and not isinstance(value, bool)
    if not is_number or not math.isfinite(value) or not is_in(value):
        raise InputError(f"{name} = {value!r} is out of range: give a number in m, {words}, such as 0.09")
    return float(value)


def _offsets(given: Any, names: Sequence[str]) -> NDArray[numpy.float64]:
    """What is added to the length of each muscle, in m."""
    remedy = f"give a number in m, or one for each of {', '.join(names)}"
    try:
        offsets = numbers_of("length_offset", given)
    except (TypeError, InputError) as error:
        raise InputError(f"length_offset = {given!r} is no number: {remedy}") from error
    if offsets.shape not in [(), (len(names),)]:
        raise InputError(f"length_offset = {given!r} is of shape {offsets.shape}: {remedy}")
    if not numpy.isfinite(offsets).all():
        raise InputError(f"length_offset = {given!r} is not finite: {remedy}")
    return numpy.broadcast_to(offsets, (len(names),))


def _mujoco() -> types.ModuleType:
    """MuJoCo, if it is installed."""
    try:
        return importlib.import_module("mujoco")
    except ImportError as error:
        raise InputError("MuJoCo is not installed: pip install 'mckibben[mujoco]'") from error


def _actuators(model: Any) -> int:
    """Number of actuators of a model, which has had a separate name since 3.11."""
    return int(getattr(model, "nactuator", model.nu))


def _attribute(value: str) -> str:
    """A value as an XML attribute that keeps the ends of lines."""
    return quoteattr(value, {"\n": "&#10;"})


_BACKENDS = ("mujoco.mjx", "mujoco_warp")
"""Backends that take no plugins."""


class _Backends(importlib.abc.MetaPathFinder):
    """Has backends refuse models with muscles as soon as they are imported."""

    def find_spec(self, name: str, path: Any, target: Any = None) -> Any:
        if name not in _BACKENDS:
            return None
        sys.meta_path.remove(self)
        try:
            spec = importlib.util.find_spec(name)
        finally:
            sys.meta_path.insert(0, self)
        if spec is not None and spec.loader is not None:
            execute = spec.loader.exec_module

            def execute_and_refuse(module: types.ModuleType) -> None:
                execute(module)
                _refuse_muscles(module, name)

            spec.loader.exec_module = execute_and_refuse  # type: ignore[method-assign]
        return spec


def _refuse_muscles(module: Any, name: str) -> None:
    """Has `put_model` of a backend refuse models with muscles."""
    put_model = getattr(module, "put_model", None)
    if put_model is None or getattr(put_model, "_refuses_muscles", False):
        return

    def put_model_without_muscles(model: Any, *args: Any, **kwargs: Any) -> Any:
        if int(getattr(model, "nplugin", 0)) and (numpy.asarray(model.actuator_plugin) >= 0).any():
            raise InputError(
                f"{name} takes no plugins, so the muscles of this model would give no force: step it with mujoco.mj_step or "
                "mujoco.rollout, or keep the muscles outside with mckibben.mujoco.Driver and <motor> in the model"
            )
        return put_model(model, *args, **kwargs)

    put_model_without_muscles._refuses_muscles = True  # type: ignore[attr-defined]
    module.put_model = put_model_without_muscles
