"""What README and documents tell to type, to call and to read exists: commands, options, REST calls, files.

They are run besides: tests/e2e/test_tutorials.py, tests/test_how_to.py, tests/test_commands.py.
"""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Iterator
from itertools import takewhile
from pathlib import Path

import pytest
import typer
from typer.core import TyperGroup

from app.cli import cli

ROOT = Path(__file__).parent.parent
PAGES = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *sorted((ROOT / "docs").rglob("*.md"))]
COMMAND = re.compile(r"^(?: {4}|\$ )?\.venv/bin/stepscope (.+)$|^ {4}stepscope (.+)$|`stepscope ([^`]+)`", re.MULTILINE)
FENCED = re.compile(r"^```sh\n(.*?)^```", re.DOTALL | re.MULTILINE)
CALL = re.compile(r"\b(GET|POST|PUT|PATCH|DELETE) +'?(?:http://[\w.]+:\d+)?(/[\w{}./-]*\w)")
LINK = re.compile(r"\]\((?!https?:|#)([^)#\s]+)")
SHELL = re.compile(r"[|&;>)]|\d?>.*")


def commands(text: str) -> Iterator[list[str]]:
    """What follows `stepscope`, word for word, up to what is the shell's."""
    text = text.replace("\\\n", " ")
    lines = ["    " + line for block in FENCED.findall(text) for line in block.splitlines()]
    for found in COMMAND.finditer("\n".join([text, *lines])):
        told = next(filter(None, found.groups()))
        yield list(takewhile(lambda word: not SHELL.fullmatch(word), shlex.split(told, comments=True)))


def trouble(words: list[str]) -> str:
    """Why the command line would not know it, or nothing."""
    command = typer.main.get_command(cli)
    rest = list(words)
    while isinstance(command, TyperGroup) and rest and not rest[0].startswith("-"):
        name = rest.pop(0)
        if name not in command.commands:
            return f"no command {name}"
        command = command.commands[name]
    known = {"--help"}.union(*(set(each.opts) | set(each.secondary_opts) for each in command.params))
    options = takewhile(lambda word: word != "--", rest)
    unknown = [word for word in options if re.match(r"--?[a-z]", word) and word.split("=")[0] not in known]
    return f"no option {unknown[0]} of {command.name}" if unknown else ""


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
class TestPage:
    def test_its_commands_are_known(self, page: Path) -> None:
        told = [(" ".join(words), trouble(words)) for words in commands(page.read_text())]
        assert [each for each in told if each[1]] == []

    def test_its_calls_are_known(self, page: Path) -> None:
        schema = json.loads((ROOT / "web" / "src" / "api" / "openapi.json").read_text())
        known = {
            f"{method.upper()} {re.sub(r'{.*?}', '*', path.removeprefix('/api/v1'))}"
            for path, methods in schema["paths"].items()
            for method in methods
        }
        parts = [each.split("/") for each in known]

        def is_known(call: str) -> bool:
            words = re.sub(r"{.*?}", "*", call).split("/")
            return any(
                len(words) == len(one) and all(a == b or b == "*" for a, b in zip(words, one, strict=True))
                for one in parts
            )

        told = [f"{method} {path.removeprefix('/api/v1')}" for method, path in CALL.findall(page.read_text())]
        assert [call for call in told if not is_known(call)] == []

    def test_its_links_lead_to_files(self, page: Path) -> None:
        """Those of the help also to headings: its build is strict. Pages of the reference are made by it."""
        text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.DOTALL | re.MULTILINE)
        linked = [page.parent / link for link in LINK.findall(text) if "/reference/" not in f"/{link}"]
        assert [str(path) for path in linked if not path.exists()] == []


def test_what_there_is_not_is_told() -> None:
    (words,) = commands("    .venv/bin/stepscope move bench 4000 --fast | cat\n")
    assert (words, trouble(words)) == (["move", "bench", "4000", "--fast"], "no option --fast of move")
    assert trouble(["profile", "burn", "1"]) == "no command burn"
    assert trouble(["move", "bench", "--", "-2000"]) == trouble(["serve", "--no-demo", "--port=1"]) == ""
    assert list(commands("```sh\nstepscope serve \\\n  --port 1 > log 2>&1 &\n```\n")) == [["serve", "--port", "1"]]
