"""docs/keys.md, the reference of scenario keys, is what the program's schema has."""

from __future__ import annotations

import importlib.util
import json
import pathlib
import re
import types

import mckibben

ROOT = pathlib.Path(__file__).parents[2]


def generator() -> types.ModuleType:
    spec = importlib.util.spec_from_file_location("keys", ROOT / "python" / "keys.py")
    keys = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(keys)
    return keys


def test_the_page_of_keys_is_made_from_the_schema(program, tmp_path):
    keys = generator()
    due = keys.page(json.loads(program(tmp_path, "schema").stdout))
    assert keys.PAGE.read_text(encoding="utf-8") == due, keys.UPDATE


def test_the_page_has_every_quantity_and_each_key_once(program, tmp_path):
    page = generator().page(json.loads(program(tmp_path, "schema").stdout))
    found, section = [], ""
    for line in page.splitlines():
        if line.startswith("## "):
            named = re.fullmatch(r"## `\[(.+)\]`", line)
            section = f"{named[1]}." if named else ""
        elif key := re.match(r"\| `([^`\[]+)` \|", line):
            found.append(section + key[1])
    assert len(found) == len(set(found))
    of_others = {key for key in mckibben.parameters() if key.startswith("antagonist.")}
    assert set(mckibben.parameters()) - of_others <= set(found)
    assert {"actuators.*.supply", "supplies.*.inlet.kind", "mechanism.joints.*.controller.agonist"} <= set(found)
