"""
What is compiled of the package `mckibben`.
"""

from _typeshed import Incomplete, SupportsLenAndGetItem
from collections.abc import Callable, Iterator, Mapping, Sequence
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from mckibben._results import Modes, Summary
from numpy import bool_, complex128, float64, int64, str_
from numpy.typing import ArrayLike, NDArray
from os import PathLike
from pandas import DataFrame
from polars import DataFrame as DataFrame2
from typing import Any, Final, SupportsFloat, SupportsIndex, final

__all__ = ["__version__", "Actuator", "ActuatorState", "Actuators", "Differentiable", "Event", "LinearModel", "Response", "Scenario", "Sweep", "Trajectory", "VectorPlant", "_identify", "_identify_file", "curves", "linearize", "parameters", "presets", "simulate"]

__version__: Final[str]
"""
The version of the package.
"""

@final
class Actuator:
    """
    The actuator of a scenario, with its air, its valve and its air line, for a loop of one's own: you say what is asked of
    the valve and where the ends are, and it says how hard it pulls.

    The scenario's load and command do not count. `pulse_frequency` in Hz is how often a duty cycle's pulses come; that of
    the scenario's PWM unless given.

    An actuator does not change: `step` takes a state and gives the next, so that any step can be taken again.
    """
    def __getnewargs__(self, /) -> tuple[Scenario, float | None]: ...
    def __new__(cls, /, scenario: Scenario, pulse_frequency: SupportsFloat | SupportsIndex | None = None) -> Actuator: ...
    def __repr__(self, /) -> str: ...
    def respond(self, /, state: ActuatorState, velocity: SupportsFloat | SupportsIndex = 0.0) -> Response:
        """
        What the actuator answers at `state` while its ends move apart at `velocity` in m/s: the tension with which a loop
        begins, and what it would be at another velocity.

        Raises `InputError` for a state of another actuator.
        """
    def rest_length(self, /, gauge_pressure: SupportsFloat | SupportsIndex) -> float:
        """
        The longest distance between the ends in m at which the actuator, at rest at a gauge pressure in Pa and without
        friction, does not pull; its shortest length where it pulls even there. A tendon is included.

        Raises `InputError` for a pressure below vacuum, and where there is no such length.
        """
    @property
    def scenario(self, /) -> Scenario:
        """
        What it was made of.
        """
    def start(self, /) -> ActuatorState:
        """
        The state at t = 0: that of the scenario, with the coils released.
        """
    def step(self, /, state: ActuatorState, length: SupportsFloat | SupportsIndex, velocity: SupportsFloat | SupportsIndex, command: float | str | None, dt: SupportsFloat | SupportsIndex, *, max_step: SupportsFloat | SupportsIndex | None = None) -> tuple[ActuatorState, float, Response]:
        """
        Goes on from `state` by `dt` in s while the ends go in a straight line to a distance of `length` in m.

        `command` is a duty cycle from 0 to 1, "fill", "hold" or "exhaust"; of a pressure regulator the set point, a gauge
        pressure in Pa; of a proportional spool the position from -1 to 1. With `None` what was asked before goes on, and an
        actuator without a valve takes nothing else. `length` includes the tendon, if there is one. `velocity` in m/s is that of
        the ends at the end of the step.

        With `max_step` in s the step is divided into equal parts no longer than that, over which the length is interpolated
        linearly: the air is then as exact as in steps of `max_step`.

        Returns the state there, the tension in N, and the tension's derivatives with the rates of the air.

        Raises `InputError` for what cannot be asked, for a state of another actuator, and for more than 10 000 000 parts and
        edges of pulses; `SimulationError` where the step leaves the physics. Ctrl-C ends a step of many parts.
        """

@final
class ActuatorState:
    """
    Where an `Actuator` is: its air, its valve's seats and pulses, and what its hysteresis remembers.

    It can be pickled; `ActuatorState(numbers)` is one as its pickle has it, in the same version of the package. An actuator of
    the same scenario goes on from there to the same bits; one of another refuses it.

    Raises `InputError` for numbers that are no state.
    """
    def __eq__(self, other: object, /) -> bool:
        """
        Whether both are the same to the bit.
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
        The time in s that has been reached.
        """
    @property
    def valve(self, /) -> str:
        """
        Which port of the valve is open: "supply", "exhaust", "both" or "closed".
        """

@final
class Actuators:
    """
    Many actuators of one scenario, each with its own air, valve and memory, stepped together in loops of your own.

    Arrays are yours: `step` reads and writes them in place, and allocates nothing. They are one-dimensional, of 64-bit
    floating-point numbers, without gaps, with one entry for each actuator. Rows are stepped on all cores; each is an
    `Actuator` by itself, to the bit.

    `pulse_frequency` in Hz is how often a duty cycle's pulses come; that of the scenario's PWM unless given.

    Raises `MemoryError` for a count that this machine has no memory for.
    """
    def __getnewargs__(self, /) -> tuple[Scenario, int, float | None]: ...
    def __getstate__(self, /) -> NDArray[float64]:
        """
        Where each of them is, a row for each as an `ActuatorState` is pickled.
        """
    def __len__(self, /) -> int:
        """
        How many there are.
        """
    def __new__(cls, /, scenario: Scenario, count: int, pulse_frequency: SupportsFloat | SupportsIndex | None = None) -> Actuators: ...
    def __repr__(self, /) -> str: ...
    def __setstate__(self, /, numbers: NDArray[float64]) -> None: ...
    def reset(self, /) -> None:
        """
        All of them go back to t = 0 and the scenario's state, with the coils released.
        """
    def respond(self, /, velocity: NDArray[float64], tension: NDArray[float64], *, per_length: NDArray[float64] | None = None, per_velocity: NDArray[float64] | None = None, absolute_pressure: NDArray[float64] | None = None) -> None:
        """
        Writes what the actuators answer where they are while their ends move apart at `velocity` in m/s, as `step` does: the
        tensions with which a loop begins.
        """
    def step(self, /, dt: SupportsFloat | SupportsIndex, length: NDArray[float64], velocity: NDArray[float64], duty: NDArray[float64] | None, tension: NDArray[float64], *, per_length: NDArray[float64] | None = None, per_velocity: NDArray[float64] | None = None, absolute_pressure: NDArray[float64] | None = None, max_step: SupportsFloat | SupportsIndex | None = None) -> None:
        """
        Goes on by `dt` in s while the ends of each actuator go in a straight line to a distance of `length` in m, under
        pulses of `duty` from 0 to 1; with `None` what was asked before goes on.

        `tension` in N is written, and where they are given `per_length` (its derivative at constant pressure, N/m),
        `per_velocity` (N*s/m) and `absolute_pressure` (Pa). `velocity` in m/s is that of the ends at the end of the step.
        `max_step` in s divides the step as that of an `Actuator`.

        Raises `InputError` for arrays and numbers that cannot be, before anything has changed, and `SimulationError` where an
        actuator leaves the physics: that one is then where it was and its entries are as they were, and the others have
        gone on. Ctrl-C ends a step of many parts; all actuators are then where they were.
        """

@final
class Differentiable:
    """
    Quantities of a run at given times as a function of parameters of its scenario, with the exact Jacobian.

    `parameters` are keys of numbers as the scenario file has them, such as "load.mass", "command.duty" or
    "actuator.effectiveness.value[2]"; `quantities` are "length" (m), "gauge_pressure" (Pa), "tension" (N), of a joint also
    "angle" (rad), "angular_velocity" (rad/s), "torque" (N*m), "antagonist_length", "antagonist_gauge_pressure",
    "antagonist_tension"; `times` are in s, within the run. Every event is located, and derivatives go through it.

    Called with values of the parameters in SI, it returns an array of shape (len(times), len(quantities)).

    Ctrl-C ends a call. Raises `InputError` for what is no number or quantity of the scenario, and for a scenario with a
    controller.
    """
    def __call__(self, /, values: ArrayLike) -> NDArray[float64]:
        """
        The quantities at the times, of shape (len(times), len(quantities)).
        """
    def __getnewargs__(self, /) -> tuple[Scenario, list[str], list[str], Incomplete]: ...
    def __new__(cls, /, scenario: Scenario, parameters: Sequence[str], quantities: Sequence[str], times: ArrayLike) -> Differentiable: ...
    def __repr__(self, /) -> str: ...
    @property
    def defaults(self, /) -> NDArray[float64]:
        """
        The scenario's own values of the parameters, in SI.
        """
    def for_jax(self, /) -> Callable[..., Any]:
        """
        This function for JAX, which differentiates it forwards and backwards: `jax.custom_jvp`.

        JAX must count in 64 bits: `jax.config.update("jax_enable_x64", True)`.
        """
    def for_torch(self, /) -> Callable[..., Any]:
        """
        This function of a tensor for PyTorch, which differentiates it forwards and backwards: by
        `torch.autograd.Function`, with the derivatives of `value_and_jacobian`.

        Tensors are of 64 bits and on the CPU: `dtype=torch.float64`.
        """
    @property
    def parameters(self, /) -> list[str]:
        """
        The parameters that it is a function of.
        """
    @property
    def quantities(self, /) -> list[str]:
        """
        The quantities.
        """
    @property
    def scenario(self, /) -> Scenario:
        """
        What is run.
        """
    @property
    def times(self, /) -> NDArray[float64]:
        """
        The times in s.
        """
    @property
    def units(self, /) -> dict[str, str]:
        """
        The units of the quantities by their names.
        """
    def value_and_jacobian(self, /, values: ArrayLike) -> tuple[NDArray[float64], NDArray[float64]]:
        """
        The quantities, and their Jacobian with respect to the parameters, of shape
        (len(times), len(quantities), len(parameters)).
        """

@final
class Event:
    """
    What happened at an instant of a run, and what holds from then on.
    """
    def __eq__(self, other: object, /) -> bool:
        """
        Whether both are the same.
        """
    def __getnewargs__(self, /) -> tuple[float, list[str], list[str]]: ...
    def __new__(cls, /, time: SupportsFloat | SupportsIndex, columns: Sequence[str], words: Sequence[str]) -> Event: ...
    def __repr__(self, /) -> str: ...
    @property
    def after(self, /) -> dict[str, str | float | bool]:
        """
        What holds from then on, by the names of the columns of `mckibben simulate --events-output`: words such as "slack",
        whether something is so as a `bool`, numbers as `float`.
        """
    @property
    def kind(self, /) -> str:
        """
        What happened: `valve`, `stick`, `slack` and so on.
        """
    @property
    def time(self, /) -> float:
        """
        When it happened, in s.
        """

@final
class LinearModel:
    """
    A linear model `dx/dt = A x + B u`, `y = C x + D u`, of differences from an operating point.

    `to_control` gives it to python-control.
    """
    @property
    def A(self, /) -> NDArray[float64]:
        """
        One row and one column for each state.
        """
    @property
    def B(self, /) -> NDArray[float64]:
        """
        One row for each state, one column for each input.
        """
    @property
    def C(self, /) -> NDArray[float64]:
        """
        One row for each output, one column for each state.
        """
    @property
    def D(self, /) -> NDArray[float64]:
        """
        One row for each output, one column for each input.
        """
    def __getnewargs__(self, /) -> tuple[Any, ...]: ...
    def __new__(cls, /, matrices: SupportsLenAndGetItem[Incomplete], signals: SupportsLenAndGetItem[Sequence[tuple[str, str]]], poles: Sequence[tuple[SupportsFloat | SupportsIndex, SupportsFloat | SupportsIndex]], point: Sequence[tuple[str, SupportsFloat | SupportsIndex]], warnings: Sequence[str], json: str) -> LinearModel: ...
    def __repr__(self, /) -> str: ...
    def bode(self, /, input: str | None = None, outputs: Sequence[str] | None = None, ax: Sequence[Axes] | None = None) -> Figure:
        """
        Magnitude and phase of outputs over one input, as a figure of Matplotlib, or into two axes.

        Without names: the first two outputs over the first input, which is the valve's where there is one.
        """
    def damp(self, /) -> Modes:
        """
        The poles as modes with natural frequency, damping ratio and time constant, the slowest first; `print` shows a table.
        """
    @property
    def details(self, /) -> dict[str, Any]:
        """
        What is known of the model beside its matrices, as `to_json` says it: `controllability`, how far pulses on average hold
        (`pwm`), whether the braid is taut, what is assumed.
        """
    @property
    def inputs(self, /) -> list[str]:
        """
        The names of the inputs.
        """
    @property
    def operating_point(self, /) -> dict[str, float]:
        """
        The values at the operating point, by names that have the unit at the end.
        """
    @property
    def outputs(self, /) -> list[str]:
        """
        The names of the outputs.
        """
    @property
    def poles(self, /) -> NDArray[complex128]:
        """
        The poles in 1/s.
        """
    def response(self, /, omega: ArrayLike) -> NDArray[complex128]:
        """
        The complex response of each output to each input at angular frequencies in rad/s: `[frequency, output, input]`.
        """
    @property
    def states(self, /) -> list[str]:
        """
        The names of the states.
        """
    def to_control(self, /) -> Any:
        """
        The model as a system of python-control, its signals with their names.
        """
    def to_json(self, /) -> str:
        """
        The model as `mckibben linearize --output model.json` writes it, with controllability and how far it holds.
        """
    @property
    def units(self, /) -> dict[str, str]:
        """
        The units of states, inputs and outputs by their names, in SI; empty for a pure number.
        """
    @property
    def warnings(self, /) -> list[str]:
        """
        What casts doubt on the model: a valve that does not answer to its duty there, a ripple that is too large, pulses that are
        too slow. `linearize` raises each as a `UserWarning` too.
        """

@final
class Response:
    """
    What an actuator answers to where its ends are, with its derivatives.
    """
    def __eq__(self, other: object, /) -> bool:
        """
        Whether both are the same.
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
        Its derivative by the length at constant pressure, in N/m.
        """
    @property
    def per_pressure(self, /) -> float:
        """
        Its derivative by the pressure, in m^2.
        """
    @property
    def per_velocity(self, /) -> float:
        """
        Its derivative by the velocity, in N*s/m.
        """
    @property
    def pressure_rate(self, /) -> float:
        """
        Rate of the pressure in Pa/s.
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
        Volume of the air in m^3, braid and hose.
        """

@final
class Scenario:
    """
    One experiment: what is built, what drives it, what is recorded; as a scenario file says it.

    A quantity is text with its unit, such as "60 psi"; in values from Python it may be a number in SI. What is wrong raises
    `InputError` with the message of the command line. A scenario does not change: `with_values` gives another one.

    `Scenario(text)` reads TOML from a string; `name` stands in messages where a file's name would, and `values` are pairs of
    a key's path and a value as TOML, put in place of the text's own. With `in_si` numbers without a unit are in SI.
    """
    def __eq__(self, other: object, /) -> bool:
        """
        Whether both mean the same.
        """
    def __getnewargs__(self, /) -> tuple[str, str, list[tuple[str, str]], bool]: ...
    def __new__(cls, /, text: str, name: str = "scenario.toml", values: Sequence[tuple[str, str]] = ..., in_si: bool = False) -> Scenario: ...
    def __repr__(self, /) -> str: ...
    @staticmethod
    def from_dict(values: Mapping[str, Any], name: str = "scenario.toml") -> Scenario:
        """
        A scenario from a dictionary of its sections, as `tomllib` reads them from a file:
        `{"load": {"kind": "hanging-mass", "mass": "5 lb"}, "run": {"duration": "1 s"}}`.

        A quantity is text with its unit, or a number in SI. Lists may be NumPy arrays, and numbers those of NumPy. Messages
        show the dictionary as TOML.

        Raises `InputError` for one that contains itself, or has more than 64 levels or 2 000 000 values.
        """
    @staticmethod
    def load(path: str | PathLike[str]) -> Scenario:
        """
        Reads a scenario file.

        Raises `InputError` for a file that cannot be read, is not TOML, or says what cannot be.
        """
    @property
    def name(self, /) -> str:
        """
        The name of the file, or what stands in messages in its place.
        """
    @property
    def text(self, /) -> str:
        """
        The text as it was read, without what `with_values` set.
        """
    def to_dict(self, /) -> dict[str, Any]:
        """
        The same as a dictionary of its sections, which `from_dict` takes.
        """
    def to_toml(self, /) -> str:
        """
        The scenario as it was understood, as TOML: every value in SI, no preset, no default. Of many actuators with names: every
        key that was given, with its value as it was written.
        """
    def with_values(self, /, values: Mapping[str, Any]) -> Scenario:
        """
        This scenario with other values, each by the path of its key: `{"load.mass": "10 lb", "command.duty": 0.3}`. A number
        where a quantity is due is in SI.
        """

@final
class Sweep:
    """
    The runs of a scenario's section `[sweep]`, in parts that can be computed anywhere: what `mckibben sweep` does, to the last
    bit.

    `mckibben.sweep` does all of them. `chosen` is the step of the fixed-step engine that was chosen for all rows; it is chosen
    where it is not given.

    Raises `InputError` for a scenario without a sweep, and for one that cannot be.
    """
    def __getnewargs__(self, /) -> tuple[Scenario, tuple[float, float, list[int], list[int]] | None]: ...
    def __new__(cls, /, scenario: Scenario, chosen: tuple[SupportsFloat | SupportsIndex, SupportsFloat | SupportsIndex, Sequence[SupportsIndex], Sequence[SupportsIndex]] | None = None) -> Sweep: ...
    def __repr__(self, /) -> str: ...
    @property
    def columns(self, /) -> list[str]:
        """
        The names of the table's columns in their order.
        """
    def missing(self, /, folder: str | PathLike[str]) -> tuple[list[int], int]:
        """
        Makes the sweep's folder, or takes up one that holds the same sweep: the numbers of the parts that are not finished in
        it, and how many runs failed in those that are.
        """
    def part(self, /, part: SupportsIndex) -> bytes:
        """
        Computes a part on one thread, while other threads of Python go on: the bytes of its Parquet file.
        """
    @property
    def parts(self, /) -> int:
        """
        How many parts they make, each a Parquet file.
        """
    def put(self, /, folder: str | PathLike[str], part: SupportsIndex, bytes: bytes) -> None:
        """
        Puts the bytes of a part into the folder: it is there whole or not at all.
        """
    @property
    def rows(self, /) -> int:
        """
        How many runs there are.
        """
    def run(self, /, folder: str | PathLike[str], jobs: SupportsIndex | None = None, progress: Any | None = None) -> None:
        """
        Computes what is missing in the folder on `jobs` threads, one for each core unless given, and calls `progress` now and
        then with the parts that are done and all there are.

        Ctrl-C, and an exception of `progress`, stop it once the parts under way are finished; what is in the folder then is
        kept.
        """
    @property
    def scenario(self, /) -> Scenario:
        """
        What is swept.
        """
    @property
    def step(self, /) -> float | None:
        """
        The longest step of the fixed-step engine in s that was chosen for all runs; `None` where they have their own.
        """
    @property
    def units(self, /) -> dict[str, str]:
        """
        The units of the columns of numbers by their names, in SI.
        """

@final
class Trajectory:
    """
    A finished run: its columns as NumPy arrays, its events, and what it was between the samples.

    There is a row at t = 0, at every `run.sample_interval` and at the end. `trajectory["absolute_pressure_pa"]` is a column by its
    name in the files of `mckibben simulate`; those that every run has are attributes too. The columns of a joint begin with
    its agonist's; those of its antagonist are called `antagonist_length_m` and so on. Of many
    actuators with names every column carries one: `flexor.absolute_pressure_pa`, `elbow.angle_rad`, `tank.absolute_pressure_pa`.

    Arrays cannot be written to: copy one to change it.
    """
    def __contains__(self, name: Any, /) -> bool:
        """
        Whether there is a column of this name.
        """
    def __getitem__(self, name: str, /) -> NDArray[Any]:
        """
        A column by its name, such as "length_m" or "hose_absolute_pressure_pa".
        """
    def __getnewargs__(self, /) -> tuple[Any, ...]: ...
    def __iter__(self, /) -> Iterator[str]:
        """
        The names of the columns in their order.
        """
    def __len__(self, /) -> int:
        """
        How many rows there are.
        """
    def __new__(cls, /, scenario: Scenario, columns: Sequence[tuple[str, str, Any]], events: Sequence[Event]) -> Trajectory:
        """
        A run as it was pickled; what only the engine knows is simulated anew when it is asked for.
        """
    def __repr__(self, /) -> str: ...
    def _figures(self, /) -> tuple[list[tuple[str, float, str]], list[tuple[str, int]], list[tuple[str, str]]]:
        """
        Numbers with their names and units, counts of events, and assumed values.
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
        Rates of a joint's angle in rad/s.
        """
    def at(self, /, time: SupportsFloat | SupportsIndex) -> dict[str, float | str]:
        """
        Every column at `time` in s, by the polynomials of the steps: by the event-located engine exact between the samples too.

        Raises `InputError` for a time outside the run, and for a run at fixed steps.
        """
    def at_times(self, /, times: ArrayLike) -> dict[str, NDArray[Any]]:
        """
        Every column at each of `times` in s, as arrays by the names of the columns; as `at`.
        """
    @property
    def columns(self, /) -> list[str]:
        """
        The names of the columns in their order, each of numbers with its unit at the end.
        """
    @property
    def events(self, /) -> list[Event]:
        """
        What happened, in order of time.
        """
    def events_to_pandas(self, /) -> DataFrame:
        """
        The log of events as a data frame of pandas: `time_s`, `event`, and what holds from then on.
        """
    @property
    def gauge_pressure(self, /) -> NDArray[float64]:
        """
        Gauge pressures of the actuator's air in Pa.
        """
    def keys(self, /) -> list[str]:
        """
        The names of the columns, as of a data frame: `dict(run)` has the columns by their names.
        """
    @property
    def length(self, /) -> NDArray[float64]:
        """
        Distances between the attachments in m; of a joint, its agonist's.
        """
    @property
    def mass_flow(self, /) -> NDArray[float64]:
        """
        Net mass flows into the actuator in kg/s.
        """
    def plot(self, /, columns: Sequence[str] | None = None, ax: Sequence[Axes] | None = None) -> Figure:
        """
        Columns over time as a figure of Matplotlib, a panel for each, or into as many axes.

        Without `columns`: length, pressure and tension; of a joint or a plant its angles too, a line for each actuator.
        """
    @property
    def scenario(self, /) -> Scenario:
        """
        What was run.
        """
    def summary(self, /) -> Summary:
        """
        What the run came to: extremes, ripple, air used, energy and exergy, the step that was chosen and its error, events, assumed
        values.
        """
    @property
    def t(self, /) -> NDArray[float64]:
        """
        Times in s.
        """
    @property
    def temperature(self, /) -> NDArray[float64]:
        """
        Temperatures of the actuator's air in K.
        """
    @property
    def tension(self, /) -> NDArray[float64]:
        """
        Tensions in N, zero or above: an actuator only pulls.
        """
    def to_csv(self, /, path: str | PathLike[str]) -> None:
        """
        Writes the columns as CSV: the file of `mckibben simulate --output`, byte by byte.
        """
    def to_dict(self, /) -> dict[str, NDArray[Any]]:
        """
        The columns as arrays by their names, in their order.
        """
    def to_pandas(self, /) -> DataFrame:
        """
        The columns as a data frame of pandas.
        """
    def to_parquet(self, /, path: str | PathLike[str]) -> None:
        """
        Writes the columns as Parquet: the file of `mckibben simulate --output`, byte by byte.
        """
    def to_polars(self, /) -> DataFrame2:
        """
        The columns as a data frame of Polars.
        """
    def to_svg(self, /, over: str = "time") -> str:
        """
        The figure of `mckibben simulate --plot` as SVG; over "time", or tension over "length".
        """
    @property
    def torque(self, /) -> NDArray[float64]:
        """
        Torques of both actuators on a joint in N*m.
        """
    @property
    def units(self, /) -> dict[str, str]:
        """
        The units of the columns of numbers by their names, in SI.
        """
    @property
    def valve(self, /) -> NDArray[str_]:
        """
        Which passage of the valve is open: "supply", "exhaust", "both" or "closed".
        """
    @property
    def velocity(self, /) -> NDArray[float64]:
        """
        Rates of the length in m/s, above zero while lengthening.
        """
    @property
    def volume(self, /) -> NDArray[float64]:
        """
        Volumes of the actuator's air in m^3, braid and hose.
        """

@final
class VectorPlant:
    """
    Many copies of a scenario's plant, stepped together on all cores. Your code commands their valves; each plant may be
    reset, with parameters of its own, while the others go on. The environments of `mckibben.learning` are made of it.

    `scenario` is of any plant: one actuator with its load, an antagonistic joint, or actuators with names on their mechanisms.
    Its controllers do not count, nor the commands of the actuators' valves; supplies follow theirs.

    `parameters` are paths of the numbers that differ from one to the next: "load.mass", "initial.gauge_pressure"; where actuators have
    names also "actuators.biceps.friction.viscous" and "mechanism.joints.elbow.damping".

    `action_mode` says what the actions given to `step` are: "duty" (0 to 1), "request" (1 fill, 0 hold, -1 exhaust), "position" of
    a proportional spool (-1 to 1), "set-point" of a pressure regulator (Pa, gauge). `pulse_frequency` in Hz is how often a
    duty cycle's pulses come; that of the scenario's PWM unless given.

    They go at fixed steps by the scenario's run.method, each no longer than its run.step, or than what its run.accuracy
    needs.

    A copy, or what comes out of a pickle, is made anew: of the same scenario and for the same purpose, at t = 0.
    """
    def __getnewargs_ex__(self, /) -> tuple[tuple[Scenario, int], dict[str, Any]]: ...
    def __len__(self, /) -> int: ...
    def __new__(cls, /, scenario: Scenario, count: int, *, parameters: Sequence[str] = ..., action_mode: str = "duty", pulse_frequency: SupportsFloat | SupportsIndex | None = None) -> VectorPlant: ...
    def __repr__(self, /) -> str: ...
    @property
    def columns(self, /) -> list[str]:
        """
        What is observed of each, by the names of the columns of a run.
        """
    @staticmethod
    def columns_of(scenario: Scenario) -> list[str]:
        """
        What `columns` of plants of a scenario are, whatever the commands of its valves.
        """
    @property
    def defaults(self, /) -> NDArray[float64]:
        """
        The scenario's own values of `parameters`, in SI.
        """
    def differ(self, /, one: ArrayLike, other: ArrayLike) -> bool:
        """
        Whether plants with these two sets of values of the numbers `parameters`, in SI, would differ. Commands of valves do not count.

        Raises `InputError` for values that cannot be.
        """
    @property
    def duration(self, /) -> float:
        """
        How long the scenario runs, in s.
        """
    def observe(self, /, rows: NDArray[int64], observations: NDArray[float64]) -> None:
        """
        Writes the observations of the plants of these numbers into rows of `observations`, of shape (count, len(columns)).
        """
    @property
    def parameters(self, /) -> list[str]:
        """
        Paths of the numbers that differ from one to the next.
        """
    @property
    def pulses(self, /) -> float | None:
        """
        How often pulses come, in Hz, where `action_mode` is "duty".
        """
    @property
    def requests(self, /) -> list[float]:
        """
        The requests that the valves can do: of 1 (fill), 0 (hold) and -1 (exhaust).
        """
    def restart(self, /, rows: NDArray[int64], values: NDArray[float64] | None = None) -> None:
        """
        The plants of these numbers are reset, with these values, of shape (len(rows), len(parameters)), and no command to their
        valves; those of the scenario unless given. The others go on.
        """
    @property
    def scenario(self, /) -> Scenario:
        """
        What it was made of.
        """
    def start(self, /, values: NDArray[float64] | None = None) -> None:
        """
        All begin at t = 0, with no command to their valves, each with its values of the numbers `parameters` in SI, of shape
        (count, len(parameters)); those of the scenario unless given.

        Raises `InputError` for values that cannot be. Then nothing has changed.
        """
    def step(self, /, dt: SupportsFloat | SupportsIndex, actions: NDArray[float64], observations: NDArray[float64], stopped: NDArray[bool_]) -> None:
        """
        Asks `action_mode`, of shape (count, valves), of the valves, goes on by `dt` in s, and writes what the plants show into
        `observations`, of shape (count, len(columns)), and into `stopped` which of them have produced a non-physical state: their entries stay
        as they are, and only `restart` brings them back.

        Raises `InputError` for actions that cannot be, and for more than 10 000 000 steps or edges of pulses, before anything
        has changed. Ctrl-C ends a step of many parts between two of them.
        """
    @property
    def time(self, /) -> NDArray[float64]:
        """
        The time in s of each plant on the clock that its pulses follow: period p begins at p / `pulses`. All share one clock,
        which begins with `start`.
        """
    @property
    def valve_delay(self, /) -> float:
        """
        The longest time in s for which a command shows no effect at the scenario's valves: the delays of their coils, or the
        dead time of a pressure regulator, and what a hose adds.
        """
    @property
    def valves(self, /) -> int:
        """
        How many valves each has.
        """

def _identify(sections: Mapping[str, Any], tables: Sequence[tuple[str, Sequence[tuple[str, ArrayLike]]]], scenario: Scenario, output: str | PathLike[str] | None, progress: Any | None) -> dict[str, Any]:
    """
    Estimates parameters from a study in memory: its sections as in a file, and its tables by the names that runs give them.
    """

def _identify_file(study: str | PathLike[str], output: str | PathLike[str] | None, progress: Any | None) -> dict[str, Any]:
    """
    Estimates parameters from the study of a file.
    """

def curves(scenario: Scenario, gauge_pressures: ArrayLike | str | None = None) -> dict[str, NDArray[float64]]:
    """
    Force, stiffness and volume of a scenario's actuator over length, at rest: the table of `mckibben curves`.

    `gauge_pressures` are numbers in Pa, or text such as "35, 45, 55 psi"; those of the paper's Fig. 3 unless given. Each array
    has a row for each pressure and a column for each length, from the shortest to the longest; its name has its unit at
    the end. `stiffness_n_m` is (7), at constant pressure; `sealed_stiffness_n_m` is (5), with the valve shut.
    """

def linearize(scenario: Scenario, *, gauge_pressure: float | str | None = None, length: float | str | None = None, load: float | str | None = None, duty: SupportsFloat | SupportsIndex | None = None, pwm: bool = False, temperature: float | str | None = None, angle: float | str | None = None, stiffness: float | str | None = None, amplitude: float | str | None = None, all_states: bool = False) -> LinearModel:
    """
    A scenario near an operating point, by exact derivatives: what `mckibben linearize` does.

    Two of `gauge_pressure`, `length` and `load` give the third; what is not given is that of the scenario. `duty` gives the
    pressure by the valve's mean flow under PWM, and with `pwm` the duty follows from the pressure; else the valve is held
    shut, and the mass flow into the actuator is the input. Of a joint `angle` and `stiffness` give the pressures. With
    `amplitude` Coulomb friction is replaced by the viscous damping that takes as much. Quantities are numbers in SI or text with
    units, such as "60 psi"; `load` is a force, as text also a mass.

    Raises `InputError` where there is no such point.
    """

def parameters() -> dict[str, Any]:
    """
    The quantities of a scenario by their keys, in the order of the file: what `mckibben schema` says of them.

    Of each `meaning`, `symbol` (the paper's, or the usual one), `unit` (SI; empty for a pure number), `range` in words,
    `minimum` and `maximum` (`None` where there is no end) with `minimum_included` and `maximum_included`, `default` in that
    unit (`None` where it must be given or follows from other keys), the `source` of definition and default, the `remedy` where
    a value is refused, and an `example` as a file has it. A preset may stand in for a default.

    Those of an antagonist have `antagonist.` before them. In the keys of a file of many actuators `*` stands for a name: what
    `actuators.flexor.valve.efficiency` takes is said by `valve.efficiency`, and what `supplies.tank.inlet.drop` takes by
    `supplies.*.inlet.drop`.
    """

def presets() -> dict[str, Any]:
    """
    The named actuators and valves, by their names: what `mckibben presets` shows.

    Of each `section`, in whose `preset` a scenario names it, `meaning`, and `values`: for each key its `value` in `unit`
    (SI), the `text` as the source writes it, the `source`, and whether it is `assumed`.
    """

def simulate(scenario: Scenario, *, progress: Any | None = None) -> Trajectory:
    """
    Runs a scenario, of whatever kind: what `mckibben simulate` does, to the last bit.

    Other threads of Python go on meanwhile, and Ctrl-C ends it. Raises `InputError` where the model finds a contradiction, and
    `SimulationError` where the simulation cannot go on.
    """
