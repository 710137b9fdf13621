"""Canvas on which lengths are in m, and muscles on it, for pictures of plants.

The width of a braid follows from its length L, its thread length b and its turns n: √(b² - L²)/(n π). The widths of muscles,
and the moment arms of joints, are drawn `ACROSS` times as large as they are.
"""

import functools
import itertools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

from mckibben.learning._plant import Plant

Array = NDArray[np.float64]
Values = Mapping[str, float]

ACROSS = 1.8
FINE = 2  # drawn so many times as large as a frame, and then averaged
ATMOSPHERE = 101325.0

INK, BONE, GREY, GROUND, PAPER = "#32373d", "#c3c9cf", "#6b7178", "#8d949b", "#ffffff"
GHOST, TARGET = "#a9dbc0", "#157347"
# Colours of the gauge pressure from zero to that of the supply.
SCALE = np.array([[222, 230, 238], [245, 200, 90], [222, 88, 40], [130, 16, 38]], dtype=float)


def shade(share: float) -> tuple[int, int, int]:
    """Return the colour of a pressure, which is a share of the scale."""
    places = np.linspace(0.0, 1.0, len(SCALE))
    red, green, blue = (int(np.interp(share, places, channel)) for channel in SCALE.T)
    return red, green, blue


@functools.cache
def font(height: int) -> Any:
    """Return the font of Pillow with a height in pixels."""
    return ImageFont.load_default(height)


class Canvas:
    """Image on which lengths are in m; the second coordinate grows downwards."""

    def __init__(self, image: Image.Image, scale: float, origin: Array) -> None:
        self.draw, self.scale, self.origin = ImageDraw.Draw(image), scale, origin

    def pixels(self, points: Any) -> list[float]:
        """Return points in m as a list of pixels."""
        flat: list[float] = (np.asarray(points, dtype=float) * self.scale + self.origin).ravel().tolist()
        return flat

    def line(self, points: Any, colour: Any, width: float) -> None:
        """Draw a line with a width in pixels of a frame."""
        self.draw.line(self.pixels(points), fill=colour, width=max(1, round(width * FINE)), joint="curve")

    def polygon(self, points: Any, fill: Any, outline: Any = None, width: float = 1.0) -> None:
        self.draw.polygon(self.pixels(points), fill=fill, outline=outline, width=round(width * FINE))

    def disc(self, centre: Any, radius: float, fill: Any, outline: Any = INK, width: float = 1.2) -> None:
        """Draw a disc with a radius in m."""
        x, y = self.pixels(centre)
        r = radius * self.scale
        self.draw.ellipse((x - r, y - r, x + r, y + r), fill=fill, outline=outline, width=round(width * FINE))

    def dot(self, centre: Any, radius: float, fill: Any, outline: Any = INK, width: float = 1.2) -> None:
        """Draw a disc with a radius in pixels of a frame."""
        self.disc(centre, radius * FINE / self.scale, fill, outline, width)

    def text(self, centre: Any, text: str) -> None:
        """Draw a text centred at a point."""
        x, y = self.pixels(centre)
        self.draw.text((x, y), text, INK, font(12 * FINE), anchor="mm")

    def ground(self, one: Any, other: Any, up: float = -1.0) -> None:
        """Draw a fixed surface from one point to another, hatched on the upper or lower side."""
        one, other = np.asarray(one, dtype=float), np.asarray(other, dtype=float)
        step = 7.0 * FINE / self.scale
        count = max(2, int(np.linalg.norm(other - one) / step))
        for share in np.linspace(0.0, 1.0, count, endpoint=False):
            foot = one + share * (other - one)
            self.line([foot, foot + step * np.array([0.9, up])], GROUND, 1.0)
        self.line([one, other], INK, 2.0)


class Muscle:
    """Braid of an actuator, with the columns of its pressure and, where there is one, of its length."""

    def __init__(self, plant: Plant, name: str, columns: Sequence[str], prefix: str = "", keys: str = "actuator") -> None:
        def number(key: str, other: float) -> float:
            return plant.number(f"{keys}.{key}") or plant.number(f"actuator.{key}") or other

        self.pressure, length = f"{prefix}absolute_pressure_pa", f"{prefix}length_m"
        self.length = length if length in columns else None
        self.full = plant.supply_pressure(name) or 6e5
        self.longest = number("max_length", 0.1)
        self.thread, self.turns = number("thread_length", 1.1 * self.longest), number("turns", 2.5)
        self.shortest = number("min_length", self.thread / np.sqrt(3.0))
        self.widest = self.width(self.shortest)

    def width(self, length: float) -> float:
        """Return the diameter in m of the drawn braid at a length in m."""
        return float(ACROSS * np.sqrt(max(self.thread**2 - length**2, 0.04 * self.thread**2)) / (self.turns * np.pi))

    def draw(self, canvas: Canvas, start: Array, end: Array, values: Values, scale: float) -> None:
        """Draw the muscle between two points, coloured by its pressure as a share of `scale` in Pa."""
        span = end - start
        length = float(np.hypot(*span))
        if length <= 0.0:
            return
        along, half = span / length, 0.5 * self.width(length)
        across = np.array([along[1], -along[0]])
        colour = shade((values[self.pressure] - ATMOSPHERE) / scale)
        dark = tuple(int(0.55 * channel) for channel in colour)
        # The sleeve tapers to its fittings.
        cap = min(0.16, 1.2 * half / length)
        at = np.concatenate([cap * np.array([0.0, 0.2, 0.5, 1.0]), 1.0 - cap * np.array([1.0, 0.5, 0.2, 0.0])])
        half_at = half * np.array([0.45, 0.72, 0.92, 1.0, 1.0, 0.92, 0.72, 0.45])
        side = start + np.outer(at, span)
        outline = np.concatenate([side + np.outer(half_at, across), (side - np.outer(half_at, across))[::-1]])
        canvas.polygon(outline, colour)
        pixels = half * canvas.scale / FINE
        strands = 3 if pixels < 6.0 else 6
        places = np.linspace(0.02, 0.98, int(np.clip(12 * self.turns, 24, 96)))
        ends = np.interp(places, at, half_at)
        for phase, hand in itertools.product(2.0 * np.pi * np.arange(strands) / strands, (1.0, -1.0)):
            off = ends * np.cos(2.0 * np.pi * self.turns * places + phase) * hand
            canvas.line(start + np.outer(places, span) + np.outer(off, across), dark, 0.5 if pixels < 6.0 else 0.9)
        canvas.line(np.concatenate([outline, outline[:1]]), INK, 1.1)
        for point in (start, end):
            fitting = 0.55 * half * across
            canvas.line([point - fitting, point + fitting], INK, max(2.0, 0.35 * pixels))
