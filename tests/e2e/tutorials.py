"""Tutorials of the help as programs: what a reader is told to do is done, in a browser and in a shell.

Behind what a tutorial says stands what it means, in a comment that readers do not see:

    <!-- do
    open /                          go to a page
    take                            take the bench, unless this reader has it
    click button "Go"               a role and its name; `in "Scope"`: within the region of that name
    fill "Move to µsteps" 51200     a field by its label; leaves it with Tab
    choose "Unit" "rev"             an option of a list
    see "Ready"                     a text; `in "Scope"` as above
    see button "Send"               a thing by role and name
    run "Sweep" until "done" in "Speed sweep"
                                    what stops when a busy page misses its beat: begun anew, twice at most
    picture first-motor-1           the page as it is now; the tutorial shows it right after
    picture first-motor-2 of "Scope"
    -->

Blocks of `sh` and `python` are run as they stand, in the order of the text, unless their first line says
`# not run: ...` and why.
"""

from __future__ import annotations

import os
import re
import shlex
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from playwright.sync_api import Locator, Page, expect

DOCS = Path(__file__).parents[2] / "docs"
TUTORIALS = DOCS / "tutorials"
PICTURES = DOCS / "images" / "help"
BLOCK = re.compile(
    r"<!-- do\n(?P<steps>.*?)-->|^```(?P<language>sh|python)\n(?P<code>.*?)^```", re.DOTALL | re.MULTILINE
)
SHOWN = re.compile(r"!\[[^\]]+\]\(\.\./images/help/([\w-]+)\.png\)")
NOT_RUN = re.compile(r"# not run: \w+")
CODE_WITHIN_S = 60
PATIENCE_MS = 60_000
"""For motors to arrive and studies to end."""


@dataclass(frozen=True, slots=True)
class Step:
    """One line of what to do, or a block of code. `words` of the latter are its language and itself."""

    line: int
    words: tuple[str, ...]

    @property
    def is_code(self) -> bool:
        return self.words[0] in ("sh", "python")


def steps_of(text: str) -> Iterator[Step]:
    """All that a tutorial does, in its order."""
    for block in BLOCK.finditer(text):
        line = text.count("\n", 0, block.start()) + 1
        if block["code"] is not None:
            if not NOT_RUN.match(block["code"]):
                yield Step(line, (block["language"], block["code"]))
            continue
        for offset, each in enumerate(block["steps"].splitlines(), 1):
            if words := shlex.split(each):
                yield Step(line + offset, tuple(words))


def pictures_of(text: str) -> list[str]:
    """The pictures that a tutorial shows, in its order."""
    return SHOWN.findall(text)


class Reader:
    """Somebody who does what a tutorial says. Pictures go to `folder`, as they are made."""

    def __init__(self, page: Page, url: str, folder: Path) -> None:
        self.page, self.url, self.folder = page, url, folder
        self.taken: list[str] = []
        self.run_again = False
        """Whether something was begun once more: on a busy machine the server may hear too late of a tab."""

    def follow(self, tutorial: Path) -> None:
        """All steps. What fails says which line of the tutorial it was."""
        for step in steps_of(tutorial.read_text()):
            try:
                self._do(step)
            except Exception as error:
                error.add_note(f"{tutorial.relative_to(DOCS)} line {step.line}: {' '.join(step.words)}")
                raise

    def _do(self, step: Step) -> None:
        match step.words:
            case ("sh" | "python" as language, code):
                self._run(language, code)
            case ("open", path):
                self.page.goto(path)
            case ("take",):
                have = self.page.get_by_role("button", name="You have the bench")
                free = self.page.get_by_role("button", name="The bench is free. Take the bench")
                expect(have.or_(free)).to_be_visible(timeout=PATIENCE_MS)
                if free.is_visible():
                    free.click()
                expect(have).to_be_visible()
            case ("click", role, name, *where):
                self._thing(role, name, where).click()
            case ("fill", label, value, *where):
                field = self._within(where).get_by_role("textbox", name=label, exact=True).first
                field.fill(value)
                field.press("Tab")
            case ("choose", label, option, *where):
                self._within(where).get_by_role("combobox", name=label, exact=True).first.click()
                self.page.get_by_role("option").filter(has_text=option).first.click()
            case ("run", name, "until", text, *where):
                for again in range(3):
                    self.run_again = self.run_again or again > 0
                    self._thing("button", name, where).click()
                    expect(self._thing("button", "Stop", where)).to_be_visible()
                    expect(self._thing("button", name, where)).to_be_visible(timeout=PATIENCE_MS)
                    if self._within(where).get_by_text(text).first.is_visible():
                        break
                expect(self._within(where).get_by_text(text).first).to_be_visible()
            case ("see", text) | ("see", text, "in", _):
                expect(self._within(list(step.words[2:])).get_by_text(text).first).to_be_visible(timeout=PATIENCE_MS)
            case ("see", role, name, *where):
                expect(self._thing(role, name, where)).to_be_visible(timeout=PATIENCE_MS)
            case ("picture", name, *of):
                self._picture(name, of)
            case _:
                raise ValueError(f"{step.words} is nothing that a tutorial can do")

    def _within(self, where: list[str]) -> Page | Locator:
        match where:
            case []:
                return self.page
            case ["in", region]:
                return self.page.get_by_role("region", name=region, exact=True)
        raise ValueError(f'{where} is not: in "REGION"')

    def _thing(self, role: str, name: str, where: list[str]) -> Locator:
        return self._within(where).get_by_role(role, name=name, exact=True).first  # type: ignore[arg-type]

    def _picture(self, name: str, of: list[str]) -> None:
        what: Page | Locator = self.page
        if of:
            what = self.page.get_by_role("region", name=of[1], exact=True)
            what.scroll_into_view_if_needed()
        what.screenshot(path=str(self.folder / f"{name}.png"))
        self.taken.append(name)

    def _run(self, language: str, code: str) -> None:
        program = ["bash", "-euo", "pipefail", "-c"] if language == "sh" else [sys.executable, "-c"]
        path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
        environment = {**os.environ, "PATH": path, "STEPSCOPE_URL": self.url}
        done = subprocess.run(
            [*program, code],
            env=environment,
            cwd=self.folder,
            capture_output=True,
            text=True,
            timeout=CODE_WITHIN_S,
            check=False,
        )
        assert done.returncode == 0, f"{code}\n{done.stdout}{done.stderr}"
