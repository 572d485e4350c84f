"""A module on a real pseudo-terminal that answers by a script the test owns: what an emulator never does on its own."""

from __future__ import annotations

import asyncio
import os
import select
import tempfile
import threading
import time
import tty
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from app.links.serial_line import LinePort, serial_port
from app.links.tmcl import Reply, Request, sound
from app.links.tmcl_session import FENCES
from app.registers.tmcl.commands import Opcode, Status

VERSION = 1241 << 16 | 0x012C
Behaviour = Callable[["PtyModule", bytes], bytes]
"""Takes one frame and says what goes back; b"" is silence."""


LONG_S = 10.0
"""Time-out of exchanges that are to be answered: a busy machine is no fault of the line."""
PART_S = 1.0
"""Time-out of those that get a part of an answer, which has to have come by then, and run it out."""


def port_to(module: PtyModule, address: int = 1, baud: int = 9600) -> LinePort:
    """A port that is patient."""
    return serial_port(module.path, baud=baud, address=address, timeout_s=LONG_S)


def gap(number: int, address: int = 1) -> bytes:
    return Request(address, Opcode.GAP, number).encode()


def value_of(number: int, address: int = 1) -> int:
    """What the module below answers to GAP `number`: no two are the same."""
    return (address << 24) + number * 1001 - 70_000


def answer(frame: bytes, status: int = 100) -> bytes:
    """The right answer to `frame`, from a module whose every parameter is `value_of`."""
    request = Request.decode(frame)
    if request.opcode == Opcode.GET_VERSION and request.type == 0:
        return b"\x021241V144"
    value = request.value
    if request.opcode == Opcode.GET_VERSION:
        value = VERSION
    elif request.opcode == Opcode.GAP:
        value = value_of(request.type, request.address)
    return Reply(2, request.address, status, request.opcode, value).encode()


def right(module: PtyModule, frame: bytes) -> bytes:
    return answer(frame) if frame[0] in module.addresses else b""


def silent(module: PtyModule, frame: bytes) -> bytes:
    return b""


def but_version(behave: Behaviour) -> Behaviour:
    """`behave` for all but the question that gets a line in step, which is answered."""

    def mixed(module: PtyModule, frame: bytes) -> bytes:
        return right(module, frame) if frame[1] == Opcode.GET_VERSION else behave(module, frame)

    return mixed


class Gate:
    """A behaviour: right answers, each only when the test lets it through. Versions pass freely."""

    def __init__(self) -> None:
        self._free = threading.Semaphore(0)

    def __call__(self, module: PtyModule, frame: bytes) -> bytes:
        if frame[1] != Opcode.GET_VERSION:
            self._free.acquire(timeout=10)
        return right(module, frame)

    def let_through(self, frames: int = 1) -> None:
        self._free.release(frames)


class PtyModule:
    """`behave` may be changed at any time; `seen` is every frame that came, in order. `path` names it all its life."""

    def __init__(self, behave: Behaviour = right, addresses: tuple[int, ...] = (1,)) -> None:
        self.behave = behave
        self.addresses = addresses
        self.seen: list[bytes] = []
        self._lock = threading.Lock()
        # A name of its own: those of terminals are used again at once, and a line is known by its name.
        self._folder = tempfile.TemporaryDirectory(prefix="stepscope-")
        self.path = f"{self._folder.name}/module"
        self._plugged = False
        self.plug()

    def plug(self) -> None:
        """Be there, on a new terminal."""
        self._master, self._slave = os.openpty()  # ours of both, so that the terminal outlives a closed port
        tty.setraw(self._slave)
        self._end, self._end_write = os.pipe()
        self._thread = threading.Thread(target=self._run, name="pty module", daemon=True)
        self._thread.start()
        os.symlink(os.ttyname(self._slave), self.path)
        self._plugged = True

    def unplug(self) -> None:
        """Take the whole terminal away. A second call does nothing."""
        if not self._plugged:
            return
        os.unlink(self.path)
        os.write(self._end_write, b"!")
        self._thread.join(5)
        with self._lock:
            self._plugged = False
            for fd in (self._slave, self._master, self._end, self._end_write):
                os.close(fd)

    def close(self) -> None:
        """For the end of the test."""
        self.unplug()
        self._folder.cleanup()

    def asked(self) -> list[bytes]:
        """The frames seen, without those that only keep the line in step (but for GAP: that one may be any)."""
        fences = FENCES.keys() - {Opcode.GAP}
        return [frame for frame in self.seen if frame[1] not in fences]

    def size_of(self, received: bytes) -> int:
        """How long the frame is that `received` begins with; 0 where more is needed to say."""
        del received
        return 9

    def refusal(self, frame: bytes) -> bytes:
        """What it says to a frame that came damaged, or cut in two, as modules do; b"" to any other."""
        return b"" if sound(frame) else Reply(2, self.addresses[0], Status.WRONG_CHECKSUM, frame[1]).encode()

    def say(self, data: bytes) -> None:
        """Send bytes now, asked or not."""
        with self._lock:
            if self._plugged:
                os.write(self._master, data)

    def _run(self) -> None:
        received = b""
        while True:
            ready, _, _ = select.select([self._master, self._end], [], [])
            if self._end in ready:
                return
            try:
                received += os.read(self._master, 4096)
            except OSError:
                return
            while (size := self.size_of(received)) and len(received) >= size:
                frame, received = received[:size], received[size:]
                self.seen.append(frame)
                reply = self.refusal(frame) or self.behave(self, frame)
                if reply:
                    self.say(reply)


@contextmanager
def pty_module(behave: Behaviour = right, addresses: tuple[int, ...] = (1,)) -> Iterator[PtyModule]:
    module = PtyModule(behave, addresses)
    try:
        yield module
    finally:
        module.close()


async def until(true: Callable[[], bool], within_s: float = 5.0) -> None:
    """Wait for something that happens in another thread or process. Raises TimeoutError."""
    end_s = time.monotonic() + within_s
    while not true():
        if time.monotonic() > end_s:
            raise TimeoutError
        await asyncio.sleep(0.001)
