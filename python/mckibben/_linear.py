"""Linear models in python-control and as Bode plots. The packages are imported on use."""

from __future__ import annotations

import collections.abc
import itertools
import math
import re
import typing

import numpy

from mckibben._axes import axes_for
from mckibben.errors import InputError

if typing.TYPE_CHECKING:
    import matplotlib.axes
    import matplotlib.figure

    from mckibben import LinearModel

#: Points of a Bode plot in each decade, and decades beyond the slowest and the fastest pole.
_POINTS = 100
_BEYOND = 1.0


def identifiers(names: collections.abc.Sequence[str]) -> list[str]:
    """Return names without characters that python-control and MATLAB refuse, such as `biceps_duty` for `biceps.duty`; unequal names
    stay unequal."""
    made: list[str] = []
    for name in names:
        plain = re.sub("[^0-9A-Za-z_]", "_", name)
        known = {*made, *(other for other in names if other != name)}
        counts = (plain if count == 1 else f"{plain}_{count}" for count in itertools.count(1))
        made.append(next(one for one in counts if one not in known))
    return made


def to_control(model: LinearModel) -> typing.Any:
    """Return the model as `control.ss` without delays, with the names of its signals; each point in them is an underscore."""
    import control

    names = {"states": model.states, "inputs": model.inputs, "outputs": model.outputs}
    return control.ss(model.A, model.B, model.C, model.D, **{part: identifiers(of) for part, of in names.items()})


def delay(model: LinearModel) -> dict[str, float]:
    """Return the delay in s of each input by its name, which the matrices leave out."""
    return {of["name"]: of["delay_s"] for of in model.details["inputs"]}


def response(model: LinearModel, omega: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.complex128]:
    """Return the complex response at angular frequencies in rad/s, of shape (len(omega), outputs, inputs)."""
    rates = numpy.atleast_1d(numpy.asarray(omega, dtype=float))
    for rate in rates[~numpy.isfinite(rates)].tolist():
        raise InputError(f"`omega` has {rate}, which is no finite angular frequency in rad/s; give finite ones")
    identity = numpy.eye(len(model.A))

    def at(rate: float) -> typing.Any:
        try:
            return model.C @ numpy.linalg.solve(1j * rate * identity - model.A, model.B) + model.D
        except numpy.linalg.LinAlgError:
            raise InputError(
                f"the model has a pole at {'zero' if rate == 0.0 else f'{rate} rad/s'}, where its response is without bound; "
                f"leave {rate} rad/s out of `omega`"
            ) from None

    answers = [at(rate) for rate in rates]
    return numpy.array(answers, dtype=complex).reshape(len(rates), len(model.outputs), len(model.inputs))


def unit_over(unit: str, other: str) -> str:
    """Return the unit of a gain: that of an output over that of an input, of which a pure number has none."""
    if not other:
        return unit or "1"
    return f"{unit or '1'}/({other})" if "/" in other or "*" in other else f"{unit or '1'}/{other}"


def bode(
    model: LinearModel,
    input: str | None = None,
    outputs: collections.abc.Sequence[str] | None = None,
    ax: collections.abc.Sequence[matplotlib.axes.Axes] | None = None,
) -> matplotlib.figure.Figure:
    """Draw magnitude and phase of outputs over one input, in a new figure or into two axes."""
    def place(name: str, names: list[str], what: str) -> int:
        if name not in names:
            raise InputError(f"the model has no {what} `{name}`; it has {', '.join(names)}")
        return names.index(name)

    name = model.inputs[0] if input is None else input
    column = place(name, model.inputs, "input")
    chosen = model.outputs[:2] if outputs is None else list(outputs)
    rows = [place(output, model.outputs, "output") for output in chosen]
    sizes = [abs(pole) for pole in model.poles if abs(pole) > 0] or [1.0]
    ends = math.log10(min(sizes)) - _BEYOND, math.log10(max(sizes)) + _BEYOND
    omega = numpy.logspace(*ends, int(_POINTS * (ends[1] - ends[0])))
    answers = response(model, omega)
    axes, figure = axes_for(ax, 2, "; give two, for magnitude and phase")
    for row, output in zip(rows, chosen):
        answer = answers[:, row, column]
        label = f"{output} ({unit_over(model.units[output], model.units[name])})"
        axes[0].loglog(omega / math.tau, numpy.abs(answer), label=label)
        axes[1].semilogx(omega / math.tau, numpy.degrees(numpy.unwrap(numpy.angle(answer))), label=output)
    axes[0].set_ylabel(f"magnitude over {name}")
    axes[0].legend()
    axes[1].set_ylabel("phase (deg)")
    axes[1].set_xlabel("frequency (Hz)")
    return figure
