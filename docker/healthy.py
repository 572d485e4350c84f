"""Whether the server of this data directory answers: exit code 0 or 1. It says itself where it listens, and how."""

from __future__ import annotations

import os
import re
import ssl
import sys
import urllib.request
from pathlib import Path

WITHIN_S = 4.0


def main() -> int:
    """Ask the address that the running server has left in its lock."""
    said = (Path(os.environ["STEPSCOPE_DATA_DIR"]) / "server.lock").read_text(encoding="utf-8")
    address = re.findall(r"https?://[^\s,;]+", said)[0]
    # Its certificate is for the name that browsers use, not for this one.
    unchecked = ssl.create_default_context()
    unchecked.check_hostname = False
    unchecked.verify_mode = ssl.CERT_NONE
    with urllib.request.urlopen(f"{address}/api/v1/health", timeout=WITHIN_S, context=unchecked) as answer:
        print(answer.read().decode())
    return 0


if __name__ == "__main__":
    sys.exit(main())
