"""docs/keys.md, the reference of scenario keys, is what the program's schema has."""

from __future__ import annotations

import importlib.util
import json
import pathlib

ROOT = pathlib.Path(__file__).parents[2]


def test_the_page_of_keys_is_made_from_the_schema(program, tmp_path):
    spec = importlib.util.spec_from_file_location("keys", ROOT / "python" / "keys.py")
    keys = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(keys)
    due = keys.page(json.loads(program(tmp_path, "schema").stdout))
    assert keys.PAGE.read_text(encoding="utf-8") == due, keys.UPDATE
