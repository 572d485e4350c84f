"""One line and a bar for an install that takes a minute, and everything that pip says when it fails."""

from __future__ import annotations

import subprocess
import sys

import pip_with_bar


def test_the_bar_fills_with_what_pip_fetches_and_is_full_at_the_end() -> None:
    lines = ["Obtaining file:///src", "Collecting a>=1", "  Downloading a.whl", "Collecting b", "Collecting c"]
    lines += ["Installing collected packages: c, b, a", "Successfully installed a-1 b-1 c-1"]
    found = list(pip_with_bar.shares(lines, 2))
    assert found == [0.0, 0.35, 0.35, 0.7, 0.7, 0.7, 1.0]
    assert found == sorted(found), "it never goes back, also where more comes than was expected"
    assert pip_with_bar.bar("x", 0.5) == "x [" + "#" * 15 + "." * 15 + "]"
    assert pip_with_bar.expected() > 40


def run(*arguments: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, pip_with_bar.__file__, "installing", "install", "--no-index", *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=False, timeout=60)


def test_where_nobody_looks_it_is_one_line() -> None:
    done = run("pip")  # which is there
    assert (done.returncode, done.stdout, done.stderr) == (0, "installing\n", "")


def test_what_pip_says_is_shown_when_it_fails() -> None:
    done = run("no-package-is-called-so")
    assert done.returncode == 1
    assert "no-package-is-called-so" in done.stderr
