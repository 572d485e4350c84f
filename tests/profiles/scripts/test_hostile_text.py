"""Names and notes come from anywhere. In no language they are anything but remarks."""

from __future__ import annotations

import ast
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from app.profiles.scripts import c, curl, python, tmcl
from app.profiles.scripts.plan import Plan, plan_of
from app.profiles.scripts.readers import commands_of_tmcl, frames_of_c, writes_of_curl
from app.profiles.scripts.text import c_name, file_stem, one_line
from tests.profiles.scripts.documents import profile_of

HOSTILE = (
    "*/ int main(void) { return 7; } /*",
    "??/\n*??/\n/ nasty",
    "ends with a backslash \\",
    '"""\nimport os\nos.abort()\n"""',
    "-*- coding: utf-7 -*- +AAo-import os",
    "line\nput 'V_MAX' '' '{\"value\":1}'\r\nrm -rf $HOME",
    "'; $(reboot) `reboot` ${x}",
    "a\u2028MVP ABS, 0, 1\u2029b\x0bc\x0cd\x85e",
    "\u202e \u2066 turned \u200b",
    "SAP 4, 0, 1 // \nMVP ABS, 0, 1",
    "\x00\x1b[2J\ud800",
    "../../etc/passwd",
)
CHIP, MODULE = plan_of(profile_of("tmc5160")), plan_of(profile_of("pd42-1241"))
"""Plans with harmless words: what every other of the same profile has to mean."""
ANY = st.text(max_size=200) | st.sampled_from(HOSTILE)


def called(plan: Plan, name: str, note: str) -> Plan:
    """The plan with words that nobody has looked at: more than a document would let pass."""
    return replace(plan, name=name, note=note)


def shell_lines(text: str) -> list[str]:
    return [line for line in text.encode().decode().split("\n") if not line.startswith("#")]


PYTHON = ast.dump(ast.parse(python.render(CHIP).encode()))
SHELL = shell_lines(curl.render(CHIP))
FRAMES = frames_of_c(c.render(CHIP), CHIP.family)
PROGRAM = tmcl.render(MODULE)


@settings(deadline=None, max_examples=60)
@given(name=ANY, note=ANY)
@example(name=HOSTILE[4], note=HOSTILE[3])
def test_python_means_the_same_whatever_a_profile_is_called(name: str, note: str) -> None:
    assert ast.dump(ast.parse(python.render(called(CHIP, name, note)).encode())) == PYTHON


@settings(deadline=None, max_examples=60)
@given(name=ANY, note=ANY)
def test_a_shell_reads_the_same_lines_whatever_a_profile_is_called(name: str, note: str) -> None:
    assert shell_lines(curl.render(called(CHIP, name, note))) == SHELL


@settings(deadline=None, max_examples=60)
@given(name=ANY, note=ANY)
def test_a_module_is_told_the_same_whatever_a_profile_is_called(name: str, note: str) -> None:
    text = tmcl.render(called(MODULE, name, note))
    assert text.isascii()
    assert list(commands_of_tmcl(text)) == list(commands_of_tmcl(PROGRAM))
    # splitlines: whatever another reader may take for the end of a line
    assert all(line.startswith("//") or line in PROGRAM for line in text.splitlines())


@settings(deadline=None, max_examples=60)
@given(name=ANY, note=ANY)
def test_a_header_has_the_same_arrays_whatever_a_profile_is_called(name: str, note: str) -> None:
    text = c.render(called(CHIP, name, note))
    assert text.isascii()
    assert frames_of_c(text, CHIP.family) == FRAMES
    assert text.count("/*") == text.count("*/")
    assert "??" not in text


@pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler")
def test_a_compiler_sees_the_same_header_and_warns_of_nothing(tmp_path: Path) -> None:
    strict = ("cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-E", "-P", "-x", "c")

    def seen(name: str, note: str) -> str:
        (tmp_path / "x.h").write_text(c.render(called(CHIP, name, note)), encoding="utf-8", newline="\n")
        done = subprocess.run((*strict, "x.h"), cwd=tmp_path, capture_output=True, text=True, timeout=60, check=False)
        assert not done.stderr
        return done.stdout

    plain = seen("", "")
    for text in HOSTILE:
        assert seen("", text) == plain
    assert seen("", "\n".join(HOSTILE)) == plain


def test_a_file_is_called_by_harmless_letters_alone() -> None:
    for text in (*HOSTILE, "", "漢字", "9 lives", "x" * 500):
        assert file_stem(text).replace("-", "").isalnum()
        assert len(file_stem(text)) <= 40
        assert c_name(text).isidentifier()
        assert "\n" not in one_line(text)
    assert file_stem("X axis, fast & quiet") == "x-axis-fast-quiet"


@pytest.mark.parametrize("model", ["tmc428", "tmc4361", "tmc5160", "pd42-1241"])
def test_our_own_readers_find_what_was_written(model: str) -> None:
    plan = plan_of(profile_of(model))
    writes = [write for part in plan.parts for write in part.writes]
    assert len(frames_of_c(c.render(plan), plan.family)) == plan.count == len(writes)
    read = writes_of_curl(curl.render(plan))
    assert [(item.name, item.axis) for item in read] == [(write.register.name, write.register.axis) for write in writes]
    assert [item.fields or item.value for item in read] == [write.fields or write.value for write in writes]
