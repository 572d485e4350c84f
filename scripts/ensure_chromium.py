"""Makes sure that the browser tests have a Chromium: the system's, Debian's package, or Playwright's download.

Where Debian has it, the one without windows is installed beside another: the same tests take a seventh less work by it.
"""

from __future__ import annotations

import contextlib
import os
import shutil
import subprocess
import sys
from pathlib import Path

from chromium import HEADLESS, find_chromium
from playwright.sync_api import sync_playwright

APT_WITHIN_S = 300.0
"""A mirror that is silent keeps nobody longer [s]."""


def playwright_has_one() -> bool:
    """Tell whether Playwright's own Chromium was downloaded before."""
    with sync_playwright() as playwright:
        return Path(playwright.chromium.executable_path).is_file()


def apt_install(*packages: str) -> None:
    """Have Debian install packages, where this is one and we are root; what is missing there stays missing."""
    if not (shutil.which("apt-get") and hasattr(os, "geteuid") and os.geteuid() == 0):
        return
    print(f"installing {packages[0]} with apt-get", flush=True)
    environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
    install = ["apt-get", "install", "--yes", "-qq", "--no-install-recommends", *packages]
    for command in (["apt-get", "update", "-qq"], install):
        with contextlib.suppress(subprocess.TimeoutExpired):
            subprocess.run(command, env=environment, stdout=subprocess.DEVNULL, check=False, timeout=APT_WITHIN_S)


def main() -> int:
    """Install what is missing; 1 with a hint when nothing worked."""
    found = find_chromium()
    if found is not None and Path(found).name == HEADLESS:
        return 0
    apt_install(HEADLESS, "fonts-dejavu-core")
    if find_chromium() or playwright_has_one():
        return 0
    apt_install("chromium", "fonts-dejavu-core")
    if find_chromium():
        return 0
    print("installing Chromium with Playwright", flush=True)
    done = subprocess.run([sys.executable, "-m", "playwright", "install", "chromium"], check=False)
    if done.returncode == 0 and playwright_has_one():
        return 0
    print("no Chromium: install one, or point STEPSCOPE_CHROMIUM at its program", file=sys.stderr)
    return 1


if __name__ == "__main__":
    sys.exit(main())
