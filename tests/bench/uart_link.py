"""Our UART link: register reads a second against PyTrinamic's UART class and a raw loop on the same pty.

The chip is a process of its own, `stepscope emulate tmc5160 --pty` as a user starts it. PyTrinamic's class sends and
receives bytes and checks nothing; ours checks register, length and CRC of every answer. Nobody pipelines: a chip on a
single wire could not follow. So no client can be faster than the raw loop, which does nothing but `os.write` and
`os.read`; its figure says how much of the time is the emulator's and the kernel's.

Twice PyTrinamic was asked for. How far anybody can come is measured too, by the raw loop and PyTrinamic before a far
end that does no work at all: what is left then is the pseudo terminal's, whose bytes take two switches of the kernel's
threads each way. Where even that is below 2, the figure is out of reach, and ours is held to the raw loop.
"""

from __future__ import annotations

import asyncio
import contextlib
import os
import statistics
import subprocess
import sys
import tempfile
import time
import tty
from collections.abc import Iterator, Sequence
from pathlib import Path

from app.links.datagram_uart import UartForm
from app.links.queue import LinkQueue
from app.links.register_access import UartAccess
from app.links.uart_line import uart_port
from tests.bench.table import Row
from tests.bench.tmcl_peer import rate
from tests.peers.emulator_process import emulator

PYTRINAMIC_RATIO = 2.0
RAW_RATIO = 0.8
BAUD = 115_200
BATCH = 200
PATIENCE_S = 5.0
"""The emulator is a process, and this machine may have others to run."""
FORM = UartForm(0)
XACTUAL = 0x21
READ = FORM.read(XACTUAL)
ANSWER_AT_ONCE = """
import os, sys
near, reply = int(sys.argv[1]), bytes.fromhex(sys.argv[2])
while True:
    os.read(near, 64)
    os.write(near, reply)
"""


def measure(quick: bool) -> Sequence[Row]:
    bound = reach(*((0.5, 3) if quick else (2.0, 9)))
    return [row for echo in (False, True) for row in _reads(echo=echo, quick=quick, bound=bound)]


def reach(seconds: float, rounds: int) -> float:
    """How many times as fast as PyTrinamic the raw loop is where the peer answers without any work."""
    near, far = os.openpty()
    tty.setraw(far)
    path = Path(os.ttyname(far))
    idle = subprocess.Popen(
        [sys.executable, "-c", ANSWER_AT_ONCE, str(near), FORM.reply(XACTUAL, 0).hex()], pass_fds=[near]
    )
    try:
        ratios = [
            raw_reads_per_s(path, seconds, echo=False) / pytrinamic_reads_per_s(path, seconds, echo=False)
            for _ in range(rounds)
        ]
    finally:
        idle.kill()
        idle.wait()
        os.close(near)
        os.close(far)
    return statistics.median(ratios)


@contextlib.contextmanager
def emulated_uart(*flags: str) -> Iterator[Path]:
    """A chip of its own on a pty of its own; `flags` as of `stepscope emulate`."""
    with tempfile.TemporaryDirectory(prefix="stepscope-") as folder:
        path = Path(folder) / "uart"
        with emulator(*flags, pty=path, model="tmc5160"):
            yield path


def _reads(*, echo: bool, quick: bool, bound: float) -> list[Row]:
    seconds, rounds = (0.5, 3) if quick else (2.0, 9)
    ours, alone, raw, theirs = [], [], [], []
    with emulated_uart(*(["--echo"] if echo else [])) as path:
        # In turns, so that what else the machine does falls on all.
        for _ in range(rounds):
            raw.append(raw_reads_per_s(path, seconds, echo=echo))
            ours.append(asyncio.run(our_reads_per_s(path, seconds, BATCH)))
            theirs.append(pytrinamic_reads_per_s(path, seconds, echo=echo))
            alone.append(asyncio.run(our_reads_per_s(path, seconds, 1)))
    median = statistics.median
    to_peer = median(a / b for a, b in zip(ours, theirs, strict=True))
    to_raw = median(a / b for a, b in zip(ours, raw, strict=True))
    raw_to_peer = median(a / b for a, b in zip(raw, theirs, strict=True))
    where = "one wire with an echo" if echo else "two wires"
    notes = (
        f"one awaited reading at a time: {median(alone):,.0f}/s",
        f"the raw loop is at {raw_to_peer:.2f} of PyTrinamic, at {bound:.2f} before a peer that does no work",
    )
    return [
        Row(
            what=f"UART register reads, {where}, in batches",
            measured=f"{median(ours):,.0f}/s",
            peer=f"PyTrinamic {median(theirs):,.0f}/s",
            ratio=to_peer,
            required=f">= {PYTRINAMIC_RATIO:g}" + (f", in reach {bound:.2f}" if bound < PYTRINAMIC_RATIO else ""),
            ok=to_peer >= PYTRINAMIC_RATIO or (bound < PYTRINAMIC_RATIO and to_raw >= RAW_RATIO and to_peer > 1),
            notes=notes,
        ),
        Row(
            what="the same against the system calls",
            measured=f"{median(ours):,.0f}/s",
            peer=f"os.write and os.read {median(raw):,.0f}/s",
            ratio=to_raw,
            required=f">= {RAW_RATIO:g}",
            ok=to_raw >= RAW_RATIO,
        ),
    ]


async def our_reads_per_s(path: Path, seconds: float, batch: int) -> float:
    """Words a second, each checked."""
    access = UartAccess(form=FORM)
    port = uart_port(str(path), FORM, baud=BAUD, timeout_s=PATIENCE_S)
    queue = LinkQueue(port)
    frames = access.read_frames([XACTUAL] * batch)
    await queue.exchange_many(frames)
    count, start_s = 0, time.perf_counter()
    while (took_s := time.perf_counter() - start_s) < seconds:
        for _ in range(1 if batch > 1 else 50):  # between two looks at the clock, as the peers do
            await queue.exchange_many(frames)
            count += batch
    await port.aclose()
    return count / took_s


def pytrinamic_reads_per_s(path: Path, seconds: float, *, echo: bool) -> float:
    """Answers a second that PyTrinamic's UART class gets, unchecked; with an echo it reads that too."""
    from pytrinamic.connections import UartIcInterface

    due = FORM.reply_bytes + (len(READ) if echo else 0)
    with UartIcInterface(str(path), BAUD, PATIENCE_S) as interface:
        return rate(lambda: interface.send_datagram(READ, due), seconds)


def raw_reads_per_s(path: Path, seconds: float, *, echo: bool) -> float:
    """The same with nothing but `os.write` and `os.read`: as fast as Python can ask."""
    due = FORM.reply_bytes + (len(READ) if echo else 0)
    descriptor = os.open(path, os.O_RDWR | os.O_NOCTTY)
    write, read = os.write, os.read

    def ask() -> None:
        write(descriptor, READ)
        got = len(read(descriptor, due))
        while got < due:
            got += len(read(descriptor, due - got))

    try:
        return rate(ask, seconds)
    finally:
        os.close(descriptor)


def main() -> None:
    from tests.bench.table import render

    print(render(measure(True)))


if __name__ == "__main__":
    main()
