"""Run the commands of docs/tutorial.md again, and put what they print in the place of what the page shows.

Run `python python/tutorial.py PROGRAM`; PROGRAM is the built `mckibben`. The page shows a part of what is printed: each line that it
shows is found again by how it begins, and `…` stands for what is left out.
"""

from __future__ import annotations

import os
import pathlib
import re
import shlex
import subprocess
import sys
import tempfile
import typing

ROOT = pathlib.Path(__file__).parents[1]
PAGE = ROOT / "docs" / "tutorial.md"
UPDATE = "run `python python/tutorial.py PROGRAM` with the program as it is now, and commit docs/tutorial.md"
PROMPT = "$ mckibben "
#: Columns at which the program breaks its lines.
WIDTH = {"COLUMNS": "100"}
Run = typing.Callable[[pathlib.Path, typing.Sequence[str]], str]


def blocks(page: str, language: str) -> list[str]:
    """Return the blocks of code in a language."""
    return re.findall(rf"```{language}\n(.*?)```", page, flags=re.DOTALL)


def files(page: str, folder: pathlib.Path) -> None:
    """Write the files that the page has the reader write, and link the examples."""
    (folder / "examples").symlink_to(ROOT / "examples")
    muscle, sweep, study = blocks(page, "toml")
    (folder / "muscle.toml").write_text(muscle, encoding="utf-8")
    (folder / "many.toml").write_text(muscle + sweep, encoding="utf-8")
    (folder / "study.toml").write_text(study, encoding="utf-8")


def again(shown: list[str], printed: list[str]) -> list[str]:
    """Return the lines that are printed now for those that are shown: the next that begins with the same word, or with two."""
    lines, rest = [], list(printed)
    for line in shown:
        words = line.split()
        if not words or words == ["…"]:
            lines.append(line)
            continue
        for count in (2, 1):
            found = next((n for n, other in enumerate(rest) if other.split()[:count] == words[:count]), None)
            if found is not None:
                break
        if found is None:
            raise SystemExit(f"nothing that is printed begins as the line that docs/tutorial.md shows: {line}")
        lines.append(rest[found].rstrip())
        del rest[: found + 1]
    return lines


def refreshed(page: str, folder: pathlib.Path, run: Run) -> str:
    """Return the page with what its commands print now."""
    files(page, folder)
    for block in blocks(page, "console"):
        parts = block.split(PROMPT)
        for n, part in enumerate(parts[1:], 1):
            command = re.match(r"(?:.*\\\n)*.*\n", part)
            assert command is not None
            printed = run(folder, shlex.split(command[0].replace("\\\n", " ")))
            shown = part[command.end() :].splitlines()
            parts[n] = "".join(f"{line}\n" for line in [command[0].rstrip("\n"), *again(shown, printed.splitlines())])
        page = page.replace(block, PROMPT.join(parts))
    return page


def main(program: str) -> None:
    """Rewrite the page."""
    path = pathlib.Path(program).resolve()

    def run(folder: pathlib.Path, arguments: typing.Sequence[str]) -> str:
        done = subprocess.run([path, *arguments], cwd=folder, check=True, capture_output=True, text=True, env=os.environ | WIDTH)
        return done.stdout + done.stderr

    with tempfile.TemporaryDirectory() as folder:
        PAGE.write_text(refreshed(PAGE.read_text(encoding="utf-8"), pathlib.Path(folder), run), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1])
