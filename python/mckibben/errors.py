"""Exceptions of the package. Messages are those of the command line, with place and remedy."""


class Error(Exception):
    """Base class of the exceptions of this package.

    Examples
    --------
    >>> import mckibben
    >>> try:
    ...     mckibben.Scenario("[load")
    ... except mckibben.Error as error:
    ...     type(error).__name__
    'InputError'
    """


class InputError(Error, ValueError):
    """A scenario or an argument is not valid, and nothing was done; also a `ValueError`.

    The message names the place, the range and the remedy. The command line reports it with exit code 2.

    Examples
    --------
    >>> import mckibben
    >>> try:
    ...     mckibben.Scenario.from_file("absent.toml")
    ... except ValueError as error:
    ...     type(error).__name__
    'InputError'
    """


class SimulationError(Error, RuntimeError):
    """The simulation cannot continue, as where a step leads to a non-physical state; also a `RuntimeError`.

    The command line reports it with exit code 3.

    Examples
    --------
    >>> import mckibben
    >>> muscle = mckibben.Actuator(mckibben.Scenario.from_dict({
    ...     "load": {"kind": "isometric"},
    ...     "initial": {"length": "85 mm", "gauge_pressure": "40 psi"},
    ...     "run": {"duration": "1 s"},
    ... }))
    >>> try:
    ...     muscle.step(muscle.start(), 10.0, 0.0, None, 1e-3)
    ... except mckibben.SimulationError:
    ...     "the muscle cannot be stretched to 10 m"
    'the muscle cannot be stretched to 10 m'
    """


class OutputError(Error, OSError):
    """A file cannot be written; also an `OSError`.

    Nothing is left behind but what the message names. The command line reports it with exit code 4.

    Examples
    --------
    >>> import mckibben
    >>> run = mckibben.simulate(mckibben.Scenario.from_dict({
    ...     "load": {"kind": "hanging-mass", "mass": "5 lb"},
    ...     "initial": {"gauge_pressure": "60 psi", "length": "85 mm"},
    ...     "run": {"duration": "10 ms"},
    ... }))
    >>> try:
    ...     run.to_csv("/there is no such folder/run.csv")
    ... except OSError as error:
    ...     type(error).__name__
    'OutputError'
    """
