"""The branch of each law that holds, frozen while a step is taken.

A law with branches asks `positive(key, value, tolerance)` which side of zero its `value` is on. The answer
is the side on which the value was when the branch was entered, whatever it is at a trial stage of a step, so
that every right-hand side is smooth; the integration watches all the values asked for and ends the step
where the first of them changes its side. `guard` is the same for a condition whose end changes more than
a side (a body comes to rest, an element slips).

A value that begins at zero or on the wrong side is past its end only below −tolerance.
"""


class Branches:
    """The sides of all laws, by key; keys are tuples, the first item says what it is."""

    def __init__(self, sides=None):
        self.sides = dict(sides or {})
        self.seen = None  # key -> (value that must stay positive, tolerance) while it is collected

    def positive(self, key, value, tolerance):
        side = self.sides.get(key)
        if side is None:
            side = self.sides[key] = value > 0
        if self.seen is not None:
            self.seen[key] = (value if side else -value, tolerance)
        return side

    def guard(self, key, value, tolerance):
        if self.seen is not None:
            self.seen[key] = (value, tolerance)

    def copy(self):
        return Branches(self.sides)
