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
import sys
import types
from collections.abc import Mapping, Sequence
from typing import Any, Literal
from xml.sax.saxutils import quoteattr

import numpy
from numpy.typing import NDArray

from mckibben._mckibben import HostedPlant, Scenario, _register_mujoco
from mckibben.errors import InputError

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
    scenario: str | Scenario | None = None,
    keys: Mapping[str, str] | None = None,
    instance: str = "muscles",
    sensors: Sequence[str] = ("gauge_pressure", "tension"),
    command_mode: str | None = None,
    pulse_frequency: str | None = None,
    max_step: str | None = None,
    length_offset: str | None = None,
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
    scenario : str or Scenario, optional
        Path of a scenario file, which the model then refers to, or a scenario, whose text the model then holds. By default
        one muscle that `keys` describe.
    keys : mapping of str to str, optional
        Values of keys of a scenario file by their paths: {"supply.gauge_pressure": "100 psi"}.
    instance : str, optional
        Name of the instance of the plugin.
    sensors : sequence of str, optional
        Quantities to be sensed of each muscle: "gauge_pressure", "tension", "contraction", "mass_flow" and others.
    command_mode, pulse_frequency, max_step, length_offset : str, optional
        As the attributes of the plugin: what `ctrl` is, the frequency of pulses ("25 Hz"), the longest part of a step
        ("0.5 ms"), and what is added to the length of a tendon for the distance between the ends of its muscle ("-30 mm").
    max_length : float, optional
        Longest length of the tendons in m, kept by MuJoCo's own limit. Above some milliseconds of time step the taut braid
        is too stiff for MuJoCo's integrators, and this keeps the muscle from becoming taut.
    width : float, optional
        Width in m with which tendons are drawn.

    Returns
    -------
    str

    Raises
    ------
    InputError
        A muscle has fewer than two sites, or no name.
    """
    config: dict[str, str] = dict(keys or {})
    if isinstance(scenario, Scenario):
        config["scenario_text"] = scenario.to_toml()
    elif scenario is not None:
        config["scenario"] = scenario
    own = {
        "command_mode": command_mode,
        "pulse_frequency": pulse_frequency,
        "max_step": max_step,
        "length_offset": length_offset,
    }
    config |= {key: value for key, value in own.items() if value is not None}
    for name, sites in muscles.items():
        if not name or isinstance(sites, str) or len(sites) < 2:
            raise InputError(f"muscle {name!r} goes through {sites!r}: give it a name and two sites or more")
    lines = ["<extension>", f"  <plugin plugin={quoteattr(PLUGIN)}>", f"    <instance name={quoteattr(instance)}>"]
    lines += [f"      <config key={quoteattr(key)} value={_attribute(value)}/>" for key, value in config.items()]
    lines += ["    </instance>", "  </plugin>", "</extension>", "<tendon>"]
    limit = "" if max_length is None else f' limited="true" range="0 {max_length}"'
    for name, sites in muscles.items():
        lines.append(f'  <spatial name={quoteattr(name)} width="{width}"{limit}>')
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
        Model with a `<motor>` on a tendon or joint for each muscle, of its name, with `gear="1"` and without `ctrlrange`.
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
        The model has no motor of a muscle's name.

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
        self._motors = numpy.array([found[name].id for name in names])
        self._offset = numpy.broadcast_to(numpy.asarray(length_offset, dtype=float), (len(names),))

    def start(self) -> Any:
        """Return data of the model at its start: one, or a list of one for each world.

        Returns
        -------
        mujoco.MjData or list of mujoco.MjData
        """
        mujoco = _mujoco()
        worlds = [mujoco.MjData(self.model) for _ in range(self.plant.count)]
        for world in worlds:
            mujoco.mj_forward(self.model, world)
        self.plant.begin(*self._ends(worlds))
        return worlds[0] if len(worlds) == 1 else worlds

    def step(self, data: Any, commands: Any) -> NDArray[numpy.float64]:
        """Advance MuJoCo and the muscles by one time step of the model.

        Parameters
        ----------
        data : mujoco.MjData or list of mujoco.MjData
            What `start` returned.
        commands : array_like
            Command of each valve, in the order of `plant.commands`; with several worlds one row for each.

        Returns
        -------
        ndarray
            Tensions in N during the step, of the shape (worlds, muscles).

        Raises
        ------
        InputError
            A valve does not take such a command, or a muscle cannot have such a length.
        """
        mujoco = _mujoco()
        worlds = data if isinstance(data, list) else [data]
        shape = (self.plant.count, len(self.plant.commands))
        commands = numpy.array(numpy.broadcast_to(numpy.asarray(commands, dtype=float), shape), order="C")
        tensions: NDArray[numpy.float64] = self.plant.compute(*self._ends(worlds))
        for world, tension in zip(worlds, tensions, strict=True):
            world.ctrl[self._motors] = -tension
            mujoco.mj_step(self.model, world)
            # Where the ends are now: MuJoCo itself would compute it at its next step.
            mujoco.mj_fwdPosition(self.model, world)
            mujoco.mj_fwdVelocity(self.model, world)
        distances, _ = self._ends(worlds)
        self.plant.step(distances, commands, self.model.opt.timestep)
        return tensions

    def _ends(self, worlds: Sequence[Any]) -> tuple[NDArray[numpy.float64], NDArray[numpy.float64]]:
        """Distances and velocities of the ends."""
        lengths = numpy.array([world.actuator_length[self._motors] for world in worlds]) + self._offset
        return lengths, numpy.array([world.actuator_velocity[self._motors] for world in worlds])


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
