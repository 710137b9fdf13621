"""Frames of plants: hanging muscles, joints and chains of joints, with the values of their targets."""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from mckibben._mckibben import Scenario
from mckibben.learning._chain import Chain
from mckibben.learning._drawing import BONE, FINE, GREY, INK, PAPER, TARGET, Canvas, Muscle, Values, font, shade
from mckibben.learning._plant import Plant

SIZE = (640, 480)  # pixels of a frame
PANEL = 150  # pixels of it, at the left, for numbers and the scale of pressures
SPACE = 16  # pixels around the drawing
# Rows of values: their number, the first place, the distance between them, and the place of the second column.
ROWS, TOP, PITCH, RIGHT = 6, 46, 42, 86
# Format of a column by the end of its name: factor, digits and unit.
UNITS = {"angle_rad": (180.0 / np.pi, 1, "°"), "_m": (1e3, 1, " mm"), "_pa": (1e-3, 0, " kPa")}


class Hanging:
    """Hanging muscles: each carries its own load or is clamped, or all carry one mass."""

    def __init__(self, plant: Plant, muscles: Mapping[str, Muscle], position: str | None = None, mass: float = 0.0) -> None:
        self.muscles, self.position = list(muscles.values()), position
        self.columns = [position or muscle.length or "" for muscle in self.muscles]
        self.blocks = []
        for name in muscles:
            free = not position and plant.section(name, "load").get("kind") in ("hanging-mass", "constant-force")
            own = f"actuators.{name}.load.mass" if name else "load.mass"
            self.blocks.append(plant.number(own, "load.mass") or 0.0 if free else 0.0)
        self.mass = mass
        # A block of steel of each mass.
        self.sides = [0.6 * (block / 7800.0) ** (1 / 3) for block in [*self.blocks, mass]]
        self.pitch = 1.5 * max(*self.sides[:-1], 2.5 * max(muscle.widest for muscle in self.muscles))
        self.middles = self.pitch * (np.arange(len(self.muscles)) + 0.5)
        longest = max(muscle.longest for muscle in self.muscles)
        self.low, self.high = np.array([0.0, -0.04 * longest]), np.array([self.pitch * len(self.muscles), 1.18 * longest])
        self.high[1] += max(self.sides)

    def draw(self, canvas: Canvas, values: Values, aims: Values, full: float, seconds: float) -> None:
        """Draw the muscles, and lines at the targets of their lower ends."""
        right = self.high[0]
        canvas.ground((0.0, 0.0), (right, 0.0))
        hook = 0.05 * max(muscle.longest for muscle in self.muscles)
        for muscle, column, middle, mass, side in zip(
            self.muscles, self.columns, self.middles, self.blocks, self.sides, strict=False
        ):
            length = values[column]
            top, end = np.array([middle, 0.0]), np.array([middle, length])
            muscle.draw(canvas, top, end, values, full)
            canvas.line([end, end + (0.0, hook)], INK, 2.0)
            if mass > 0.0:
                self._block(canvas, middle, length + hook, side, side, mass)
            elif not self.position:
                canvas.ground((middle - 0.3 * self.pitch, length + hook), (middle + 0.3 * self.pitch, length + hook), 1.0)
            if column in aims:
                self._aim(canvas, middle, aims[column])
        if self.position:
            self._block(canvas, 0.5 * right, values[self.position] + hook, 0.8 * right, self.sides[-1], self.mass)

    def _aim(self, canvas: Canvas, middle: float, length: float) -> None:
        """Draw a dashed line at a length, between two marks."""
        far, mark = 0.46 * self.pitch, 0.05 * self.pitch
        for one, other in np.linspace(-far, far, 22).reshape(11, 2):
            canvas.line([(middle + one, length), (middle + other, length)], TARGET, 2.0)
        for side in (-far, far):
            tip = middle + side * (1.0 - mark / far)
            canvas.polygon([(tip, length), (middle + side, length - 0.6 * mark), (middle + side, length + 0.6 * mark)], TARGET)

    def _block(self, canvas: Canvas, middle: float, top: float, width: float, height: float, mass: float) -> None:
        corners = [(-0.5, 0.0), (0.5, 0.0), (0.5, 1.0), (-0.5, 1.0)]
        canvas.polygon([(middle + x * width, top + y * height) for x, y in corners], BONE, INK, 1.2)
        canvas.text((middle, top + 0.5 * height), f"{mass:.3g} kg")


class Renderer:
    """Frames of one plant."""

    def __init__(self, scenario: Scenario, columns: Sequence[str], targets: Sequence[str]) -> None:
        plant = Plant(scenario)
        self.columns, self.targets = list(columns), list(targets)[:ROWS]
        self.groups = groups(plant, self.columns)
        muscles = [muscle for group in self.groups for muscle in group.muscles]
        self.full = max(muscle.full for muscle in muscles)
        room = np.array([SIZE[0] - PANEL - 2 * SPACE, SIZE[1] - 2 * SPACE]) * FINE
        spans = [group.high - group.low for group in self.groups]
        gap = 0.12 * max(span[0] for span in spans)
        wide = sum(span[0] for span in spans) + gap * (len(spans) - 1)
        high = max(span[1] for span in spans)
        scale = float(min(room[0] / wide, room[1] / high))
        # Drawn larger on the area of the plant alone, and then averaged.
        half = [int(0.5 * scale * length / FINE) + SPACE // 2 for length in (wide, high)]
        self.fine = Image.new("RGB", (2 * half[0] * FINE, 2 * half[1] * FINE))
        self.corner = ((SIZE[0] + PANEL) // 2 - half[0], SIZE[1] // 2 - half[1])
        left = 0.5 * (self.fine.width - wide * scale)
        self.canvases = []
        for group, span in zip(self.groups, spans, strict=True):
            top = 0.5 * (self.fine.height - span[1] * scale)
            self.canvases.append(Canvas(self.fine, scale, np.array([left, top]) - group.low * scale))
            left += (span[0] + gap) * scale
        self.panel = self._panel()

    def frame(self, observed: NDArray[np.float64], aims: Values, seconds: float) -> NDArray[np.uint8]:
        """Return the frame of a plant from its columns and targets, both in SI: an array of shape (height, width, 3)."""
        values = dict(zip(self.columns, map(float, observed), strict=True))
        self.fine.paste(PAPER, (0, 0, *self.fine.size))
        for group, canvas in zip(self.groups, self.canvases, strict=True):
            group.draw(canvas, values, aims, self.full, seconds)
        image = self.panel.copy()
        image.paste(self.fine.reduce(FINE), self.corner)
        self._numbers(ImageDraw.Draw(image), values, aims, seconds)
        return np.array(image)

    def _panel(self) -> Image.Image:
        """Return the fixed part of every frame: the names of the targets and the scale of pressures."""
        image = Image.new("RGB", SIZE, PAPER)
        draw, small = ImageDraw.Draw(image), font(12)
        draw.text((SPACE, TOP - 22), "now", INK, small, anchor="ls")
        draw.text((RIGHT, TOP - 22), "target", TARGET, small, anchor="ls")
        for row, column in enumerate(self.targets):
            part, _, name = column.rpartition(".")
            # Without its unit; a long name is cut at the edge of the plant.
            label = name.replace("_rad", "").replace("_pa", "").removesuffix("_m").replace("_", " ")
            draw.text((SPACE, TOP + row * PITCH), f"{part} {label}".strip()[:20], GREY, small, anchor="ls")
        bottom, top = SIZE[1] - 52, SIZE[1] - 172
        for y in range(top, bottom):
            draw.line((16, y, 30, y), fill=shade((bottom - y) / (bottom - top)))
        draw.rectangle((16, top, 30, bottom), outline=INK)
        draw.text((16, top - 10), "gauge pressure", GREY, small, anchor="ls")
        for share in (0.0, 0.5, 1.0):
            tick = bottom + share * (top - bottom)
            draw.line((30, tick, 34, tick), fill=INK)
            draw.text((38, tick), f"{share * self.full / 1e3:.0f} kPa", INK, small, anchor="lm")
        return image

    def _numbers(self, draw: ImageDraw.ImageDraw, values: Values, aims: Values, seconds: float) -> None:
        for row, column in enumerate(self.targets):
            factor, digits, unit = next((unit for end, unit in UNITS.items() if column.endswith(end)), (1.0, 2, ""))
            for x, value, colour in ((SPACE, values[column], INK), (RIGHT, aims[column], TARGET)):
                text = f"{value * factor:.{digits}f}{unit}"
                draw.text((x, TOP + 17 + row * PITCH), text, colour, font(14), anchor="ls")
        draw.text((SPACE, SIZE[1] - 18), f"{seconds:.2f} s", INK, font(14), anchor="ls")


def groups(plant: Plant, columns: list[str]) -> list[Any]:
    """Return the parts of a picture: chains of joints, masses on several muscles, and muscles with separate loads."""
    if not plant.actuators:
        if plant.at("load.kind") == "antagonistic-joint":
            return [Chain(plant, "load", columns)]
        return [Hanging(plant, {"": Muscle(plant, "", columns)})]
    drawn: list[Any] = []
    alone = {name: Muscle(plant, name, columns, f"{name}.", f"actuators.{name}") for name in plant.actuators}
    for path, section in plant.mechanisms().items():
        if section.get("kind") == "chain":
            chain = Chain(plant, path, columns)
            drawn.append(chain)
            on_it = [cord.muscle.pressure for cord in chain.cords]
        else:
            named = path.rpartition(".")[2]
            theirs = {
                name: muscle
                for name, muscle in alone.items()
                if plant.section(name, "coupling").get("mechanism", named) == named and not plant.at(f"actuators.{name}.load")
            }
            drawn.append(Hanging(plant, theirs, f"{named}.position_m", plant.number(f"{path}.mass") or 0.0))
            on_it = [muscle.pressure for muscle in theirs.values()]
        alone = {name: muscle for name, muscle in alone.items() if muscle.pressure not in on_it}
    if alone:
        drawn.append(Hanging(plant, alone))
    return drawn
