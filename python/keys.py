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
meaning says. `*` stands for a name that the file chooses.
"""
#: What repeats other sections, each with the section whose keys stand in it directly.
REPEATED = {"antagonist": "", "actuators": "actuator", "supplies": "supply", "mechanisms": "mechanism"}
TABLE = "| key | unit | range | default | meaning |\n|---|---|---|---|---|\n"
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


def keys(node: Node, path: str) -> typing.Iterator[tuple[str, Node]]:
    """Yield every key below a section with its schema; `*` is in the place of names that the file chooses."""
    named = {"*": node["additionalProperties"]} if "propertyNames" in node else node.get("properties", {})
    for name, inner in named.items():
        key = f"{path}.{name}" if path else name
        # A moment arm is a quantity or a section; so is the supply of an actuator a name or a section.
        ways = inner.get("anyOf", [inner])
        sections = [way for way in ways if "properties" in way or "propertyNames" in way]
        values = [way for way in ways if way not in sections]
        if values:
            yield key, inner if "description" in inner else values[0]
        for section in sections:
            yield from keys(section, key)


def row(key: str, inner: Node) -> str:
    """Return the row of the table for a key."""
    parts = parts_of(inner.get("description", ""))
    words = [f"`{choice['const']}`: {choice['description']}" for choice in inner.get("oneOf", []) if "const" in choice]
    unit = parts.get("Unit", "")
    span = parts.get("Range", "").removesuffix(f" {unit}").replace("1.5707963267948966", "pi/2")
    meaning = " ".join(filter(None, [parts[""], parts["Only"], *words])).replace("|", "\\|")
    default = str(inner.get("default", ""))
    return f"| `{key}` | {unit.replace('none', '–')} | {span} | {default and f'`{default}`'} | {meaning} |\n"


def page(schema: Node) -> str:
    """Return the text of the page."""
    text = HEAD
    sections = resolved(schema["properties"], schema["$defs"])
    known = {key for name in sections if name not in REPEATED for key, _ in keys(sections[name], name)}

    def repeats(key: str) -> bool:
        """Return whether a key below a name is one of another section."""
        name, *within = key.split(".*.", 1) if ".*." in key else key.split(".", 1)
        return any(inner in known or f"{REPEATED.get(name)}.{inner}" in known for inner in within)

    for name, section in sections.items():
        if name not in REPEATED:
            text += f"\n## `[{name}]`\n\n{section['description']}\n\n{TABLE}"
            listed = ((key, inner) for key, inner in keys(section, name) if not (".*." in key and repeats(key)))
            text += "".join(row(key.removeprefix(f"{name}."), inner) for key, inner in listed)
    text += "\n## Sections that repeat the others\n\n| section | meaning |\n|---|---|\n"
    text += "".join(f"| `[{name}]` | {sections[name]['description']} |\n" for name in REPEATED)
    below = (pair for name in REPEATED for pair in keys(sections[name], name))
    text += f"\nKeys that only these have:\n\n{TABLE}"
    return text + "".join(row(key, inner) for key, inner in below if not repeats(key))


def printed(program: str) -> Node:
    """Return the schema that a program prints."""
    done = subprocess.run([program, "schema"], check=True, capture_output=True, text=True)
    return typing.cast(Node, json.loads(done.stdout))


if __name__ == "__main__":
    PAGE.write_text(page(printed(sys.argv[1])), encoding="utf-8")
