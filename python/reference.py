"""Write docs/api.md, the reference of the Python package, from the docstrings of the installed package.

Run `python python/reference.py` to write the page, and with `--check` to find out whether it is up to date.
"""

from __future__ import annotations

import ast
import dataclasses
import enum
import functools
import inspect
import pathlib
import re
import sys
import textwrap
import types
import typing

import mckibben
import mckibben._results
import mckibben._scenario
import mckibben.learning
import mckibben.mujoco

PAGE = pathlib.Path(__file__).parents[1] / "docs" / "api.md"
UPDATE = "run `python python/reference.py` with the package as it is now, and commit docs/api.md"
HEAD = """# Reference of the Python package

Made from the docstrings of the package by `python/reference.py`. Numbers are in SI; a quantity of a scenario may be text
with its unit. [The package](python.md) introduces it, and [learning to control](python-learning.md) its environments. In a
call `...` stands for a default that the table of the parameters states.
"""
#: The chapters, each with the names in it. A name with a point is not exported, but is the type of a result.
CHAPTERS: dict[str, str] = {
    "Scenarios": "Scenario _scenario.Section parameters Parameter presets Preset PresetValue",
    "Runs": "simulate Trajectory Event _results.Summary _results.Settled _results.Settling",
    "Statics and curves": "Statics curves Curves",
    "Linear models": "linearize LinearModel _results.Modes _results.Mode "
    "_results.Validity _results.Controllability _results.Pulses",
    "Sweeps": "sweep SweepResult SweepWarning Sweep",
    "Choosing": "size Sizes SizedMuscle design DesignResult Constrained",
    "Identification": "identify Study Run Identification Estimate OtherMinimum StepResponse StepInfo Prediction",
    "In your own loop": "Actuator ActuatorState Response Actuators HostedPlant VectorPlant",
    "MuJoCo": " ".join(f"mujoco.{name}" for name in mckibben.mujoco.__all__ if name != "PLUGIN"),
    "Derivatives": "Differentiable DifferentiableStep",
    "Environments": " ".join(f"learning.{name}" for name in mckibben.learning.__all__),
    "Errors": "Error InputError SimulationError OutputError",
}
PARAMETERS = ("Parameters", "Other Parameters", "Attributes", "Returns", "Raises", "Warns", "Yields")
Items = list[tuple[str, str, str]]


def sections(doc: str | None) -> dict[str, list[str]]:
    """Return the lines of each section of a docstring in the style of numpydoc; those before the first are of ""."""
    lines = inspect.cleandoc(doc or "").splitlines()
    found: dict[str, list[str]] = {"": []}
    name = ""
    for line, following in zip(lines, [*lines[1:], ""]):
        if re.fullmatch(r"[A-Z][A-Za-z ]+", line) and following == "-" * len(line):
            found[name := line] = []
        elif not (line and set(line) == {"-"} and len(line) == len(name)):
            found[name].append(line)
    return found


def items(lines: list[str]) -> Items:
    """Return name, type and text of each item of a section: `name : type` with an indented text below."""
    found: Items = []
    for line in lines:
        if line and not line.startswith(" "):
            name, _, kind = line.partition(" : ")
            found.append((name, kind, ""))
        elif found:
            name, kind, text = found[-1]
            found[-1] = (name, kind, f"{text} {line.strip()}".strip())
    return found


def summary(doc: str | None) -> str:
    """Return the first paragraph of a docstring."""
    return " ".join(inspect.cleandoc(doc or "").split("\n\n")[0].split())


def commented(of: type) -> Items:
    """Return the fields of a data class with the comments that begin with `#:` above them."""
    source = textwrap.dedent(inspect.getsource(of))
    lines, found, text = source.splitlines(), [], ""
    [body] = ast.parse(source).body
    for field in typing.cast(ast.ClassDef, body).body:
        if isinstance(field, ast.AnnAssign):
            above = field.lineno - 2
            while lines[above].lstrip().startswith("#:"):
                above -= 1
            own = " ".join(line.strip().removeprefix("#:").strip() for line in lines[above + 1 : field.lineno - 1])
            text = own or text  # A field without a comment shares that of the field above.
            found.append((ast.unparse(field.target), ast.unparse(field.annotation), text))
    return found if text else []


def members(of: type) -> list[tuple[str, typing.Any]]:
    """Return the public methods and properties of a class that are its own, by their names."""
    kinds = (types.FunctionType, types.MethodDescriptorType, types.BuiltinMethodType, staticmethod, classmethod)
    kinds = (*kinds, property, types.GetSetDescriptorType, functools.cached_property)
    return sorted((name, member) for name, member in vars(of).items() if name[0] != "_" and isinstance(member, kinds))


def unwrapped(member: typing.Any) -> typing.Any:
    """Return the function of a static method or a class method, and anything else as it is."""
    return getattr(member, "__func__", member)


def is_property(member: object) -> bool:
    """Return whether a member of a class is read as an attribute."""
    return isinstance(member, (property, types.GetSetDescriptorType, functools.cached_property))


def parameters_of(of: typing.Any) -> list[inspect.Parameter]:
    """Return the parameters of a function, a method or a constructor, without `self`."""
    return [one for one in inspect.signature(unwrapped(of)).parameters.values() if one.name not in ("self", "cls")]


def call(name: str, of: typing.Any) -> str:
    """Return the call of a function or a class with its parameters and their defaults."""

    def default(value: typing.Any) -> str:
        if isinstance(value, enum.Enum):
            return f"{type(value).__name__}.{value.name}"
        return "..." if value is ... else "{}" if repr(value) == "<factory>" else repr(value)

    words, starred = [], False
    for one in parameters_of(of):
        if one.kind is one.KEYWORD_ONLY and not starred:
            words, starred = [*words, "*"], True
        prefix = {one.VAR_POSITIONAL: "*", one.VAR_KEYWORD: "**"}.get(one.kind, "")
        starred = starred or one.kind is one.VAR_POSITIONAL
        words.append(prefix + one.name + ("" if one.default is one.empty else f"={default(one.default)}"))
    indent = " " * (len(name) + 1)
    wrapped = textwrap.wrap(f"{name}({', '.join(words)})", 100, subsequent_indent=indent, break_on_hyphens=False)
    return "\n".join(["```python", *wrapped, "```", ""])


def escaped(text: str) -> str:
    """Return text in which Markdown takes no star and no angle bracket for its own, but for code between backticks."""
    parts = text.split("`")
    return "`".join(re.sub(r"([*<])", r"\\\1", part) if place % 2 == 0 else part for place, part in enumerate(parts))


def table(head: tuple[str, ...], rows: typing.Iterable[tuple[str, ...]]) -> str:
    """Return a table of Markdown."""
    lines = [head, ("---",) * len(head), *(tuple(escaped(cell).replace("|", r"\|") for cell in row) for row in rows)]
    return "".join("|" + "|".join(line if set(line) == {"-"} else f" {line} " for line in row) + "|\n" for row in lines) + "\n"


def prose(lines: list[str]) -> str:
    """Return paragraphs and tables as they are, and examples as blocks of code."""
    text = ""
    for block in re.split(r"\n\s*\n", "\n".join(lines).strip("\n")):
        if block.lstrip().startswith(">>>"):
            text += f"```pycon\n{textwrap.dedent(block)}\n```\n\n"
        elif block:
            text += f"{block if block.startswith('|') else escaped(block)}\n\n"
    return text.replace("```\n\n```pycon\n", "\n")


def described(doc: str | None) -> str:
    """Return a docstring as Markdown."""
    found = sections(doc)
    text = prose(found.pop(""))
    for name, lines in found.items():
        text += f"**{name}**\n\n"
        if name in ("Parameters", "Other Parameters", "Attributes"):
            text += table(("name", "type", "meaning"), [(f"`{name}`", kind, words) for name, kind, words in items(lines)])
        elif name in PARAMETERS:
            named = [(f"`{name}` ({kind})" if kind else f"`{name}`", words) for name, kind, words in items(lines)]
            text += "".join(f"- {head}{': ' if words else ''}{escaped(words)}\n" for head, words in named) + "\n"
        else:
            text += prose(lines)
    return text


def entry(path: str) -> str:
    """Return the part of the page on a function or a class of the package."""
    of = functools.reduce(getattr, path.split("."), mckibben)
    name = shown(path)
    text = f"### {name}\n\n"
    if not isinstance(of, type):
        return text + call(name, of) + "\n" + described(of.__doc__)
    documented = sections(of.__doc__)
    is_made = "Parameters" in documented or path.startswith("learning.")
    text += (call(name, of) + "\n" if is_made else "") + described(of.__doc__)
    if dataclasses.is_dataclass(of) and not {"Attributes", "Parameters"} & set(documented) and (fields := commented(of)):
        rows = [(f"`{field}`", f"`{kind}`", words) for field, kind, words in fields]
        text += "**Attributes**\n\n" + table(("name", "type", "meaning"), rows)
    properties = [(f"`{one}`", " ".join((its.__doc__ or "").split())) for one, its in members(of) if is_property(its)]
    text += "**Properties**\n\n" + table(("name", "meaning"), properties) if properties else ""
    for method, member in members(of):
        if not is_property(member):
            text += f"#### {name}.{method}\n\n" + call(method, member) + "\n" + described(unwrapped(member).__doc__)
    return text


def shown(path: str) -> str:
    """Return the name of a class or function as the page has it."""
    return path if path.startswith("learning.") else path.rpartition(".")[2]


def link(name: str, places: dict[str, int]) -> str:
    """Return a link to a heading. Of headings that differ in case alone, the later ones are counted in `places`."""
    place = re.sub(r"[^a-z0-9_]", "", name.lower())
    places[place] = places.get(place, -1) + 1
    return f"[`{name}`](#{place}{f'-{places[place]}' if places[place] else ''})"


def page() -> str:
    """Return the whole page."""
    missing = set(mckibben.__all__) - {"__version__"} - {name for names in CHAPTERS.values() for name in names.split()}
    if missing:
        raise SystemExit(f"python/reference.py: name a chapter of CHAPTERS for {', '.join(sorted(missing))}")
    places: dict[str, int] = {}
    links = {chapter: [link(shown(path), places) for path in names.split()] for chapter, names in CHAPTERS.items()}
    text = HEAD + "\n" + table(("chapter", "names"), [(chapter, ", ".join(its)) for chapter, its in links.items()])
    for chapter, names in CHAPTERS.items():
        text += f"## {chapter}\n\n" + (described(mckibben.learning.__doc__) if chapter == "Environments" else "")
        text += "".join(entry(path) for path in names.split())
    return text.rstrip("\n") + "\n"


def outdated() -> str:
    """Return why docs/api.md is not what the package has; empty where it is."""
    kept = PAGE.read_text(encoding="utf-8").splitlines() if PAGE.exists() else []
    made = page().splitlines()
    for number, (line, due) in enumerate(zip([*kept, ""], [*made, ""]), 1):
        if line != due:
            return f"docs/api.md is not what the package has, from line {number} on: {due!r} is due; {UPDATE}"
    return "" if kept == made else f"docs/api.md is not what the package has; {UPDATE}"


if __name__ == "__main__":
    if "--check" in sys.argv[1:]:
        sys.exit(outdated() or 0)
    PAGE.write_text(page(), encoding="utf-8")
    print(f"wrote {PAGE}")
