"""docs/tutorial.md: its commands print what the page shows, and its Python runs."""

from __future__ import annotations

import contextlib
import importlib.util
import io
import pathlib
import re

import numpy

ROOT = pathlib.Path(__file__).parents[2]


def load():
    spec = importlib.util.spec_from_file_location("tutorial", ROOT / "python" / "tutorial.py")
    tutorial = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(tutorial)
    return tutorial


def numbers(text: str) -> list[float]:
    return [float(number) for number in re.findall(r"-?\d+\.?\d*(?:e-?\d+)?", text)]


def test_the_commands_and_the_python_of_the_page(tmp_path, program, monkeypatch):
    tutorial = load()
    page = tutorial.PAGE.read_text(encoding="utf-8")
    ran = []
    for name, columns in tutorial.WIDTH.items():
        monkeypatch.setenv(name, columns)

    def run(folder, arguments):
        ran.append(arguments)
        done = program(folder, *arguments)
        return done.stdout + done.stderr

    assert tutorial.refreshed(page, tmp_path, run) == page, tutorial.UPDATE
    assert len(ran) == 9

    monkeypatch.chdir(tmp_path)
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        for block in tutorial.blocks(page, "python"):
            exec(compile(block, "tutorial.md", "exec"), {})
    (shown,) = tutorial.blocks(page, "text")
    assert numpy.allclose(numbers(printed.getvalue()), numbers(shown), rtol=1e-5)
