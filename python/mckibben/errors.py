"""What can go wrong; the messages are those of the command line, with place and remedy."""


class Error(Exception):
    """What every exception of this package is."""


class InputError(Error, ValueError):
    """A scenario or an argument is wrong: nothing was done."""


class SimulationError(Error, RuntimeError):
    """The simulation could not go on."""


class OutputError(Error, OSError):
    """A file could not be written: nothing was left behind but what the message names."""
