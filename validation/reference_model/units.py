"""Quantities with units, for the units that the reference scenarios use, with exact constants.

Grammar: ``number unit``, where a unit is a product of names with integer powers, e.g. ``psi``,
``lbf*s/in``, ``J/(kg*K)``, ``dm^3/(s*bar)``. Everything becomes SI.
"""

import math
import re

POUND = 0.45359237  # kg, exact (1959)
STANDARD_GRAVITY = 9.80665  # m/s², exact
INCH = 0.0254  # m, exact
POUND_FORCE = POUND * STANDARD_GRAVITY  # N

# Symbol -> (factor to SI, dimension as powers of kg, m, s, K).
UNITS = {
    "kg": (1.0, (1, 0, 0, 0)),
    "g": (1e-3, (1, 0, 0, 0)),
    "lb": (POUND, (1, 0, 0, 0)),
    "m": (1.0, (0, 1, 0, 0)),
    "dm": (0.1, (0, 1, 0, 0)),
    "cm": (1e-2, (0, 1, 0, 0)),
    "mm": (1e-3, (0, 1, 0, 0)),
    "in": (INCH, (0, 1, 0, 0)),
    "ft": (12 * INCH, (0, 1, 0, 0)),
    "um": (1e-6, (0, 1, 0, 0)),
    "mL": (1e-6, (0, 3, 0, 0)),
    "L": (1e-3, (0, 3, 0, 0)),
    "s": (1.0, (0, 0, 1, 0)),
    "ms": (1e-3, (0, 0, 1, 0)),
    "min": (60.0, (0, 0, 1, 0)),
    "h": (3600.0, (0, 0, 1, 0)),
    "Hz": (1.0, (0, 0, -1, 0)),
    "K": (1.0, (0, 0, 0, 1)),
    "mg": (1e-6, (1, 0, 0, 0)),
    "N": (1.0, (1, 1, -2, 0)),
    "lbf": (POUND_FORCE, (1, 1, -2, 0)),
    "Pa": (1.0, (1, -1, -2, 0)),
    "kN": (1e3, (1, 1, -2, 0)),
    "kPa": (1e3, (1, -1, -2, 0)),
    "bar": (1e5, (1, -1, -2, 0)),
    "psi": (POUND_FORCE / INCH**2, (1, -1, -2, 0)),
    "J": (1.0, (1, 2, -2, 0)),
    "rad": (1.0, (0, 0, 0, 0)),
    "deg": (math.pi / 180, (0, 0, 0, 0)),
    "W": (1.0, (1, 2, -3, 0)),
}

TOKEN = re.compile(r"\s*([A-Za-z]+|\^-?\d+|[*/()])")


def unit_factor(text):
    """The factor to SI and the dimension of a unit expression."""
    tokens = TOKEN.findall(text)
    if "".join(tokens) != text.replace(" ", ""):
        raise ValueError(f"cannot read the unit {text!r}")
    position = 0

    def peek():
        return tokens[position] if position < len(tokens) else ""

    def take():
        nonlocal position
        position += 1
        return tokens[position - 1]

    def primary():
        if peek() == "(":
            take()
            factor, dimension = product()
            if take() != ")":
                raise ValueError(f"unbalanced parenthesis in {text!r}")
        else:
            factor, dimension = UNITS[take()]
        if peek().startswith("^"):
            power = int(take()[1:])
            factor, dimension = factor**power, tuple(power * d for d in dimension)
        return factor, dimension

    def product():
        factor, dimension = primary()
        while peek() in ("*", "/"):
            sign = 1 if take() == "*" else -1
            other, powers = primary()
            factor = factor * other if sign == 1 else factor / other
            dimension = tuple(d + sign * p for d, p in zip(dimension, powers, strict=True))
        return factor, dimension

    result = product()
    if position != len(tokens):
        raise ValueError(f"cannot read the unit {text!r}")
    return result


def quantity(text, unit):
    """The SI value of ``text``, which must have the dimension of ``unit``."""
    if not isinstance(text, str):
        raise ValueError(f"{text!r} needs a unit such as {unit!r}")
    number, _, symbol = text.strip().partition(" ")
    factor, dimension = unit_factor(symbol)
    if dimension != unit_factor(unit)[1]:
        raise ValueError(f"{text!r} has not the dimension of {unit!r}")
    return float(number) * factor
