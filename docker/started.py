"""Starts a server with an empty data directory, looks at what keeps a database, and ends it.

In the image this leaves the byte code of all that a start imports, then and soon after: a container that may not write
would compile that at each start.
"""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
import tempfile
import urllib.request

LOOKED_AT = ("", "api/v1/devices", "api/v1/profiles", "api/v1/audit", "api/v1/recordings", "api/v1/health/details")
WITHIN_S = 120.0


def main() -> int:
    """The server's exit code."""
    environment = {name: value for name, value in os.environ.items() if not name.startswith("STEPSCOPE_")}
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, "-m", "stepscope.cli", "serve", "--no-demo", "--port", "0", "--data-dir", folder]
        with subprocess.Popen(command, env=environment, stdout=subprocess.PIPE, text=True) as server:
            try:
                assert server.stdout is not None
                said = next((found[0] for line in server.stdout if (found := re.search(r"http://[\d.:]+", line))), "")
                for path in LOOKED_AT:
                    with urllib.request.urlopen(f"{said}/{path}", timeout=WITHIN_S) as answer:
                        answer.read()
            finally:
                server.send_signal(signal.SIGINT)
            return server.wait(WITHIN_S)


if __name__ == "__main__":
    sys.exit(main())
