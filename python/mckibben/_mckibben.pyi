"""
Compiled part of the package `mckibben`.
"""

from _typeshed import Incomplete, SupportsLenAndGetItem
from collections.abc import Callable, Iterator, Mapping, Sequence
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from mckibben._results import Modes, Settled, Summary, Validity
from numpy import bool_, complex128, float64, int64, str_
from numpy.typing import ArrayLike, NDArray
from os import PathLike
from pandas import DataFrame
from polars import DataFrame as DataFrame2
from typing import Any, Final, Literal, SupportsFloat, SupportsIndex, final

__version__: Final[str]
"""
The version of the package.
"""

@final
class Actuator:
    """
    Actuator of a scenario with its air, valve and air line, for a simulation loop that you write.

    The loop commands the valve and moves the ends; the actuator returns its tension. The load, the command and the controller
    of the scenario are not used. An actuator is immutable: `step` takes a state and returns the next, so that a step can be
    repeated.

    Parameters
    ----------
    scenario : Scenario
        One actuator, or an antagonistic joint.
    name : {"agonist", "antagonist"}, optional
        Which actuator of a joint. Required for a joint, not allowed otherwise.
    pulse_frequency : float or str, optional
        Frequency in Hz, above zero, or text with a unit, of the pulses of a duty cycle. By default that of the scenario's PWM. Required where the
        valve has poppets and the scenario has no PWM.

    Raises
    ------
    InputError
        The scenario has several actuators with names, there is no actuator of that name, or `pulse_frequency` is missing.

    Notes
    -----
    Take the tension at t, make your own step with it, then call `step` with the new length and velocity. A loop that calls
    `step` with the length from before its own step uses a force that lags by one step.

    Examples
    --------
    A mass of 2 kg on a muscle that is pulsed at 25 Hz with a duty cycle of 0.5:

        >>> import mckibben
        >>> scenario = mckibben.Scenario.from_dict({
        ...     "supply": {"gauge_pressure": "100 psi"},
        ...     "valve": {"preset": "matrix-eight-channel"},
        ...     "command": {"kind": "pwm", "frequency": "25 Hz", "duty": 0.5},
        ...     "load": {"kind": "isometric"},
        ...     "initial": {"length": "85 mm", "gauge_pressure": "40 psi"},
        ...     "run": {"duration": "1 s"},
        ... })
        >>> muscle = mckibben.Actuator(scenario)
        >>> state, velocity, mass, dt = muscle.start(), 0.0, 2.0, 1e-3
        >>> length, tension = muscle.initial_length, muscle.initial_tension
        >>> for _ in range(100):
        ...     velocity += (9.81 - tension / mass) * dt
        ...     length += velocity * dt
        ...     state, tension, response = muscle.step(state, length, velocity, 0.5, dt)
        >>> round(state.time, 9), tension == response.tension
        (0.1, True)
    """
    def __getnewargs_ex__(self, /) -> tuple[tuple[Scenario, str | None], dict[str, Any]]: ...
    def __new__(cls, /, scenario: Scenario, name: Literal["agonist", "antagonist"] | None = None, *, pulse_frequency: float | str | None = None) -> Actuator: ...
    def __repr__(self, /) -> str: ...
    @property
    def initial_length(self, /) -> float:
        """
        Distance between the ends in m at the start, with the tendon if there is one.
        """
    @property
    def initial_tension(self, /) -> float:
        """
        Tension in N at the start, at rest.
        """
    def respond(self, /, state: ActuatorState, velocity: float | str = ...) -> Response:
        """
        Return the tension and its derivatives in a state, at any velocity of the ends, without a step.

        Parameters
        ----------
        state : ActuatorState
            State of this actuator.
        velocity : float or str, optional
            Velocity of the ends in m/s, above zero while lengthening, between -1e6 and 1e6; 0 by default.

        Returns
        -------
        Response

        Raises
        ------
        InputError
            The velocity is out of range, or the state belongs to another actuator.
        """
    def rest_length(self, /, gauge_pressure: float | str | None = None) -> float:
        """
        Return the longest distance between the ends at which the actuator does not pull, at rest and without friction.

        Parameters
        ----------
        gauge_pressure : float or str, optional
            Gauge pressure of the air in Pa, or text with a unit; that of the start by default.

        Returns
        -------
        float
            Distance in m, with the tendon if there is one; the shortest length where the actuator pulls even there.

        Raises
        ------
        InputError
            The pressure is below vacuum, or there is no such length.
        """
    @property
    def scenario(self, /) -> Scenario:
        """
        Scenario of the actuator.
        """
    def start(self, /) -> ActuatorState:
        """
        Return the state at t = 0: that of the scenario, with the coils of the valve released.

        Returns
        -------
        ActuatorState
        """
    def step(self, /, state: ActuatorState, length: float | str, velocity: float | str, command: float | str | Literal["fill", "hold", "exhaust"] | None, dt: float | str, *, max_step: float | str | None = None) -> tuple[ActuatorState, float, Response]:
        """
        Advance a state by one time step, in which the ends move to a new distance at constant velocity.

        Parameters
        ----------
        state : ActuatorState
            State at the beginning of the step.
        length : float or str
            Distance between the ends in m at the end of the step, above zero, with the tendon if there is one. This and the
            other quantities may be text with a unit.
        velocity : float or str
            Velocity of the ends in m/s at the end of the step, above zero while lengthening, between -1e6 and 1e6. The
            tension depends on it through friction; the motion during the step follows from `length` alone.
        command : float or str or {"fill", "hold", "exhaust"} or None
            Command of the valve: a duty cycle from 0 to 1, "40 %", or one of the words; of a pressure regulator the set point, a
            gauge pressure in Pa; of a proportional spool the position from -1 to 1. With `None` the last command continues.
            It must be `None` where there is no valve.
        dt : float or str
            Duration of the step in s, above zero.
        max_step : float or str, optional
            Longest part of the step in s. The step is divided into equal parts no longer than that, along which the length is
            interpolated linearly: the air is then as accurate as with steps of `max_step`. By default the step is one part.

        Returns
        -------
        state : ActuatorState
            State at the end of the step.
        tension : float
            Tension there in N.
        response : Response
            Tension with its partial derivatives, and the rates of the air.

        Raises
        ------
        InputError
            An argument is out of range, the valve does not take the command, the state belongs to another actuator, or the step
            has more than 10 000 000 parts and edges of pulses.
        SimulationError
            The step leads to a non-physical state, or the length is one to which the actuator cannot be stretched.

        Notes
        -----
        Edges of pulses and motions of the poppets take place at their instants, however long the step is. Ctrl-C ends a step of
        many parts.
        """

@final
class ActuatorState:
    """
    State of an `Actuator`: its air, the poppets and pulses of its valve, and the memory of its hysteresis.

    `Actuator.start` and `Actuator.step` return states. A state can be pickled. An actuator of the same scenario and pulse
    frequency continues from it bit-identically; any other actuator refuses it.

    Parameters
    ----------
    numbers : array_like
        One-dimensional array that a pickle holds, made by the same version of the package.

    Raises
    ------
    InputError
        The numbers are not a state.

    Examples
    --------
        >>> import mckibben
        >>> muscle = mckibben.Actuator(mckibben.Scenario.from_dict({
        ...     "load": {"kind": "isometric"},
        ...     "initial": {"length": "85 mm", "gauge_pressure": "40 psi"},
        ...     "run": {"duration": "1 s"},
        ... }))
        >>> state = muscle.start()
        >>> state.time, state.length, state.valve
        (0.0, 0.085, 'closed')
    """
    def __eq__(self, other: object, /) -> bool:
        """
        Return whether both states are bit-identical.
        """
    def __getnewargs__(self, /) -> tuple[NDArray[float64]]: ...
    def __new__(cls, /, numbers: ArrayLike) -> ActuatorState: ...
    def __repr__(self, /) -> str: ...
    @property
    def absolute_pressure(self, /) -> float:
        """
        Absolute pressure of the air in Pa.
        """
    @property
    def air_mass(self, /) -> float:
        """
        Mass of the air in kg.
        """
    @property
    def length(self, /) -> float:
        """
        Distance between the ends in m.
        """
    @property
    def time(self, /) -> float:
        """
        Time in s since the start.
        """
    @property
    def valve(self, /) -> Literal["closed", "supply", "exhaust", "supply+exhaust"]:
        """
        Open ports of the valve: "supply", "exhaust", "supply+exhaust" or "closed".
        """

@final
class Actuators:
    """
    Many actuators of one scenario, each with its own air, valve and hysteresis, stepped together on arrays.

    The caller owns the arrays: `step` reads and writes them in place. They are one-dimensional and C-contiguous, of float64,
    with one element for each actuator. They are stepped side by side in the vector registers of the processor, and by all cores where
    they are many. In double precision each is bit-identical to a scalar `Actuator`; in single precision it is near that, and the others
    of the batch change it by less than a millionth of its range. An array of other numbers or dimensions raises `TypeError`.

    Parameters
    ----------
    scenario : Scenario
        One actuator, or an antagonistic joint.
    count : int
        Number of actuators.
    name : {"agonist", "antagonist"}, optional
        Which actuator of a joint. Required for a joint, not allowed otherwise.
    parameters : sequence of str, optional
        Paths of the parameters that differ between the actuators, such as "actuator.turns"; none by default. Not together with
        `name`.
    values : numpy.ndarray, optional
        Values of `parameters` in SI, float64 of shape (count, len(parameters)), of any memory layout. Required with `parameters`.
    pulse_frequency : float or str, optional
        Frequency in Hz, above zero, or text with a unit, of the pulses of a duty cycle. By default that of the scenario's PWM. Required where the
        valve has poppets and the scenario has no PWM.
    precision : {"double", "single"}, optional
        Numbers that the actuators are stepped in; double by default. Single precision takes twice as many at once, and keeps seven digits of a
        state: what a step changes below the last of them is lost. It needs a package that is built with the feature `f32`.

    Raises
    ------
    InputError
        An argument does not fit the scenario, or a value of a parameter is out of range.
    MemoryError
        This machine does not have the memory for so many actuators.

    Examples
    --------
        >>> import mckibben, numpy
        >>> scenario = mckibben.Scenario.from_dict({
        ...     "supply": {"gauge_pressure": "100 psi"},
        ...     "valve": {"preset": "matrix-eight-channel"},
        ...     "command": {"kind": "pwm", "frequency": "25 Hz", "duty": 0.5},
        ...     "load": {"kind": "isometric"},
        ...     "initial": {"length": "85 mm", "gauge_pressure": "40 psi"},
        ...     "run": {"duration": "1 s"},
        ... })
        >>> muscles = mckibben.Actuators(scenario, 3)
        >>> length, velocity, tension = numpy.full(3, 0.085), numpy.zeros(3), numpy.zeros(3)
        >>> duty = numpy.array([0.2, 0.5, 0.8])
        >>> for _ in range(200):
        ...     muscles.step(length, velocity, duty, 1e-3, tension)
        >>> bool((numpy.diff(tension) > 0.0).all())
        True
    """
    def __getnewargs_ex__(self, /) -> tuple[tuple[Scenario, int, str | None], dict[str, Any]]: ...
    def __getstate__(self, /) -> NDArray[float64]:
        """
        Return the states of the actuators, a row for each, as an `ActuatorState` is pickled.
        """
    def __len__(self, /) -> int:
        """
        Return the number of actuators.
        """
    def __new__(cls, /, scenario: Scenario, count: int, name: Literal["agonist", "antagonist"] | None = None, *, parameters: Sequence[str] = ..., values: NDArray[float64] | None = None, pulse_frequency: float | str | None = None, precision: Literal["double", "single"] = ...) -> Actuators: ...
    def __repr__(self, /) -> str: ...
    def __setstate__(self, /, numbers: NDArray[float64]) -> None: ...
    @property
    def parameters(self, /) -> list[str]:
        """
        Paths of the parameters that differ between the actuators.
        """
    def reset(self, /) -> None:
        """
        Reset all actuators to t = 0 and the state of the scenario, with the coils of the valves released.
        """
    def respond(self, /, velocity: NDArray[float64], tension: NDArray[float64], *, per_length: NDArray[float64] | None = None, per_velocity: NDArray[float64] | None = None, absolute_pressure: NDArray[float64] | None = None) -> None:
        """
        Write the tensions and their derivatives in the current states, at any velocity of the ends, without a step.

        Parameters
        ----------
        velocity : numpy.ndarray
            Velocities of the ends in m/s, between -1e6 and 1e6.
        tension : numpy.ndarray
            Receives the tensions in N.
        per_length : numpy.ndarray, optional
            Receives the derivatives of the tension with respect to the length at constant pressure, in N/m.
        per_velocity : numpy.ndarray, optional
            Receives the derivatives of the tension with respect to the velocity, in N*s/m.
        absolute_pressure : numpy.ndarray, optional
            Receives the absolute pressures in Pa.

        Raises
        ------
        InputError
            An array or a number is not valid; nothing has changed.
        """
    def step(self, /, length: NDArray[float64], velocity: NDArray[float64], command: NDArray[float64] | None, dt: float | str, tension: NDArray[float64], *, per_length: NDArray[float64] | None = None, per_velocity: NDArray[float64] | None = None, absolute_pressure: NDArray[float64] | None = None, max_step: float | str | None = None) -> None:
        """
        Advance all actuators by one time step, in which the ends of each move to a new distance at constant velocity.

        Parameters
        ----------
        length : numpy.ndarray
            Distances between the ends in m at the end of the step, above zero, with the tendon if there is one.
        velocity : numpy.ndarray
            Velocities of the ends in m/s at the end of the step, between -1e6 and 1e6.
        command : numpy.ndarray or None
            Commands of the valves: duty cycles from 0 to 1; of pressure regulators the set points, gauge pressures in Pa; of
            proportional spools the positions from -1 to 1. With `None` the last commands continue.
        dt : float or str
            Duration of the step in s, above zero, or text with a unit.
        tension : numpy.ndarray
            Receives the tensions in N.
        per_length : numpy.ndarray, optional
            Receives the derivatives of the tension with respect to the length at constant pressure, in N/m.
        per_velocity : numpy.ndarray, optional
            Receives the derivatives of the tension with respect to the velocity, in N*s/m.
        absolute_pressure : numpy.ndarray, optional
            Receives the absolute pressures in Pa.
        max_step : float or str, optional
            Longest part of the step in s, or text with a unit, as of `Actuator.step`. By default the step is one part.

        Raises
        ------
        InputError
            An array or a number is not valid; nothing has changed.
        SimulationError
            A length is out of reach: the ends of that actuator stay where they were. Or an actuator comes to a non-physical state:
            it has stopped then, later steps raise as well, and only `reset` brings it back. Its elements of the results stay as
            they are, and the others have advanced.

        Notes
        -----
        Ctrl-C ends a step of many parts; then all actuators are in their states before the step.
        """

@final
class Differentiable:
    """
    Quantities of a run at given times as a function of parameters of its scenario, with the exact Jacobian.

    An instance is called with the values of the parameters, and returns the quantities. The run is that of the event-located
    engine: every event is located, and the derivatives account for it.

    Parameters
    ----------
    scenario : Scenario
        One actuator or an antagonistic joint, without a controller.
    parameters : sequence of str
        Paths of numbers of the scenario, such as "load.mass", "command.duty" or "actuator.effectiveness.value[2]". The path of a
        list stands for all its entries in their order: "command.gauge_pressure" for every set point of a regulator,
        "command.position" for every position of a spool, "command.time" for the instants of a command, "pressure.gauge_pressure"
        and "load.table_length" for the rows of a pressure and of a length over time.
    quantities : sequence of str
        "length" (m), "gauge_pressure" (Pa), "tension" (N), "temperature" (K), "mass_flow" (kg/s); of a joint also "angle" (rad),
        "angular_velocity" (rad/s), "torque" (N*m), "antagonist_length", "antagonist_gauge_pressure" and "antagonist_tension".
    times : array_like
        Times in s, from 0 to `run.duration`.

    Raises
    ------
    InputError
        The scenario has a controller or several actuators with names, there is no such parameter or quantity, or a time is
        outside the run.

    Notes
    -----
    A call takes `values`, array_like of the parameters in SI, and returns an array of shape (len(times), len(quantities)). It
    raises `InputError` for values that are not finite or out of range, and `SimulationError` where the run fails. Ctrl-C ends
    it.

    Examples
    --------
        >>> import mckibben
        >>> scenario = mckibben.Scenario.from_dict({
        ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
        ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
        ...     "run": {"duration": "0.1 s"},
        ... })
        >>> run = mckibben.Differentiable(scenario, ["load.mass"], ["length", "tension"], [0.05, 0.1])
        >>> run(run.defaults).shape
        (2, 2)
        >>> values, jacobian = run.value_and_jacobian([2.5])
        >>> jacobian.shape
        (2, 2, 1)
    """
    def __call__(self, /, values: ArrayLike) -> NDArray[float64]:
        """
        Return the quantities at the times.

        Parameters
        ----------
        values : array_like
            Values of the parameters in SI.

        Returns
        -------
        numpy.ndarray
            Quantities of shape (len(times), len(quantities)).
        """
    def __getnewargs__(self, /) -> tuple[Scenario, list[str], list[str], Incomplete]: ...
    def __new__(cls, /, scenario: Scenario, parameters: Sequence[str], quantities: Sequence[str], times: ArrayLike) -> Differentiable: ...
    def __repr__(self, /) -> str: ...
    @property
    def defaults(self, /) -> NDArray[float64]:
        """
        Values of the parameters in the scenario, in SI.
        """
    def for_jax(self, /) -> Callable[..., Any]:
        """
        Return this function for JAX, which differentiates it in forward and in reverse mode.

        Returns
        -------
        callable
            A `jax.custom_jvp` of the values of the parameters in SI. The runs of a `vmap` use all cores.

        Raises
        ------
        InputError
            JAX computes in 32 bits; call `jax.config.update("jax_enable_x64", True)` first.
        """
    def for_torch(self, /) -> Callable[..., Any]:
        """
        Return this function for PyTorch, which differentiates it in forward and in reverse mode.

        Returns
        -------
        callable
            A function of a float64 tensor of the values of the parameters in SI, with any leading dimensions. The runs of a
            `vmap`, or of leading dimensions, use all cores. They take place on the CPU; the result is on the device of the
            tensor.

        Notes
        -----
        The function raises `InputError` for a tensor of another type, and where a second derivative is taken.
        """
    @property
    def parameters(self, /) -> list[str]:
        """
        Paths of the parameters, those of a list one by one.
        """
    @property
    def quantities(self, /) -> list[str]:
        """
        Names of the quantities.
        """
    @property
    def scenario(self, /) -> Scenario:
        """
        Scenario that is run.
        """
    @property
    def times(self, /) -> NDArray[float64]:
        """
        Times in s.
        """
    @property
    def units(self, /) -> dict[str, str]:
        """
        Units of the quantities by their names, in SI.
        """
    def value_and_jacobian(self, /, values: ArrayLike) -> tuple[NDArray[float64], NDArray[float64]]:
        """
        Return the quantities at the times and their Jacobian with respect to the parameters.

        Parameters
        ----------
        values : array_like
            Values of the parameters in SI.

        Returns
        -------
        value : numpy.ndarray
            Quantities in SI, of shape (len(times), len(quantities)).
        jacobian : numpy.ndarray
            Derivatives in SI, of shape (len(times), len(quantities), len(parameters)).

        Raises
        ------
        InputError
            The values are of another number, not finite or out of range.
        SimulationError
            The run fails with these values.
        """

@final
class DifferentiableStep:
    """
    One step of an actuator as a function of its state, the motion of its ends and its command, with the exact Jacobian.

    An instance is called with an array of inputs, and returns an array of outputs. The inputs are the numbers of the state, then
    "length" in m and "velocity" in m/s of the ends at the end of the step, then "command" where the actuator has a valve. The
    outputs are the numbers of the state after the step, then "tension" in N. The Jacobian accounts for poppets and pulses that
    move, and friction that turns, within the step.

    Parameters
    ----------
    actuator : Actuator
        Actuator whose step it is.
    dt : float or str
        Duration of the step in s, above zero, or text with a unit.
    max_step : float or str, optional
        Longest part of the step in s, or text with a unit, as of `Actuator.step`. By default the step is one part.

    Raises
    ------
    InputError
        `dt` or `max_step` is out of range.

    Notes
    -----
    The names of the state's numbers are "state.time" (s), "state.absolute_pressure" (Pa), "state.air_mass" (kg), "state.length"
    (m) and "state.velocity" (m/s); all others are "state[1]", "state[2]" and so on by their place: what friction remembers,
    instants at which poppets move, pulses. Numbers that stand for something discrete, such as an open port, have derivatives of
    zero. Jacobians of successive steps multiply to that of the whole motion. Where an event or an edge of a pulse lies exactly at the
    end of a step, the derivatives are those of one side.

    A command is a duty cycle from 0 to 1, of a pressure regulator a gauge pressure in Pa, of a proportional spool a position from
    -1 to 1. A duty cycle takes effect when the next pulse begins. A set point and a position are new ones in each step, also where
    they equal those before, so that each has its own derivatives. `Actuator.step` goes on with an equal one: its results differ by
    rounding, and with a dead time that is no multiple of `dt` as those of a step that is divided there. At most 64 commands may be
    on their way: with a dead time of more steps give a longer `dt`.

    Examples
    --------
    The pressure and the tension of a closed muscle rise with its length:

        >>> import mckibben
        >>> muscle = mckibben.Actuator(mckibben.Scenario.from_dict({
        ...     "load": {"kind": "isometric"},
        ...     "initial": {"length": "85 mm", "gauge_pressure": "40 psi"},
        ...     "run": {"duration": "1 s"},
        ... }))
        >>> step = mckibben.DifferentiableStep(muscle, 1e-3)
        >>> outputs, jacobian = step.value_and_jacobian(step.pack(muscle.start(), 0.0851, 0.1))
        >>> pressure, length = step.outputs.index("state.absolute_pressure"), step.inputs.index("length")
        >>> bool(jacobian[pressure, length] > 0.0), bool(jacobian[-1, length] > 0.0)
        (True, True)
    """
    def __call__(self, /, values: ArrayLike) -> NDArray[float64]:
        """
        Return the outputs.

        Parameters
        ----------
        values : array_like
            Inputs in SI, of shape (len(inputs),), as `pack` returns them.

        Returns
        -------
        numpy.ndarray
            Outputs in SI, of shape (len(outputs),).
        """
    def __getnewargs_ex__(self, /) -> tuple[tuple[Actuator, float], dict[str, Any]]: ...
    def __new__(cls, /, actuator: Actuator, dt: float | str, *, max_step: float | str | None = None) -> DifferentiableStep: ...
    def __repr__(self, /) -> str: ...
    @property
    def actuator(self, /) -> Actuator:
        """
        Actuator whose step it is.
        """
    @property
    def dt(self, /) -> float:
        """
        Duration of the step in s.
        """
    def for_jax(self, /) -> Callable[..., Any]:
        """
        Return this function for JAX, which differentiates it in forward and in reverse mode.

        Returns
        -------
        callable
            A `jax.custom_jvp` of the inputs in SI. The steps of a `vmap` use all cores.

        Raises
        ------
        InputError
            JAX computes in 32 bits; call `jax.config.update("jax_enable_x64", True)` first.
        """
    def for_torch(self, /) -> Callable[..., Any]:
        """
        Return this function for PyTorch, which differentiates it in forward and in reverse mode.

        Returns
        -------
        callable
            A function of a float64 tensor of the inputs in SI, with any leading dimensions. The steps of leading dimensions use
            all cores.

        Notes
        -----
        The function raises `InputError` for a tensor of another type, and where a second derivative is taken.
        """
    @property
    def inputs(self, /) -> list[str]:
        """
        Names of the inputs, in their order.
        """
    @property
    def max_step(self, /) -> float | None:
        """
        Longest part of the step in s; `None` where it is one part.
        """
    @property
    def outputs(self, /) -> list[str]:
        """
        Names of the outputs, in their order.
        """
    def pack(self, /, state: ActuatorState, length: float | str, velocity: float | str, command: float | str = ...) -> NDArray[float64]:
        """
        Return the inputs of a step from a state.

        Parameters
        ----------
        state : ActuatorState
            State of the actuator at the beginning of the step.
        length : float or str
            Distance between the ends in m at the end of the step, above zero, or text with a unit.
        velocity : float or str
            Velocity of the ends in m/s at the end of the step, above zero while lengthening.
        command : float or str, optional
            Command of the valve: a duty cycle, a gauge pressure in Pa or a position; 0 by default. Ignored where there is no
            valve.

        Returns
        -------
        numpy.ndarray
            Inputs in SI, of shape (len(inputs),).

        Raises
        ------
        InputError
            The state belongs to another actuator.
        """
    def unpack(self, /, outputs: ArrayLike) -> tuple[ActuatorState, float]:
        """
        Return the state and the tension that outputs stand for.

        Parameters
        ----------
        outputs : array_like
            Outputs of a step, of shape (len(outputs),).

        Returns
        -------
        state : ActuatorState
            State after the step, from which `Actuator.step` continues too.
        tension : float
            Tension in N.

        Raises
        ------
        InputError
            The numbers are no outputs of this step.
        """
    def value_and_jacobian(self, /, values: ArrayLike) -> tuple[NDArray[float64], NDArray[float64]]:
        """
        Return the outputs and their Jacobian with respect to the inputs.

        Parameters
        ----------
        values : array_like
            Inputs in SI, of shape (len(inputs),), as `pack` returns them.

        Returns
        -------
        value : numpy.ndarray
            Outputs in SI, of shape (len(outputs),).
        jacobian : numpy.ndarray
            Derivatives in SI, of shape (len(outputs), len(inputs)).

        Raises
        ------
        InputError
            The values are of another number, out of range, or no state of the actuator; or the step has more than 20 000 parts.
        SimulationError
            The step leads to a non-physical state.
        """

@final
class Event:
    """
    Event of a run: a discontinuity, and the discrete state that holds after it.

    `Trajectory.events` has them; the constructor serves pickling.

    Examples
    --------
        >>> import mckibben
        >>> run = mckibben.simulate(mckibben.Scenario.from_dict({
        ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
        ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
        ...     "run": {"duration": "0.1 s"},
        ... }))
        >>> event = run.events[0]
        >>> event.kind, 0.0 <= event.time <= 0.1, event.after["valve"]
        ('reversal', True, 'closed')
    """
    def __eq__(self, other: object, /) -> bool:
        """
        Return whether both events are equal.
        """
    def __getnewargs__(self, /) -> tuple[float, list[str], list[str]]: ...
    def __new__(cls, /, time: SupportsFloat | SupportsIndex, columns: Sequence[str], words: Sequence[str]) -> Event: ...
    def __repr__(self, /) -> str: ...
    @property
    def after(self, /) -> dict[str, str | float | bool]:
        """
        Discrete state after the event, by the names of the columns of `mckibben simulate --events-output`.

        Values are words such as "slack", `bool` for true and false, and `float`.
        """
    @property
    def kind(self, /) -> str:
        """
        Kind of the event, such as "valve", "stick", "break-away" or "slack".
        """
    @property
    def time(self, /) -> float:
        """
        Time of the event in s.
        """

@final
class HostedPlant:
    """
    Plants of a scenario whose ends a simulator of your own moves: distances and commands in, tensions and pressures out.

    All actuators of the scenario, with the air network that they share, are one plant. The loads and mechanisms of the scenario
    are not used: the simulator moves the ends. Nor are `run.method` and `run.step`: every part of a step is one of the stable
    method. `count` plants, each with its own state, are stepped together, side by side in the
    vector registers of the processor; many of them on all cores. In double precision each is bit-identical to a plant alone; in single
    precision the others of the batch change it by less than a millionth of its range.

    Arrays have a row for each plant. Those of distances, velocities and commands are read in place, and are C-contiguous.

    Parameters
    ----------
    scenario : Scenario
        A scenario of any kind.
    count : int, optional
        Number of plants; 1 by default.
    command_mode : {"duty", "request", "position", "set-point"}, optional
        What a command is: a duty cycle from 0 to 1; 1 to fill, 0 to hold, -1 to exhaust; the position of a proportional spool
        from -1 to 1; the set point of a pressure regulator, a gauge pressure in Pa. By default what each valve takes.
    pulse_frequency : float or str, optional
        Frequency in Hz of the pulses of a duty cycle, above zero, or text with a unit; by default that of the scenario's PWM.
    max_step : float or str, optional
        Longest part of a step in s, above zero, or text with a unit: the air takes several in a long step. By default a step is one part.
    precision : {"double", "single"}, optional
        Numbers that the plants are stepped in; double by default. Single precision takes twice as many at once, and keeps seven digits of a
        state: what a step changes below the last of them is lost. It needs a package that is built with the feature `f32`.

    Raises
    ------
    InputError
        The scenario has a mistake, a valve does not take such commands, or an option is out of range.

    Notes
    -----
    Take the tensions at t, make your own step with them, then call `step` with the new distances. A copy, or a plant from a pickle,
    continues bit-identically.

    Examples
    --------
    A mass of 2 kg on a muscle that is filled:

        >>> import mckibben, numpy
        >>> scenario = mckibben.Scenario.from_dict({
        ...     "supply": {"gauge_pressure": "100 psi"},
        ...     "valve": {"preset": "matrix-eight-channel"},
        ...     "command": {"kind": "fill"},
        ...     "load": {"kind": "isometric"},
        ...     "initial": {"length": "90 mm", "gauge_pressure": "40 psi"},
        ...     "run": {"duration": "1 s"},
        ... })
        >>> plant = mckibben.HostedPlant(scenario, command_mode="request")
        >>> distance, velocity, dt = numpy.array([[0.09]]), numpy.zeros((1, 1)), 1e-3
        >>> plant.begin(distance, velocity)
        >>> for _ in range(100):
        ...     velocity += (9.81 - plant.compute(distance, velocity) / 2.0) * dt
        ...     distance += velocity * dt
        ...     plant.step(distance, numpy.ones((1, 1)), dt)
        >>> bool(distance[0, 0] < 0.08), plant.commands
        (True, ['actuator.request'])
    """
    def __getnewargs_ex__(self, /) -> tuple[tuple[Scenario, int], dict[str, Any]]: ...
    def __getstate__(self, /) -> NDArray[float64]:
        """
        Return the states of the plants.
        """
    def __new__(cls, /, scenario: Scenario, count: int = ..., *, command_mode: str | None = None, pulse_frequency: float | str | None = None, max_step: float | str | None = None, precision: Literal["double", "single"] = ...) -> HostedPlant: ...
    def __repr__(self, /) -> str: ...
    def __setstate__(self, /, state: NDArray[float64]) -> None: ...
    def _check_commands(self, /, commands: NDArray[float64]) -> None:
        """
        Refuse commands that a valve does not take, before a step.
        """
    @property
    def actuators(self, /) -> list[str]:
        """
        Names of the actuators, in the order of the columns of `distances`.
        """
    def begin(self, /, distances: NDArray[float64], velocities: NDArray[float64]) -> None:
        """
        Begin at t = 0 with the ends at given distances, and all else as the scenario starts.

        Parameters
        ----------
        distances : ndarray
            Distances between the ends in m, above zero, of the shape (count, actuators), with the tendon if there is one.
        velocities : ndarray
            Their rates of change in m/s, between -1e6 and 1e6, of the shape of `distances`.

        Raises
        ------
        InputError
            An array has another shape or is not C-contiguous, an actuator cannot have such a distance, or a velocity is out of
            range.
        TypeError
            An array is not one of float64 with two dimensions.
        """
    @property
    def columns(self, /) -> list[str]:
        """
        Names of what `observe` returns, with their units, such as "biceps.gauge_pressure_pa".
        """
    @property
    def commands(self, /) -> list[str]:
        """
        Names of the commands, in the order of the columns of `commands`: actuator and mode.
        """
    def compute(self, /, distances: NDArray[float64], velocities: NDArray[float64]) -> NDArray[float64]:
        """
        Return the tensions with the ends at given distances and velocities.

        Parameters
        ----------
        distances : ndarray
            Distances between the ends in m, above zero, of the shape (count, actuators).
        velocities : ndarray
            Their rates of change in m/s, between -1e6 and 1e6, of the shape of `distances`.

        Returns
        -------
        ndarray
            Tensions in N, zero or more, of the shape (count, actuators).

        Raises
        ------
        InputError
            An array has another shape or is not C-contiguous, an actuator cannot have such a distance, or a velocity is out of
            range.
        TypeError
            An array is not one of float64 with two dimensions.
        SimulationError
            A plant has stopped.
        """
    @property
    def count(self, /) -> int:
        """
        Number of plants.
        """
    @property
    def distances(self, /) -> NDArray[float64]:
        """
        Distances between the ends in m where the plants are, of the shape (count, actuators).
        """
    def observe(self, /) -> NDArray[float64]:
        """
        Return the outputs where the plants are, of the shape (count, columns).

        Returns
        -------
        ndarray
            What `columns` names, in SI.

        Raises
        ------
        SimulationError
            A plant has stopped.
        """
    def restart(self, /, rows: NDArray[int64], distances: NDArray[float64], velocities: NDArray[float64]) -> None:
        """
        Begin some plants again, without a command to their valves, while the others continue.

        They begin with the ends at given distances, and all else as the scenario starts. The clock continues. Plants that have
        stopped begin again as well.

        Parameters
        ----------
        rows : ndarray
            Indices of the plants, int64, from 0, each once.
        distances : ndarray
            Distances between the ends in m, above zero, of the shape (len(rows), actuators), with the tendon if there is one.
        velocities : ndarray
            Their rates of change in m/s, between -1e6 and 1e6, of the shape of `distances`.

        Raises
        ------
        InputError
            There is no such plant, an index is given twice, an array has another shape or is not C-contiguous, an actuator cannot
            have such a distance, or a velocity is out of range; nothing has changed.
        TypeError
            An array of distances or velocities is not one of float64 with two dimensions, or `rows` not one of int64 with one;
            nothing has changed.
        """
    def restore(self, /, states: NDArray[float64]) -> None:
        """
        Bring all plants back to states that plants of an equal scenario have saved. They continue bit-identically.

        The scenarios may differ in `command`, `controller`, `initial`, `load`, `mechanism` and `run`.

        Parameters
        ----------
        states : ndarray
            States from `save`, of any memory layout.

        Raises
        ------
        InputError
            The numbers are no states of these plants, or are states of plants of another scenario, command mode or pulse
            frequency; nothing has changed.
        TypeError
            The states are no array of float64 with two dimensions; nothing has changed.
        """
    def save(self, /) -> NDArray[float64]:
        """
        Return the states of all plants as numbers, of the shape (count, numbers of a state).

        Returns
        -------
        ndarray
            What `restore` takes. The first number of each row is a mark of the scenario and the commands; the order of the others,
            among them the clock, may change from one version to the next.
        """
    @property
    def scenario(self, /) -> Scenario:
        """
        Scenario of the plants.
        """
    def step(self, /, distances: NDArray[float64], commands: NDArray[float64], dt: float | str) -> None:
        """
        Advance all plants by one time step, in which the ends go in straight lines to new distances.

        Parameters
        ----------
        distances : ndarray
            Distances between the ends in m at the end of the step, above zero, of the shape (count, actuators).
        commands : ndarray
            Commands of the valves during the step, of the shape (count, commands).
        dt : float or str
            Duration of the step in s, above zero, or text with a unit.

        Raises
        ------
        InputError
            An array has another shape or is not C-contiguous, a valve does not take such a command, or there are more than
            10 000 000 parts and edges of pulses; no plant has moved.
        TypeError
            An array is not one of float64 with two dimensions; no plant has moved.
        SimulationError
            The step leads a plant to a non-physical state. The others have taken the step. That plant has stopped: until `begin` or
            `restore`, its later steps raise as well.

        Notes
        -----
        Ctrl-C ends a step of many parts; then all plants are in their states before the step.
        """
    @property
    def time(self, /) -> float:
        """
        Time in s since the start.
        """

@final
class LinearModel:
    """
    Linear model `dx/dt = A x + B u`, `y = C x + D u` of deviations from an operating point, in SI.

    `linearize` returns it; the constructor serves pickling.

    Examples
    --------
        >>> import mckibben
        >>> model = mckibben.linearize(mckibben.Scenario.from_dict({
        ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
        ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
        ...     "run": {"duration": "0.1 s"},
        ... }))
        >>> model.A.shape, model.units["pressure"]
        ((3, 3), 'Pa')
        >>> model.response([1.0, 10.0]).shape == (2, len(model.outputs), len(model.inputs))
        True
    """
    @property
    def A(self, /) -> NDArray[float64]:
        """
        System matrix, of shape (states, states).
        """
    @property
    def B(self, /) -> NDArray[float64]:
        """
        Input matrix, of shape (states, inputs).
        """
    @property
    def C(self, /) -> NDArray[float64]:
        """
        Output matrix, of shape (outputs, states).
        """
    @property
    def D(self, /) -> NDArray[float64]:
        """
        Feedthrough matrix, of shape (outputs, inputs).
        """
    def __getnewargs__(self, /) -> tuple[Any, ...]: ...
    def __new__(cls, /, matrices: SupportsLenAndGetItem[Incomplete], signals: SupportsLenAndGetItem[Sequence[tuple[str, str]]], poles: Sequence[tuple[SupportsFloat | SupportsIndex, SupportsFloat | SupportsIndex]], point: Sequence[tuple[str, SupportsFloat | SupportsIndex]], warnings: Sequence[str], json: str) -> LinearModel: ...
    def __repr__(self, /) -> str: ...
    def bode(self, /, input: str | None = None, outputs: Sequence[str] | None = None, ax: Sequence[Axes] | None = None) -> Figure:
        """
        Draw magnitude and phase of outputs over one input with Matplotlib, without the delays of the inputs.

        Parameters
        ----------
        input : str, optional
            Name of the input; by default the first, which is that of the valve where there is one.
        outputs : sequence of str, optional
            Names of the outputs; by default the first two.
        ax : sequence of matplotlib.axes.Axes, optional
            Two axes to draw into, for magnitude and phase. By default a new figure has them.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        InputError
            The model has no signal of that name, or `ax` has not two axes.
        """
    def damp(self, /) -> Modes:
        """
        Return the poles as modes with natural frequency, damping ratio and time constant, the slowest first.

        Returns
        -------
        Modes
            A list of `Mode`; `print` writes it as a table. A pair of conjugate poles is one mode.
        """
    @property
    def delay(self, /) -> dict[str, float]:
        """
        Delay in s from each input to the beginning of its effect, by the input's name.

        It is the dead time of a valve and the delay of a lumped hose. The matrices and `response` leave it out: it multiplies the
        response to that input by `exp(-1j * omega * delay)`.
        """
    @property
    def details(self, /) -> dict[str, Any]:
        """
        Content of `to_json` as a dictionary.

        It has `controllability`, the validity of the mean flow under PWM (`pwm`), whether the braid is taut, and assumed
        values.
        """
    @property
    def inputs(self, /) -> list[str]:
        """
        Names of the inputs.
        """
    @property
    def operating_point(self, /) -> dict[str, float]:
        """
        Values at the operating point in SI, by names that end with the unit, such as `gauge_pressure_pa`.
        """
    @property
    def outputs(self, /) -> list[str]:
        """
        Names of the outputs.
        """
    @property
    def poles(self, /) -> NDArray[complex128]:
        """
        Poles in 1/s.
        """
    def response(self, /, omega: ArrayLike) -> NDArray[complex128]:
        """
        Return the complex frequency response of each output to each input, without the delays of the inputs.

        Parameters
        ----------
        omega : array_like
            Angular frequencies in rad/s, finite.

        Returns
        -------
        numpy.ndarray
            Response of shape (len(omega), outputs, inputs), in the unit of the output over that of the input.

        Raises
        ------
        InputError
            A frequency is not finite, or a pole lies at it, as that of an integrator at zero: the response there is without bound.
        """
    @property
    def states(self, /) -> list[str]:
        """
        Names of the states.
        """
    def to_control(self, /) -> Any:
        """
        Return the model as a system of python-control, with the names of its signals.

        Returns
        -------
        control.StateSpace
            In its names an underscore stands for each point, which python-control refuses: `biceps_duty` for `biceps.duty`. Delays
            are left out.
        """
    def to_json(self, /) -> str:
        """
        Return the model as JSON, as `mckibben linearize --output model.json` writes it.

        Returns
        -------
        str
        """
    @property
    def units(self, /) -> dict[str, str]:
        """
        Units of states, inputs and outputs by their names, in SI; empty for a pure number.
        """
    @property
    def validity(self, /) -> Validity:
        """
        Validity of the model as a `Validity`.

        It has controllability, whether the braid is taut, dead zone and ripple of each valve under PWM, and the warnings.
        """
    @property
    def warnings(self, /) -> list[str]:
        """
        Reasons to doubt the model.

        Examples are a duty cycle to which the valve does not respond, a pressure ripple that is too large, and pulses that are
        too slow. `linearize` raises each as a `UserWarning` too.
        """

@final
class Response:
    """
    Tension of an actuator with its partial derivatives, and the rates of its air.

    `Actuator.step` and `Actuator.respond` return it; the constructor serves pickling.

    Examples
    --------
    The tension rises with the length and with the pressure:

        >>> import mckibben
        >>> muscle = mckibben.Actuator(mckibben.Scenario.from_dict({
        ...     "load": {"kind": "isometric"},
        ...     "initial": {"length": "85 mm", "gauge_pressure": "40 psi"},
        ...     "run": {"duration": "1 s"},
        ... }))
        >>> response = muscle.respond(muscle.start(), velocity=0.01)
        >>> response.per_length > 0.0, response.per_pressure > 0.0
        (True, True)
    """
    def __eq__(self, other: object, /) -> bool:
        """
        Return whether both responses have equal numbers.
        """
    def __getnewargs__(self, /) -> tuple[float, float, float, float, float, float, float, float]: ...
    def __new__(cls, /, tension: SupportsFloat | SupportsIndex, per_length: SupportsFloat | SupportsIndex, per_velocity: SupportsFloat | SupportsIndex, per_pressure: SupportsFloat | SupportsIndex, pressure_rate: SupportsFloat | SupportsIndex, mass_flow: SupportsFloat | SupportsIndex, temperature: SupportsFloat | SupportsIndex, volume: SupportsFloat | SupportsIndex) -> Response: ...
    def __repr__(self, /) -> str: ...
    @property
    def mass_flow(self, /) -> float:
        """
        Net mass flow into the actuator in kg/s.
        """
    @property
    def per_length(self, /) -> float:
        """
        Partial derivative of the tension with respect to the length at constant pressure, in N/m.
        """
    @property
    def per_pressure(self, /) -> float:
        """
        Partial derivative of the tension with respect to the pressure, in m^2.
        """
    @property
    def per_velocity(self, /) -> float:
        """
        Partial derivative of the tension with respect to the velocity, in N*s/m.
        """
    @property
    def pressure_rate(self, /) -> float:
        """
        Rate of change of the pressure in Pa/s.
        """
    @property
    def temperature(self, /) -> float:
        """
        Temperature of the air in K.
        """
    @property
    def tension(self, /) -> float:
        """
        Tension in N, zero or more.
        """
    @property
    def volume(self, /) -> float:
        """
        Volume of the air in m^3, in the braid and outside it.
        """

@final
class Scenario:
    """
    One experiment: what is built, what drives it and what is recorded, as in a scenario file.

    A quantity is text with its unit, such as "60 psi"; in values from Python it may be a number in SI. A scenario is immutable:
    `with_values` returns another one. Sections are attributes: `scenario.load.mass` is a number in SI. Two scenarios are equal
    if `to_toml` returns equal text: a section `[sweep]` counts, and whether an engine is given.

    Parameters
    ----------
    text : str
        Scenario as TOML.
    name : str, optional
        Name that messages show in place of that of a file; "scenario.toml" by default.
    values : sequence of (str, str), optional
        Paths of keys with values as TOML, which replace those of the text; none by default.
    in_si : bool, optional
        Whether numbers without a unit are quantities in SI. By default they are refused.

    Raises
    ------
    InputError
        The text is not TOML, or the scenario is not valid. The message names the place, the range and the remedy.

    Examples
    --------
        >>> import mckibben
        >>> scenario = mckibben.Scenario('''
        ...     [load]
        ...     kind = "hanging-mass"
        ...     mass = "2 kg"
        ...     [initial]
        ...     gauge_pressure = "60 psi"
        ...     [run]
        ...     duration = "0.1 s"
        ... ''')
        >>> scenario.load.mass, scenario.load.kind
        (2.0, 'hanging-mass')
    """
    def __dir__(self, /) -> Any: ...
    def __eq__(self, other: object, /) -> bool:
        """
        Return whether both scenarios have equal values.
        """
    def __getattr__(self, name: str, /) -> Any:
        """
        Return a section or a value by its name, such as `scenario.load.mass`: a quantity is a number in SI.
        """
    def __getnewargs__(self, /) -> tuple[str, str, list[tuple[str, str]], bool]: ...
    def __new__(cls, /, text: str, name: str = "scenario.toml", values: Sequence[tuple[str, str]] = ..., in_si: bool = False) -> Scenario: ...
    def __repr__(self, /) -> str: ...
    def __str__(self, /) -> str: ...
    def _given(self, /) -> str:
        """
        Return the scenario as TOML in which each key stands as it was given, with presets, for keys that are set later.
        """
    def _repr_html_(self, /) -> Any: ...
    def _settled(self, /) -> tuple[bool, float, int, int, list[tuple[str, str, list[float]]]]:
        """
        Return the orbit and its columns, each with its unit, mean, ripple, least and greatest value.
        """
    def diff(self, /, other: Scenario) -> dict[str, Any]:
        """
        Return the values in which another scenario differs.

        Parameters
        ----------
        other : Scenario
            Scenario to compare with.

        Returns
        -------
        dict of str to tuple
            For each path of a key the value here and that of `other`, as in `to_dict`; `None` where there is none.

        Examples
        --------
            >>> import mckibben
            >>> scenario = mckibben.Scenario.from_dict({
            ...     "load": {"kind": "hanging-mass", "mass": "2 kg"},
            ...     "initial": {"gauge_pressure": "60 psi"},
            ...     "run": {"duration": "0.1 s"},
            ... })
            >>> scenario.diff(scenario.with_values({"load.mass": 3.5}))
            {'load.mass': ('2 kg', '3.5 kg')}
        """
    @staticmethod
    def from_dict(values: Mapping[str, Any], name: str = "scenario.toml") -> Scenario:
        """
        Make a scenario from a dictionary of its sections, as `tomllib` reads them from a file.

        Parameters
        ----------
        values : mapping
            Sections with their keys. A quantity is text with its unit, or a number in SI. Lists may be NumPy arrays, and
            numbers those of NumPy.
        name : str, optional
            Name that messages show in place of that of a file; "scenario.toml" by default. They show the dictionary as TOML.

        Returns
        -------
        Scenario

        Raises
        ------
        InputError
            The scenario is not valid, or the dictionary contains itself, has more than 64 levels or more than 2 000 000 values.
        TypeError
            A key is not text, or a value is of a type that no scenario has.

        Examples
        --------
            >>> import mckibben
            >>> mckibben.Scenario.from_dict({
            ...     "load": {"kind": "hanging-mass", "mass": 2.0},
            ...     "initial": {"gauge_pressure": "60 psi"},
            ...     "run": {"duration": "0.1 s"},
            ... })
            <mckibben.Scenario "scenario.toml">
        """
    @staticmethod
    def from_file(path: str | PathLike[str]) -> Scenario:
        """
        Read a scenario file.

        Parameters
        ----------
        path : str or path
            TOML file.

        Returns
        -------
        Scenario

        Raises
        ------
        InputError
            The file cannot be read, is not TOML, or is not a valid scenario.
        """
    @property
    def name(self, /) -> str:
        """
        Name of the file, or that given in its place.
        """
    def settle(self, /) -> Settled:
        """
        Run the scenario and on behind its end to the periodic orbit, or to the equilibrium where nothing is pulsed.

        The orbit is that of the period that all pulses have in common. Where nothing but states is remembered it is found as a
        fixed point of the map from one period to the next, also where nothing damps the swing of the start.

        Returns
        -------
        Settled
            Mean, ripple, least and greatest value of each column of numbers over a period.

        Raises
        ------
        InputError
            The pulses have no common period of up to a thousand of the fastest.
        SimulationError
            The simulation cannot go on.

        Notes
        -----
        The interpreter is released, so other threads continue. Ctrl-C ends it.

        Examples
        --------
            >>> import mckibben
            >>> scenario = mckibben.Scenario.from_dict({
            ...     "load": {"kind": "hanging-mass", "mass": "2 kg"},
            ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
            ...     "run": {"duration": "0.1 s"},
            ... })
            >>> settled = scenario.settle()
            >>> bool(abs(settled["tension"].mean - 2 * 9.80665) < 1e-4)
            True
        """
    @property
    def text(self, /) -> str:
        """
        Text as it was read, without the values that `with_values` set.
        """
    def to_dict(self, /) -> dict[str, Any]:
        """
        Return the content of `to_toml` as a dictionary of sections, which `from_dict` accepts.

        Returns
        -------
        dict
        """
    def to_toml(self, /) -> str:
        """
        Return the scenario as TOML: every value in SI, those of presets and defaults written out.

        Where no engine is given none is written, as a sweep chooses it then. Of several actuators with names, and of a scenario with
        a section `[sweep]`: every key that was given, with its value as it was written.

        Returns
        -------
        str
        """
    def with_values(self, /, values: Mapping[str, Any]) -> Scenario:
        """
        Return a scenario with other values.

        Parameters
        ----------
        values : mapping
            Values by the paths of their keys, such as `{"load.mass": "10 lb", "command.duty": 0.3}`. A quantity is text with
            its unit, or a number in SI.

        Returns
        -------
        Scenario
            A new scenario; this one is unchanged.

        Raises
        ------
        InputError
            There is no such key, or the scenario is not valid with these values.
        TypeError
            A value is of a type that no scenario has.

        Examples
        --------
            >>> import mckibben
            >>> scenario = mckibben.Scenario.from_dict({
            ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
            ...     "initial": {"gauge_pressure": "60 psi"},
            ...     "run": {"duration": "0.1 s"},
            ... })
            >>> scenario.with_values({"load.mass": 3.5}).load.mass
            3.5
        """

@final
class Sweep:
    """
    Runs of a scenario's section `[sweep]`, in parts that can be computed anywhere.

    `mckibben.sweep` computes all of them; this class is for your own scheduler. Parts are bit-identical to those of
    `mckibben sweep`.

    Parameters
    ----------
    scenario : Scenario
        Scenario with a section `[sweep]`.
    chosen : tuple, optional
        Step of the fixed-step engine for all runs: its length in s, the accuracy, the runs that reach it and those that do not.
        By default it is chosen here, where the scenario leaves it open.

    Raises
    ------
    InputError
        The scenario has no section `[sweep]`, or the section is not valid.

    Examples
    --------
        >>> import mckibben
        >>> sweep = mckibben.Sweep(mckibben.Scenario.from_dict({
        ...     "load": {"kind": "hanging-mass"},
        ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
        ...     "run": {"duration": "20 ms"},
        ...     "sweep": {"reductions": ["length.final"], "vary": {"load.mass": ["4 lb", "5 lb", "6 lb"]}},
        ... }))
        >>> sweep.rows, sweep.parts, sweep.units["length_final_m"]
        (3, 1, 'm')
        >>> sweep.part(0)[:4]
        b'PAR1'
    """
    def __getnewargs__(self, /) -> tuple[Scenario, tuple[float, float, list[int], list[int]] | None]: ...
    def __new__(cls, /, scenario: Scenario, chosen: tuple[SupportsFloat | SupportsIndex, SupportsFloat | SupportsIndex, Sequence[SupportsIndex], Sequence[SupportsIndex]] | None = None) -> Sweep: ...
    def __repr__(self, /) -> str: ...
    @property
    def columns(self, /) -> list[str]:
        """
        Names of the columns of the table, in their order.
        """
    @property
    def left_out(self, /) -> list[str]:
        """
        Keys that runs leave out, since they have no meaning under a word of another key that varies: a sentence each.
        """
    @property
    def logarithmic(self, /) -> list[str]:
        """
        Names of the columns of varied keys whose values are spaced or distributed evenly in their logarithm.
        """
    def missing(self, /, folder: str | PathLike[str]) -> tuple[list[int], int]:
        """
        Create the folder of the sweep, or open one that holds the same sweep, and return what is missing in it.

        Parameters
        ----------
        folder : str or path
            Folder of the sweep.

        Returns
        -------
        parts : list of int
            Indices of the parts that are not finished.
        failed : int
            Number of runs that failed in the finished parts.

        Raises
        ------
        InputError
            The folder holds something else, or a damaged part.
        OutputError
            The folder cannot be written to.
        """
    def part(self, /, part: SupportsIndex) -> bytes:
        """
        Compute a part on one thread, with the interpreter released.

        Parameters
        ----------
        part : int
            Index of the part, from 0.

        Returns
        -------
        bytes
            Content of its Parquet file.

        Raises
        ------
        InputError
            There is no such part.
        """
    @property
    def parts(self, /) -> int:
        """
        Number of parts, each of which is a Parquet file.
        """
    def put(self, /, folder: str | PathLike[str], part: SupportsIndex, bytes: bytes) -> None:
        """
        Write a part into the folder, whole or not at all.

        Parameters
        ----------
        folder : str or path
            Folder of the sweep.
        part : int
            Index of the part, from 0.
        bytes : bytes
            Content of its Parquet file, as `part` returns it.

        Raises
        ------
        InputError
            The folder holds something else, or the bytes are not that part, whole; what stands in its place stays.
        OutputError
            The file cannot be written.
        """
    @property
    def rows(self, /) -> int:
        """
        Number of runs.
        """
    def run(self, /, folder: str | PathLike[str], jobs: SupportsIndex | None = None, progress: Callable[..., Any] | None = None) -> None:
        """
        Compute the missing parts into the folder on several threads.

        Parameters
        ----------
        folder : str or path
            Folder of the sweep; created where there is none.
        jobs : int, optional
            Number of threads, from 1 to 4096; one for each core by default.
        progress : callable, optional
            Called as `progress(done, parts)` after every few parts, with the number of finished parts and of all. An exception
            that it raises ends the sweep.

        Raises
        ------
        InputError
            The folder holds something else, or `jobs` is out of range.
        OutputError
            A file cannot be written.

        Notes
        -----
        Ctrl-C ends the runs in progress; the parts that are finished by then stay in the folder. An exception of `progress` ends the
        sweep between parts. A run on its way to an orbit (`sweep.over`), and the trial of steps before the runs, are not ended.
        """
    @property
    def scenario(self, /) -> Scenario:
        """
        Scenario whose section `[sweep]` is run.
        """
    @property
    def step(self, /) -> float | None:
        """
        Longest step in s of the fixed-step engine, chosen for all runs; `None` where each run has its own.
        """
    @property
    def units(self, /) -> dict[str, str]:
        """
        Units of the columns of numbers by their names, in SI.
        """
    def warnings(self, /, folder: str | PathLike[str]) -> list[tuple[str, int, int, str]]:
        """
        Warnings of the runs in the finished parts of the folder: codes, how many runs, the first of them, and what it says there.

        Parameters
        ----------
        folder : str or path
            Folder of the sweep.

        Returns
        -------
        list of tuple
            Code, number of runs, index of the first, and a sentence, for each code.

        Raises
        ------
        InputError
            The folder holds something else, or a damaged part.
        """

@final
class Trajectory:
    """
    Result of a run: its columns as NumPy arrays, its events, and its values between the samples.

    There is a sample at t = 0, at every `run.sample_interval` and at the end. `trajectory["absolute_pressure_pa"]` is a column
    by its name in the files of `mckibben simulate`; those that every run of one actuator or joint has are attributes too.
    Arrays are read-only: copy one to change it. `simulate` returns a trajectory; the constructor serves pickling.

    Notes
    -----
    Columns of a joint are those of its agonist, and those of its antagonist begin with `antagonist_`, as `antagonist_length_m`.
    Of several actuators with names every column has a name in front: `flexor.absolute_pressure_pa`, `elbow.angle_rad`,
    `tank.absolute_pressure_pa`. `len` is the number of samples; iteration, `in` and `dict` go by the names of the columns.

    A trajectory from a pickle simulates the scenario again when a value between the samples, the summary or a file is
    requested.

    Examples
    --------
        >>> import mckibben
        >>> run = mckibben.simulate(mckibben.Scenario.from_dict({
        ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
        ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
        ...     "run": {"duration": "0.1 s"},
        ... }))
        >>> run.length is run["length_m"], run.units["tension_n"]
        (True, 'N')
        >>> run.at(0.0)["length_m"]
        0.085
    """
    def __contains__(self, name: Any, /) -> bool:
        """
        Return whether there is a column of this name.
        """
    def __getitem__(self, name: str, /) -> NDArray[Any]:
        """
        Return a column by its name, such as "length_m" or "hose_absolute_pressure_pa".
        """
    def __getnewargs__(self, /) -> tuple[Any, ...]: ...
    def __iter__(self, /) -> Iterator[str]:
        """
        Iterate over the names of the columns in their order.
        """
    def __len__(self, /) -> int:
        """
        Return the number of samples.
        """
    def __new__(cls, /, scenario: Scenario, columns: Sequence[tuple[str, str, Any]], events: Sequence[Event]) -> Trajectory:
        """
        Restore a trajectory from a pickle.
        """
    def __repr__(self, /) -> str: ...
    def _figures(self, /) -> tuple[list[tuple[str, float, str]], list[tuple[str, int]], list[tuple[str, str]]]:
        """
        Return numbers with their names and units, counts of events, and assumed values.
        """
    def _repr_svg_(self, /) -> str: ...
    @property
    def absolute_pressure(self, /) -> NDArray[float64]:
        """
        Absolute pressures of the actuator's air in Pa.
        """
    @property
    def air_mass(self, /) -> NDArray[float64]:
        """
        Masses of the actuator's air in kg.
        """
    @property
    def angle(self, /) -> NDArray[float64]:
        """
        Angles of a joint in rad, above zero where the agonist is shorter.
        """
    @property
    def angular_velocity(self, /) -> NDArray[float64]:
        """
        Angular velocities of a joint in rad/s.
        """
    def at(self, /, time: float) -> dict[str, Any]:
        """
        Return every column at one time, from the interpolating polynomials of the steps.

        Parameters
        ----------
        time : float
            Time in s, from 0 to the end of the run.

        Returns
        -------
        dict of str to float or str
            Values by the names of the columns.

        Raises
        ------
        InputError
            The time is outside the run.
        """
    def at_times(self, /, times: ArrayLike) -> dict[str, NDArray[Any]]:
        """
        Return every column at several times, from the interpolating polynomials of the steps.

        Parameters
        ----------
        times : array_like
            Times in s, from 0 to the end of the run, in any number.

        Returns
        -------
        dict of str to numpy.ndarray
            Arrays of shape (len(times),) by the names of the columns.

        Raises
        ------
        InputError
            A time is not finite or outside the run.
        """
    @property
    def columns(self, /) -> list[str]:
        """
        Names of the columns in their order; that of a column of numbers ends with its unit.
        """
    @property
    def events(self, /) -> list[Event]:
        """
        Events in order of time.
        """
    def events_to_pandas(self, /) -> DataFrame:
        """
        Return the log of events as a data frame of pandas.

        Returns
        -------
        pandas.DataFrame
            A row for each event: `time_s`, `event`, and the discrete state after it.
        """
    @property
    def gauge_pressure(self, /) -> NDArray[float64]:
        """
        Gauge pressures of the actuator's air in Pa.
        """
    def keys(self, /) -> list[str]:
        """
        Return the names of the columns in their order, so that `dict(run)` has the columns.

        Returns
        -------
        list of str
        """
    @property
    def length(self, /) -> NDArray[float64]:
        """
        Distances between the attachments in m; of a joint, that of its agonist.
        """
    @property
    def mass_flow(self, /) -> NDArray[float64]:
        """
        Net mass flows into the actuator in kg/s.
        """
    def plot(self, /, columns: Sequence[str] | None = None, ax: Sequence[Axes] | None = None) -> Figure:
        """
        Draw columns over time with Matplotlib, in a panel for each.

        Parameters
        ----------
        columns : sequence of str, optional
            Names of columns. By default length, pressure and tension; of a joint its angle in place of the length; of several
            actuators angles too, with a line for each actuator or joint.
        ax : sequence of matplotlib.axes.Axes, optional
            Axes to draw into, one for each panel. By default a new figure has them.

        Returns
        -------
        matplotlib.figure.Figure

        Raises
        ------
        InputError
            `columns` is empty, or `ax` has another number of axes.
        KeyError
            There is no column of that name.
        """
    @property
    def scenario(self, /) -> Scenario:
        """
        Scenario that was run.
        """
    def summary(self, /) -> Summary:
        """
        Return figures of the run by the names of the reductions of a sweep.

        They are extremes, ripple, air consumption, energy and exergy, the chosen step and its error, counts of events, and
        assumed values. Extremes are those of the run between its samples too; those of a sweep are of the samples alone.

        Returns
        -------
        Summary
            A mapping of names such as "length.final" to numbers in SI, with `units`, `events` and `assumed`.

        Raises
        ------
        SimulationError
            One of the numbers is not finite.

        Examples
        --------
            >>> import mckibben
            >>> run = mckibben.simulate(mckibben.Scenario.from_dict({
            ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
            ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
            ...     "run": {"duration": "0.1 s"},
            ... }))
            >>> bool(run.summary()["length.final"] == run.length[-1])
            True
        """
    @property
    def t(self, /) -> NDArray[float64]:
        """
        Times of the samples in s.
        """
    @property
    def temperature(self, /) -> NDArray[float64]:
        """
        Temperatures of the actuator's air in K.
        """
    @property
    def tension(self, /) -> NDArray[float64]:
        """
        Tensions in N, zero or more: an actuator only pulls.
        """
    def to_csv(self, /, path: str | PathLike[str]) -> None:
        """
        Write the columns as CSV: byte for byte the file of `mckibben simulate --output`.

        Parameters
        ----------
        path : str or path
            File to write.

        Raises
        ------
        OutputError
            The file cannot be written; then none is left behind.
        SimulationError
            A number of `summary()` is not finite.
        """
    def to_dict(self, /) -> dict[str, NDArray[Any]]:
        """
        Return the columns as arrays by their names, in their order.

        Returns
        -------
        dict of str to numpy.ndarray
        """
    def to_mat(self, /, path: str | PathLike[str]) -> None:
        """
        Write the columns as a MAT-file for MATLAB, Octave and SciPy, as `mckibben simulate --output` does.

        Each column is a variable; points in names become underscores.

        Parameters
        ----------
        path : str or path
            File to write.

        Raises
        ------
        OutputError
            The file cannot be written; then none is left behind.
        SimulationError
            A number of `summary()` is not finite.
        """
    def to_pandas(self, /) -> DataFrame:
        """
        Return the columns as a data frame of pandas, with the units in `attrs["units"]`.

        Returns
        -------
        pandas.DataFrame
            A row for each sample.
        """
    def to_parquet(self, /, path: str | PathLike[str]) -> None:
        """
        Write the columns as Parquet: the columns and the numbers of the file of `mckibben simulate --output`.

        Parameters
        ----------
        path : str or path
            File to write.

        Raises
        ------
        OutputError
            The file cannot be written; then none is left behind.
        SimulationError
            A number of `summary()` is not finite.
        """
    def to_polars(self, /) -> DataFrame2:
        """
        Return the columns as a data frame of Polars.

        Returns
        -------
        polars.DataFrame
            A row for each sample.
        """
    def to_svg(self, /, over: Literal["time", "length"] = ...) -> str:
        """
        Return the figure of `mckibben simulate --plot` as SVG.

        Parameters
        ----------
        over : {"time", "length"}, optional
            Horizontal axis: time by default, or the length, over which the tension is drawn. The figure of several actuators is
            always over time.

        Returns
        -------
        str

        Raises
        ------
        InputError
            `over` is another word.
        """
    @property
    def torque(self, /) -> NDArray[float64]:
        """
        Torques of both actuators on a joint in N*m.
        """
    @property
    def units(self, /) -> dict[str, str]:
        """
        Units of the columns of numbers by their names, in SI.
        """
    @property
    def valve(self, /) -> NDArray[str_]:
        """
        Open ports of the valve: "supply", "exhaust", "supply+exhaust" or "closed".
        """
    @property
    def velocity(self, /) -> NDArray[float64]:
        """
        Rates of the length in m/s, above zero while lengthening.
        """
    @property
    def volume(self, /) -> NDArray[float64]:
        """
        Volumes of the actuator's air in m^3, in the braid and outside it.
        """
    @property
    def warnings(self, /) -> list[str]:
        """
        Warnings of what the scenario cannot mean, such as a valve that never opens or a length that no braid has.

        Each is one sentence that names the quantity, its value, the limit and the key to change. Of several actuators it begins
        with the name of the part. Where a number of `summary()` is not finite, `SimulationError` names it.
        """

@final
class VectorPlant:
    """
    Many instances of a scenario's plant, stepped together on all cores, whose valves the caller commands.

    Each instance may be reset, with its own values of parameters, while the others continue. The environments of
    `mckibben.learning` are made of it. The caller owns the arrays that `step` and `observe` use: they are C-contiguous, and are
    read and written in place. `values` and `rows` may have any memory layout. An array of other numbers or dimensions raises
    `TypeError`.

    Parameters
    ----------
    scenario : Scenario
        Any plant with a valve: one actuator with its load, an antagonistic joint, or several actuators with names on their
        mechanisms. Its controllers and the commands of the actuators' valves are not used; supplies follow theirs.
    count : int
        Number of instances.
    parameters : sequence of str, optional
        Paths of the parameters that differ between the instances: "load.mass", "initial.gauge_pressure"; where actuators have
        names also "actuators.biceps.friction.viscous" and "mechanism.joints.elbow.damping"; none by default.
    action_mode : {"duty", "request", "position", "set-point"}, optional
        What an action is: a duty cycle from 0 to 1 (the default); a request, 1 to fill, 0 to hold, -1 to exhaust; the position
        of a proportional spool from -1 to 1; the set point of a pressure regulator, a gauge pressure in Pa.
    pulse_frequency : float or str, optional
        Frequency in Hz, above zero, or text with a unit, of the pulses of all duty cycles. By default that of the scenario's first PWM.
        What is requested in the pulses of a valve and between them its own PWM says, or the first one where its command is no PWM.
    precision : {"double", "single"}, optional
        Numbers that the instances are stepped in; double by default. Single precision takes twice as many at once, and keeps seven digits of a
        state: what a step changes below the last of them is lost. It needs a package that is built with the feature `f32`.

    Raises
    ------
    InputError
        The plant has no valve, a valve does not take such actions, or there is no such parameter, or one that changes nothing of the
        plant.
    MemoryError
        This machine does not have the memory for so many instances.

    Notes
    -----
    Steps are fixed and by `run.method`, each no longer than `run.step`, or where that is not given than `run.accuracy` needs. A
    copy, or an instance from a pickle, is reset: it has the same scenario and options, at t = 0.

    Examples
    --------
        >>> import mckibben, numpy
        >>> scenario = mckibben.Scenario.from_dict({
        ...     "supply": {"gauge_pressure": "100 psi"},
        ...     "valve": {"preset": "matrix-eight-channel"},
        ...     "command": {"kind": "pwm", "frequency": "25 Hz", "duty": 0.5},
        ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
        ...     "initial": {"gauge_pressure": "40 psi", "length": "equilibrium"},
        ...     "run": {"duration": "1 s", "engine": "fixed-step", "step": "0.5 ms"},
        ... })
        >>> plants = mckibben.VectorPlant(scenario, 2, parameters=["load.mass"], action_mode="request")
        >>> plants.start(numpy.array([[2.0], [3.0]]))
        >>> observations, stopped = numpy.zeros((2, len(plants.columns))), numpy.zeros(2, dtype=bool)
        >>> plants.step(numpy.array([[1.0], [-1.0]]), 0.02, observations, stopped)
        >>> plants.columns[0], bool(stopped.any()), float(plants.time[0])
        ('length_m', False, 0.02)
    """
    def __getnewargs_ex__(self, /) -> tuple[tuple[Scenario, int], dict[str, Any]]: ...
    def __len__(self, /) -> int: ...
    def __new__(cls, /, scenario: Scenario, count: int, *, parameters: Sequence[str] = ..., action_mode: Literal["duty", "request", "position", "set-point"] = ..., pulse_frequency: float | str | None = None, precision: Literal["double", "single"] = ...) -> VectorPlant: ...
    def __repr__(self, /) -> str: ...
    @property
    def columns(self, /) -> list[str]:
        """
        Names of the observations of an instance, as of the columns of a run.
        """
    @staticmethod
    def columns_of(scenario: Scenario) -> list[str]:
        """
        Return the names of the observations of a scenario's plant, without making one.

        Parameters
        ----------
        scenario : Scenario
            Any plant.

        Returns
        -------
        list of str
            The `columns` of its `VectorPlant`.

        Raises
        ------
        InputError
            The model finds a contradiction in the scenario.
        """
    @property
    def command_range(self, /) -> NDArray[float64]:
        """
        Least and greatest command of each valve of each instance, float64 of shape (2, count, valves), as `action_mode` says.

        Set points end at the gauge pressure in Pa of what feeds the valve of the instance.
        """
    @property
    def defaults(self, /) -> NDArray[float64]:
        """
        Values of `parameters` in the scenario, in SI.
        """
    def differ(self, /, one: ArrayLike, other: ArrayLike) -> bool:
        """
        Return whether two sets of values of `parameters` give different plants, the commands of valves aside.

        Parameters
        ----------
        one : array_like
            Values in SI, one for each of `parameters`.
        other : array_like
            Values to compare with.

        Returns
        -------
        bool

        Raises
        ------
        InputError
            A value is missing or not valid.
        """
    @property
    def duration(self, /) -> float:
        """
        Duration of the scenario in s.
        """
    def observe(self, /, rows: NDArray[int64], observations: NDArray[float64]) -> None:
        """
        Write the current observations of some instances.

        Parameters
        ----------
        rows : numpy.ndarray
            Indices of the instances, int64, from 0.
        observations : numpy.ndarray
            Receives the observations in SI in the rows of these instances, float64 of shape (count, len(columns)).

        Raises
        ------
        InputError
            There is no such instance, or `observations` is of another shape or not C-contiguous.
        """
    @property
    def parameters(self, /) -> list[str]:
        """
        Paths of the parameters that differ between the instances.
        """
    @property
    def pulses(self, /) -> float | None:
        """
        Frequency of the pulses in Hz; `None` unless `action_mode` is "duty".
        """
    @property
    def requests(self, /) -> list[float]:
        """
        Requests that every valve can do, of 1 (fill), 0 (hold) and -1 (exhaust).
        """
    def restart(self, /, rows: NDArray[int64], values: NDArray[float64] | None = None) -> None:
        """
        Reset some instances, without a command to their valves, while the others continue.

        Parameters
        ----------
        rows : numpy.ndarray
            Indices of the instances, int64, from 0, each once.
        values : numpy.ndarray, optional
            Values of `parameters` in SI, float64 of shape (len(rows), len(parameters)); those of the scenario by default.

        Raises
        ------
        InputError
            There is no such instance, an index is given twice, or a value is not valid; nothing has changed.
        """
    @property
    def scenario(self, /) -> Scenario:
        """
        Scenario of the plant.
        """
    def start(self, /, values: NDArray[float64] | None = None) -> None:
        """
        Reset all instances to t = 0, without a command to their valves, and restart the clock.

        Parameters
        ----------
        values : numpy.ndarray, optional
            Values of `parameters` in SI, float64 of shape (count, len(parameters)); those of the scenario by default.

        Raises
        ------
        InputError
            A value is not valid; nothing has changed.
        """
    def step(self, /, actions: NDArray[float64], dt: float | str, observations: NDArray[float64], stopped: NDArray[bool_]) -> None:
        """
        Command the valves, advance all instances, and write their observations.

        Parameters
        ----------
        actions : numpy.ndarray
            Commands of the valves, float64 of shape (count, valves), as `action_mode` says.
        dt : float or str
            Duration of the step in s, above zero, or text with a unit.
        observations : numpy.ndarray
            Receives the observations in SI, float64 of shape (count, len(columns)).
        stopped : numpy.ndarray
            Receives which instances have produced a non-physical state, bool of shape (count,). Their observations stay as they
            are, and only `restart` or `start` brings them back.

        Raises
        ------
        InputError
            An action is not valid, an array is of another shape or not C-contiguous, or there are more than 10 000 000 steps and
            edges of pulses; nothing has changed.

        Notes
        -----
        Ctrl-C ends a step of many parts between two of them.
        """
    @property
    def time(self, /) -> NDArray[float64]:
        """
        Time in s of each instance on the clock of the pulses, which all share and `start` restarts.

        Pulse p begins at p / `pulses`.
        """
    @property
    def valve_delay(self, /) -> float:
        """
        Longest time in s from a command to its effect at a valve.

        It is the longest delay of a coil or dead time of a pressure regulator, and what a hose adds.
        """
    @property
    def valves(self, /) -> int:
        """
        Number of valves of an instance.
        """

@final
class _Sizes:
    """
    What `mckibben.Sizes` is made of.
    """
    def __new__(cls, /, load: float | str, stroke: float | str, gauge_pressure: float | str, braid_angles: Sequence[float | str], effectiveness: float | str, most_length: float | str | None, most_diameter: float | str | None, time: float | str | None, ripple: float | str | None) -> _Sizes: ...
    def candidates(self, /) -> list[tuple[str, int, list[float], float | None, tuple[float, float] | None]]:
        """
        The candidates, those that take the least air first.
        """
    def hoses(self, /, place: SupportsIndex, length: float | str) -> list[tuple[float, float | None]]:
        """
        Inner diameters in m of hoses of a length, each with the least conductance of the valve behind it.
        """
    def left_out(self, /) -> list[str]:
        """
        What does not do it, and why.
        """
    def scenario(self, /, place: SupportsIndex) -> str:
        """
        The scenario of a candidate as TOML.
        """
    def valves(self, /, place: SupportsIndex) -> list[tuple[str, float | None]]:
        """
        Named valves, each with the time in s in which it does nine tenths of the stroke.
        """

@final
class _Statics:
    """
    What `mckibben.Statics` computes with, on flat arrays of one length.
    """
    def __new__(cls, /, scenario: Scenario) -> _Statics: ...
    def force(self, /, length: ArrayLike, gauge: ArrayLike) -> NDArray[float64]:
        """
        Static force in N, zero where the braid would push.
        """
    def gauge_pressure_for(self, /, length: ArrayLike, force: ArrayLike, most: float | str) -> NDArray[float64]:
        """
        The least gauge pressure in Pa, up to `most`, that bears a force at a length.
        """
    def length_for(self, /, gauge: ArrayLike, force: ArrayLike) -> NDArray[float64]:
        """
        The length in m at which the actuator bears a force at a gauge pressure.
        """
    @property
    def reach(self, /) -> tuple[float, float]:
        """
        Shortest and longest length in m.
        """
    def sealed_stiffness(self, /, length: ArrayLike, gauge: ArrayLike) -> NDArray[float64]:
        """
        Stiffness in N/m with the valve shut (5); zero where the muscle is slack.
        """
    def stiffness(self, /, length: ArrayLike, gauge: ArrayLike) -> NDArray[float64]:
        """
        Stiffness in N/m at constant pressure (7); zero where the muscle is slack.
        """
    @property
    def supply(self, /) -> float | None:
        """
        Gauge pressure of the supply in Pa.
        """
    def volume(self, /, length: ArrayLike) -> NDArray[float64]:
        """
        Volume of the air in m^3 at a length, braid and what is outside it.
        """

def _curves(scenario: Scenario, gauge_pressures: ArrayLike | str | None = None) -> dict[str, NDArray[float64]]:
    """
    Return force, stiffness and volume of a scenario's actuator over length, at rest.

    Parameters
    ----------
    scenario : Scenario
        One actuator.
    gauge_pressures : array_like or str, optional
        Gauge pressures in Pa, or text such as "35, 45, 55 psi"; those of the paper's Fig. 3 by default.

    Returns
    -------
    dict of str to numpy.ndarray
        Arrays by their names, which end with their units: a row for each pressure, a column for each length, from the shortest
        to the longest. `stiffness_n_m` is equation (7), `sealed_stiffness_n_m` equation (5).
    """

def _design(scenario: Scenario, vary: Sequence[tuple[str, float | str, float | str]], minimize: bool, objective: str, subject_to: Sequence[str], settle: bool, evaluations: int, progress: Callable[..., Any] | None) -> dict[str, Any]:
    """
    Search values of keys.
    """

def _identify(sections: Mapping[str, Any], tables: Sequence[tuple[str, Sequence[tuple[str, ArrayLike]]]], scenario: Scenario, output: str | PathLike[str] | None, progress: Callable[..., Any] | None) -> dict[str, Any]:
    """
    Estimate parameters from a study in memory: its sections as in a file, and its tables by their names.
    """

def _identify_file(study: str | PathLike[str], output: str | PathLike[str] | None, progress: Callable[..., Any] | None) -> dict[str, Any]:
    """
    Estimate parameters from a study file.
    """

def _parameters() -> dict[str, Any]:
    """
    Return the quantities of a scenario as dictionaries by their keys: the arguments of `Parameter` of the package.
    """

def _presets() -> dict[str, Any]:
    """
    Return the named actuators and valves as dictionaries: the arguments of `Preset` and `PresetValue` of the package.
    """

def _quantity(text: str) -> float | None:
    """
    The value in SI of text with a unit; `None` where it is no quantity.
    """

def _register_mujoco() -> None:
    """
    Register the plugin of MuJoCo with the MuJoCo that is loaded.
    """

def _si(name: str, text: str) -> float:
    """
    The value in SI of text in an argument, whose name says what it measures: a length, a force, a time, a frequency or a pressure.
    """

def linearize(scenario: Scenario, *, gauge_pressure: float | str | None = None, length: float | str | None = None, load: float | str | None = None, duty: float | str | None = None, pwm: bool = False, temperature: float | str | None = None, angle: float | str | None = None, stiffness: float | str | None = None, amplitude: float | str | None = None, all_states: bool = False) -> LinearModel:
    """
    Linearize a scenario about an operating point, with exact derivatives.

    Of `gauge_pressure`, `length` and `load` two give the third; what is not given is that of the scenario. A quantity is a
    number in SI or text with its unit, such as "60 psi". The model is that of `mckibben linearize`.

    Parameters
    ----------
    scenario : Scenario
        One actuator, an antagonistic joint, or several actuators with names.
    gauge_pressure : float or str, optional
        Gauge pressure at the point in Pa. Not together with `duty`.
    length : float or str, optional
        Length of the actuator at the point in m.
    load : float or str, optional
        Load at the point: a force in N, or as text also a mass that hangs, such as "10 lb".
    duty : float or str, optional
        Commanded duty cycle at the point, 0 to 1, or as text "40 %"; the pressure follows from the mean flow of the valve under PWM.
    pwm : bool, optional
        Take the mean flow of the valve under PWM, at the duty cycle that holds the pressure; of a pressure regulator the set
        point, of a proportional spool the position. False by default. Not together with `duty`.
    temperature : float or str, optional
        Temperature of the air at the point in K. By default that of the scenario's air, brought to the point by its process.
    angle : float or str, optional
        Angle of a joint at the point in rad; together with `stiffness`.
    stiffness : float or str, optional
        Stiffness in N*m/rad that both actuators give the joint at `angle`, from which the pressures follow.
    amplitude : float or str, optional
        Amplitude in m of an oscillation. Coulomb friction is replaced by the viscous damping that dissipates as much energy.
    all_states : bool, optional
        Keep the air mass as a state where it follows from the others; its pole is zero. False by default.

    Returns
    -------
    LinearModel
        Matrices, names and units of the signals, poles, and warnings.

    Raises
    ------
    InputError
        Arguments exclude each other, a quantity has the wrong unit, or there is no such operating point.

    Warns
    -----
    UserWarning
        Each of the model's `warnings`.

    Notes
    -----
    Without `duty` and `pwm` a scenario whose command is a PWM is averaged at its own duty cycle, and the last set point of a
    regulator or position of a spool is taken likewise, unless `gauge_pressure` or `length` is given. Otherwise the valve is
    held shut, and the mass flow into the actuator is an input.

    Examples
    --------
        >>> import mckibben
        >>> scenario = mckibben.Scenario.from_dict({
        ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
        ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
        ...     "run": {"duration": "0.1 s"},
        ... })
        >>> model = mckibben.linearize(scenario, gauge_pressure="60 psi")
        >>> model.states, model.inputs
        (['length', 'velocity', 'pressure'], ['mass_flow', 'force'])
    """

def simulate(scenario: Scenario, *, progress: Callable[..., Any] | None = None) -> Trajectory:
    """
    Simulate a scenario and return its trajectory.

    The result is bit-identical to that of `mckibben simulate`.

    Parameters
    ----------
    scenario : Scenario
        One actuator, an antagonistic joint, or several actuators with names.
    progress : callable, optional
        Called as `progress(time, end)` with the time that is reached and the duration, both in s, at most about 20 times a
        second. An exception that it raises ends the run.

    Returns
    -------
    Trajectory
        Columns over time, and events.

    Raises
    ------
    InputError
        The model finds a contradiction in the scenario.
    SimulationError
        The simulation cannot continue.

    Notes
    -----
    The interpreter is released during the run, so other threads continue. Ctrl-C ends the run.

    The columns are finite numbers. Those of `summary()` take longer than the run, so they are computed and checked when they are
    first used, as by `warnings` and before a file is written. The whole run is kept, with about 3 kB for each event.

    Examples
    --------
        >>> import mckibben
        >>> scenario = mckibben.Scenario.from_dict({
        ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
        ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
        ...     "run": {"duration": "0.1 s"},
        ... })
        >>> run = mckibben.simulate(scenario)
        >>> float(run.t[-1]), float(run.length[0])
        (0.1, 0.085)
    """

def __getattr__(name: str) -> Incomplete: ...
