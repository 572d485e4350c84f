"""A bench without hardware: one `stepscope emulate` for each device of bench.json, each at a TCP port of its own.

Ends with all of them when one ends, or at SIGTERM: what is half a bench looks like broken hardware.
"""

from __future__ import annotations

import argparse
import json
import signal
import subprocess
import sys
import time
from pathlib import Path

BENCH = Path(__file__).with_name("bench.json")
LOOK_EVERY_S = 0.2
GRACE_S = 5.0


def main() -> int:
    """Run until something ends; the exit code says whether that was wanted."""
    arguments = argparse.ArgumentParser(description=__doc__)
    arguments.add_argument("--host", default="0.0.0.0", help="where to listen")
    arguments.add_argument("--bench", type=Path, default=BENCH, help="the devices")
    given = arguments.parse_args()
    asked_to_end: list[int] = []
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda signum, _: asked_to_end.append(signum))
    running = {
        device["name"]: subprocess.Popen(
            [
                sys.executable,
                "-m",
                "stepscope.cli",
                "emulate",
                device["model"],
                "--tcp",
                f"{given.host}:{device['port']}",
            ]
        )
        for device in json.loads(given.bench.read_text())
    }
    try:
        while not asked_to_end:
            for name, process in running.items():
                if process.poll() is not None:
                    print(f"{name} has ended with {process.returncode}: so do the others", file=sys.stderr)
                    return 1
            time.sleep(LOOK_EVERY_S)
    finally:
        for process in running.values():
            process.terminate()
        for process in running.values():
            try:
                process.wait(GRACE_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
    return 0


if __name__ == "__main__":
    sys.exit(main())
