"""Starts the server with reload and Vite beside it; whichever ends, and Ctrl-C, ends both."""

from __future__ import annotations

import argparse
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

from web import Node, WebBuildError, install_packages, require_node

ROOT = Path(__file__).resolve().parent.parent


def start(host: str, port: int, node: Node) -> list[subprocess.Popen[bytes]]:
    """Start both sides, each as its own process group, so that their children end with them."""
    npm = node.program("npm")
    if npm is None:
        raise WebBuildError(f"npm vanished from {node.folder}")
    stepscope = Path(sys.executable).with_name("stepscope")
    server = [str(stepscope), "serve", "--reload", "--host", host, "--port", str(port)]
    ui_environment = {**node.environment(), "STEPSCOPE_API": f"http://{host}:{port}"}
    return [
        subprocess.Popen(server, cwd=ROOT, start_new_session=True),
        subprocess.Popen(
            [npm, "run", "--silent", "dev", "--", "--host", host],
            cwd=ROOT / "web",
            env=ui_environment,
            start_new_session=True,
        ),
    ]


def stop(processes: list[subprocess.Popen[bytes]]) -> None:
    """End every group: asked first, killed after five seconds."""
    for how in (signal.SIGINT, signal.SIGKILL):
        for process in processes:
            if process.poll() is None:
                os.killpg(process.pid, how)
        until_s = time.monotonic() + 5
        while any(process.poll() is None for process in processes) and time.monotonic() < until_s:
            time.sleep(0.05)


def main() -> int:
    """Run until something ends."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=8000)
    arguments = parser.parse_args()
    # A `kill` of this process ends the others like Ctrl-C does.
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    processes: list[subprocess.Popen[bytes]] = []
    try:
        node = require_node()
        install_packages(node)
        processes = start(arguments.host, arguments.port, node)
        while all(process.poll() is None for process in processes):
            time.sleep(0.2)
    except WebBuildError as error:
        print(f"dev: {error}", file=sys.stderr)
    except KeyboardInterrupt:
        return 0
    finally:
        stop(processes)
    return 1


if __name__ == "__main__":
    sys.exit(main())
