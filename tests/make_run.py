"""`make run` as somebody types it: what it prints until the server answers, in a terminal or not."""

from __future__ import annotations

import os
import pty
import re
import select
import signal
import subprocess
import time
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from server_process import free_port

ADDRESS = re.compile(r"^stepscope is at (http://\S+)")
OF_MAKE = ("MAKEFLAGS", "MAKELEVEL", "MFLAGS", "MAKEOVERRIDES")
"""What a make that runs the tests would tell this one."""


@dataclass(frozen=True)
class Printed:
    """lines : as they stand in the end
    redrawn : how often a line was written anew in its place, as a bar is
    address_s : after the command [s]
    """

    lines: list[str]
    redrawn: int
    address_s: float


def make_run(folder: Path, data_dir: Path, within_s: float) -> Printed:
    """Type it in `folder`, in a terminal, and press Ctrl-C once the address is there. Raises TimeoutError."""
    own, theirs = pty.openpty()
    command = ["make", "run", f"PORT={free_port()}", f"ARGS=--data-dir {data_dir}"]
    environment = {name: value for name, value in os.environ.items() if name not in OF_MAKE}
    began_s = time.perf_counter()
    process = subprocess.Popen(
        command, cwd=folder, env=environment, stdin=theirs, stdout=theirs, stderr=theirs, start_new_session=True
    )
    os.close(theirs)
    text, address_s = "", 0.0
    try:
        for piece in _pieces(own, began_s + within_s):
            text += piece
            if not address_s and any(ADDRESS.match(line) for line in text.splitlines()):
                address_s = time.perf_counter() - began_s
                os.killpg(process.pid, signal.SIGINT)
        process.wait(30)
    finally:
        if process.poll() is None:
            os.killpg(process.pid, signal.SIGKILL)
        os.close(own)
    lines = text.replace("\r\n", "\n").removesuffix("\n").split("\n")
    return Printed([line.split("\r")[-1] for line in lines], sum(line.count("\r") for line in lines), address_s)


def _pieces(terminal: int, end_s: float) -> Iterator[str]:
    """What is written to the terminal until all who write there have ended. Raises TimeoutError."""
    while True:
        if not select.select([terminal], [], [], max(end_s - time.perf_counter(), 0.0))[0]:
            raise TimeoutError("it has not come to its end")
        try:
            piece = os.read(terminal, 4096)
        except OSError:  # nobody has it open any more
            return
        yield piece.decode(errors="replace")
