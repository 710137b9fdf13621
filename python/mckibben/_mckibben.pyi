"""
What is compiled of the package `mckibben`.
"""

from _typeshed import SupportsGetItem
from collections.abc import Mapping
from matplotlib.figure import Figure
from numpy import float64, str_
from numpy.typing import NDArray
from os import PathLike
from pandas import DataFrame
from polars import DataFrame as DataFrame2
from typing import Any, SupportsFloat, SupportsIndex, final

__all__ = ["Event", "Scenario", "Trajectory", "restored", "simulate"]

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
    def __new__(cls, /, time: SupportsFloat | SupportsIndex, columns: SupportsGetItem[int, str], words: SupportsGetItem[int, str]) -> Event: ...
    def __repr__(self, /) -> str: ...
    @property
    def after(self, /) -> dict[str, str]:
        """
        What holds from then on, by the names of the columns of `mckibben simulate --events-output`.
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
class Scenario:
    """
    One experiment: what is built, what drives it, what is recorded; as a scenario file says it.

    Every quantity with a dimension is text with its unit, such as "60 psi"; what is wrong raises `InputError` with the
    message of the command line. A scenario does not change: `with_values` gives another one.

    `Scenario(text)` reads TOML from a string; `name` stands in messages where a file's name would, and `values` are pairs of
    a key's path and a value as TOML, put in place of the text's own.
    """
    def __eq__(self, other: object, /) -> bool:
        """
        Whether both mean the same.
        """
    def __getnewargs__(self, /) -> tuple[str, str, list[tuple[str, str]]]: ...
    def __new__(cls, /, text: str, name: str = "scenario.toml", values: SupportsGetItem[int, tuple[str, str]] = ...) -> Scenario: ...
    def __repr__(self, /) -> str: ...
    @staticmethod
    def from_dict(values: Mapping[str, Any], name: str = "scenario.toml") -> Scenario:
        """
        A scenario from a dictionary of its sections, as `tomllib` reads them from a file:
        `{"load": {"kind": "hanging-mass", "mass": "5 lb"}, "run": {"duration": "1 s"}}`.

        Lists may be NumPy arrays, and numbers those of NumPy. Messages show the dictionary as TOML.
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
        The scenario as it was understood, as TOML: every value in SI, no preset, no default.
        """
    def with_values(self, /, values: Mapping[str, Any]) -> Scenario:
        """
        The same scenario with other values, each by the path of its key: `{"load.mass": "10 lb", "command.duty": 0.3}`.
        """

@final
class Trajectory:
    """
    A finished run: its columns as NumPy arrays, its events, and what it was between the samples.

    There is a row at t = 0, at every `run.sample_interval` and at the end. `trajectory["pressure_pa"]` is a column by its
    name in the files of `mckibben simulate`; those that every run has are attributes too. The columns of a joint begin with
    its agonist's; those of its antagonist are called `antagonist_length_m` and so on.

    Arrays cannot be written to: copy one to change it.
    """
    def __getitem__(self, name: str, /) -> NDArray[Any]:
        """
        A column by its name, such as "length_m" or "hose_pressure_pa".
        """
    def __len__(self, /) -> int:
        """
        How many rows there are.
        """
    def __reduce__(self, /) -> tuple[Any, ...]: ...
    def __repr__(self, /) -> str: ...
    def _repr_svg_(self, /) -> str: ...
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
        Every column at `time` in s, by the polynomials of the event-located engine: exact between the samples too.

        Raises `InputError` for a time outside the run, and for a run at fixed steps.
        """
    def at_times(self, /, times: SupportsGetItem[int, SupportsFloat | SupportsIndex]) -> dict[str, NDArray[Any]]:
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
        What happened, in order of time; none at fixed steps, whose engine keeps no log.
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
    def plot(self, /) -> Figure:
        """
        Length, pressure and tension over time as a figure of Matplotlib; angle, pressures and tensions of a joint.
        """
    @property
    def pressure(self, /) -> NDArray[float64]:
        """
        Absolute pressures of the actuator's air in Pa.
        """
    @property
    def scenario(self, /) -> Scenario:
        """
        What was run.
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

def restored(scenario: Scenario, columns: SupportsGetItem[int, tuple[str, str, Any]], events: SupportsGetItem[int, Event] | None) -> Trajectory:
    """
    A run as it was pickled; what only the engine knows is simulated anew when it is asked for.
    """

def simulate(scenario: Scenario) -> Trajectory:
    """
    Runs a scenario, of whatever kind: what `mckibben simulate` does, to the last bit.

    Other threads of Python go on meanwhile. Raises `InputError` where the model finds a contradiction, and `StoppedError`
    where the simulation cannot go on.
    """
