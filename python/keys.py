"""Write docs/keys.md, the reference of every key of a scenario file, from the schema that the program prints.

Run `python python/keys.py PROGRAM` to write the page; PROGRAM is the built `mckibben`.
"""

from __future__ import annotations

import json
import pathlib
import re
import subprocess
import sys
import typing

PAGE = pathlib.Path(__file__).parents[1] / "docs" / "keys.md"
UPDATE = "run `python python/keys.py PROGRAM` with the program as it is now, and commit docs/keys.md"
HEAD = """# Every key of a scenario file

Made from `mckibben schema` by `python/keys.py`. [The scenario file](scenario.md) says how a file is read. A quantity is a string with a unit of the
dimension that the column *unit* has; a pure number (–) is a number. A key without a default must be given, follows from other keys, or is absent, as its
meaning says.
"""
#: What repeats the sections of one actuator, or names parts.
REPEATED = ("antagonist", "actuators", "supplies", "mechanisms")
#: The parts of a description that have a separate column.
PARTS = ("Symbol", "Unit", "Range", "Default", "Default without a preset", "Source")
Node = dict[str, typing.Any]


def parts_of(description: str) -> dict[str, str]:
    """Split "Meaning. Symbol: b. Unit: m. …" into its parts; the meaning is of "", a condition of "Only"."""
    condition = re.search(r"Only with [^ ]+ = .+?\.(?= |$)", description)
    if condition:
        description = description.replace(condition[0], "").replace("  ", " ")
    pieces = re.split(r"(?:^|(?<=\. ))(" + "|".join(PARTS) + r"): ", description)
    named = {name: text.strip().removesuffix(".") for name, text in zip(pieces[1::2], pieces[2::2])}
    return {"": pieces[0].strip(), "Only": condition[0] if condition else ""} | named


def resolved(value: typing.Any, definitions: Node) -> typing.Any:
    """Return a part of a schema with what its references refer to."""
    if isinstance(value, dict):
        reference = value.get("$ref", "")
        if reference.startswith("#/$defs/shared-"):
            return resolved(definitions[reference.rsplit("/", 1)[1]], definitions)
        return {name: resolved(inner, definitions) for name, inner in value.items()}
    return [resolved(inner, definitions) for inner in value] if isinstance(value, list) else value


def rows(node: Node, path: str) -> typing.Iterator[str]:
    """Yield a row of the table for every key below a section."""
    for name, inner in node.get("properties", {}).items():
        key = f"{path}.{name}" if path else name
        if "properties" in inner:
            yield from rows(inner, key)
            continue
        parts = parts_of(inner.get("description", ""))
        words = [f"`{choice['const']}`: {choice['description']}" for choice in inner.get("oneOf", []) if "const" in choice]
        unit = parts.get("Unit", "")
        span = parts.get("Range", "").removesuffix(f" {unit}").replace("1.5707963267948966", "pi/2")
        meaning = " ".join(filter(None, [parts[""], parts["Only"], *words])).replace("|", "\\|")
        default = str(inner.get("default", ""))
        yield f"| `{key}` | {unit.replace('none', '–')} | {span} | {default and f'`{default}`'} | {meaning} |"


def page(schema: Node) -> str:
    """Return the text of the page."""
    text = HEAD
    sections = resolved(schema["properties"], schema["$defs"])
    for name, section in sections.items():
        if name in REPEATED:
            continue
        text += f"\n## `[{name}]`\n\n{section['description']}\n\n"
        text += "| key | unit | range | default | meaning |\n|---|---|---|---|---|\n"
        text += "\n".join(rows(section, "")) + "\n"
    text += "\n## Sections that repeat the others\n\n| section | meaning |\n|---|---|\n"
    repeated = (f"| `[{name}]` | {sections[name]['description']} |" for name in REPEATED)
    return text + "\n".join(repeated) + "\n"


def printed(program: str) -> Node:
    """Return the schema that a program prints."""
    done = subprocess.run([program, "schema"], check=True, capture_output=True, text=True)
    return typing.cast(Node, json.loads(done.stdout))


if __name__ == "__main__":
    PAGE.write_text(page(printed(sys.argv[1])), encoding="utf-8")
