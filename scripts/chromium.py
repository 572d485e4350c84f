"""Which Chromium the browser tests, the bench and the screenshots start, and how."""

from __future__ import annotations

import os
import shutil
import subprocess

HEADLESS = "chromium-headless-shell"
"""Debian's program and package of the one without windows: it works less for the same pages."""
NAMES = (HEADLESS, "chromium", "chromium-browser", "google-chrome", "google-chrome-stable")


def find_chromium() -> str | None:
    """Return the path of a Chromium that starts: $STEPSCOPE_CHROMIUM, else the system's; None: ask Playwright."""
    asked = os.environ.get("STEPSCOPE_CHROMIUM")
    for name in (asked,) if asked else NAMES:
        path = shutil.which(name)
        if path is not None and _starts(path):
            return path
    return None


def _starts(path: str) -> bool:
    # Ubuntu's chromium-browser is a script that only says to install a snap.
    try:
        return subprocess.run([path, "--version"], capture_output=True, timeout=60, check=False).returncode == 0
    except (OSError, subprocess.TimeoutExpired):
        return False


def chromium_flags() -> list[str]:
    """Return flags that keep the browser to our pages: no calls home, and no sandbox where it cannot work (root)."""
    flags = [
        "--disable-background-networking",
        "--disable-component-update",
        "--disable-sync",
        "--no-first-run",
        "--disable-quic",
    ]
    if hasattr(os, "geteuid") and os.geteuid() == 0:
        flags.append("--no-sandbox")
    return flags
