"""How fast clients of others ask the emulated module over a pty: what our own link is measured against."""

from __future__ import annotations

import contextlib
import os
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

from tests.peers.emulator_process import EmulatorProcess, emulator

GAP_ACTUAL_POSITION = bytes.fromhex("010601000000000008")
BATCH = 50
"""Questions between two looks at the clock: a look costs as much as a hundredth of a question."""


@contextlib.contextmanager
def emulated_pty(*flags: str) -> Iterator[EmulatorProcess]:
    """A module of its own on a pty of its own; `flags` as of `stepscope emulate`, e.g. "--baud", "115200"."""
    with (
        tempfile.TemporaryDirectory(prefix="stepscope-") as folder,
        emulator(*flags, pty=Path(folder) / "module") as process,
    ):
        yield process


def pytrinamic_gaps_per_s(path: str | os.PathLike[str], seconds: float) -> float:
    """Answers a second that PyTrinamic gets, asking for the actual position again and again for `seconds` [s]."""
    from pytrinamic.connections import ConnectionManager

    with ConnectionManager(f"--interface serial_tmcl --port {path} --data-rate 115200").connect() as connection:

        def ask() -> None:
            connection.get_axis_parameter(1, 0, signed=True)

        return rate(ask, seconds)


def raw_gaps_per_s(path: str | os.PathLike[str], seconds: float) -> float:
    """The same with nothing but `os.write` and `os.read`: as fast as Python can ask."""
    descriptor = os.open(path, os.O_RDWR | os.O_NOCTTY)
    write, read = os.write, os.read

    def ask() -> None:
        write(descriptor, GAP_ACTUAL_POSITION)
        got = len(read(descriptor, 9))
        while got < 9:
            got += len(read(descriptor, 9 - got))

    try:
        return rate(ask, seconds)
    finally:
        os.close(descriptor)


def rate(ask: Callable[[], object], seconds: float) -> float:
    """How often a second `ask` can be called, over `seconds` [s]."""
    ask()
    count, start_s = 0, time.perf_counter()
    while (took_s := time.perf_counter() - start_s) < seconds:
        for _ in range(BATCH):
            ask()
        count += BATCH
    return count / took_s


def main() -> None:
    """Print both, without and with a modelled wire."""
    for flags in ((), ("--baud", "115200")):
        with emulated_pty(*flags) as process:
            assert process.pty is not None
            rates = [(raw_gaps_per_s(process.pty, 1.0), pytrinamic_gaps_per_s(process.pty, 1.0)) for _ in range(3)]
        for raw, peer in rates:
            print(f"{' '.join(flags) or 'no wire time':14} raw {raw:8.0f}/s  PyTrinamic {peer:8.0f}/s", file=sys.stdout)


if __name__ == "__main__":
    main()
