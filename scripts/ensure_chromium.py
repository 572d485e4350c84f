"""Makes sure that the browser tests have a Chromium: the system's, Debian's package, or Playwright's download."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

from chromium import find_chromium
from playwright.sync_api import sync_playwright


def playwright_has_one() -> bool:
    """Tell whether Playwright's own Chromium was downloaded before."""
    with sync_playwright() as playwright:
        return Path(playwright.chromium.executable_path).is_file()


def main() -> int:
    """Install what is missing; 1 with a hint when nothing worked."""
    if find_chromium() or playwright_has_one():
        return 0
    if shutil.which("apt-get") and hasattr(os, "geteuid") and os.geteuid() == 0:
        print("installing Chromium with apt-get", flush=True)
        environment = {**os.environ, "DEBIAN_FRONTEND": "noninteractive"}
        install = ["apt-get", "install", "--yes", "-qq", "--no-install-recommends", "chromium", "fonts-dejavu-core"]
        for command in (["apt-get", "update", "-qq"], install):
            subprocess.run(command, env=environment, stdout=subprocess.DEVNULL, check=False)
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
