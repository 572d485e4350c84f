"""A chip at an SPI bus of this machine, by Linux's spidev: `/dev/spidev0.0` and so on.

The kernel's calls block, so each port has a thread; chip select goes up between two frames. Where the
module or the device is not there, opening says what to do. SPI has no acknowledge: a chip without power
reads as zeros or ones, and only registers can tell (a driver reads the version first).
"""

from __future__ import annotations

import asyncio
import errno
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from typing import Protocol, cast

from ..clock import Clock, WallClock
from ..errors import BadReply, LinkDown
from . import datagram40
from .port import PortTraits

SPEED_HZ = 1_000_000
"""What all chips allow: half of their clock (DS-TMC4361 5.3), a quarter in later revisions, an eighth of those with
32-bit datagrams (DS-TMC428 6.2)."""
MODE = 3
"""Clock idles high; data are taken over on its rising edge (DS-TMC4361 5.2)."""


class SpiDevice(Protocol):
    """What we use of `spidev.SpiDev`."""

    max_speed_hz: int
    mode: int
    bits_per_word: int

    def open(self, bus: int, device: int) -> None: ...
    def xfer2(self, values: list[int]) -> list[int]: ...
    def close(self) -> None: ...


class SpidevPort:
    """`ChainPort` of one chip select; opened when it is first needed. `make` makes the device, by default spidev's."""

    def __init__(
        self,
        bus: int,
        device: int,
        *,
        frame_bytes: int,
        speed_hz: int = SPEED_HZ,
        mode: int = MODE,
        pipelined: bool = True,
        clock: Clock | None = None,
        make: Callable[[], SpiDevice] | None = None,
    ) -> None:
        self.bus = bus
        self.device = device
        self.frame_bytes = frame_bytes
        self.speed_hz = speed_hz
        self.mode = mode
        cuts = pipelined and frame_bytes == datagram40.FRAME_BYTES
        self.traits = PortTraits(chains=self if pipelined else None, cuts=cuts)
        self._lengths = (datagram40.STATUS_BYTES, frame_bytes) if cuts else (frame_bytes,)
        self._clock = clock or WallClock()
        self._last_exchange_s = self._clock.now()
        self._make = make or _spidev
        self._spi: SpiDevice | None = None
        self._one_at_a_time = asyncio.Lock()
        # Of its own: whoever keeps the threads that all share must not keep a stop from its chip.
        self._thread: ThreadPoolExecutor | None = None

    @property
    def name(self) -> str:
        return f"spidev {self.bus}.{self.device}"

    @property
    def last_exchange_s(self) -> float:
        return self._last_exchange_s

    def device_time_s(self) -> float:
        return self._clock.now()

    async def exchange(self, frame: bytes, timeout_s: float | None = None) -> bytes:
        """Send a frame, return one. Raises ValueError for another length, else as `FramePort` says."""
        return (await self.exchange_chain((frame,), timeout_s))[0]

    async def exchange_chain(self, frames: Sequence[bytes], timeout_s: float | None = None) -> list[bytes]:
        """As `ChainPort` says. `timeout_s` has no meaning here: the bus has our clock and never waits."""
        for frame in frames:
            if len(frame) not in self._lengths:
                raise ValueError(f"a datagram has {self.frame_bytes} bytes, not {len(frame)}")
        # A cancelled caller's thread goes on to its end: the next one must not talk into it.
        async with self._one_at_a_time:
            if self._thread is None:
                self._thread = ThreadPoolExecutor(1, self.name)
            talking = asyncio.get_running_loop().run_in_executor(self._thread, self._talk, frames)
            try:
                replies = await asyncio.shield(talking)
            except asyncio.CancelledError:
                await asyncio.wait([talking])
                raise
        self._last_exchange_s = self._clock.now()
        return replies

    async def aclose(self) -> None:
        async with self._one_at_a_time:
            self._shut()
            if self._thread is not None:
                self._thread.shutdown(wait=False)  # nothing runs on it now
                self._thread = None

    def _talk(self, frames: Sequence[bytes]) -> list[bytes]:
        spi = self._spi
        if spi is None:
            spi = self._spi = self._open()
        try:
            replies = [bytes(spi.xfer2(list(frame))) for frame in frames]
        except OSError as error:
            self._shut()
            raise LinkDown(self.name, error.strerror or str(error)) from error
        for frame, reply in zip(frames, replies, strict=True):
            if len(reply) != len(frame):
                raise BadReply(self.name, f"{len(reply)} bytes instead of {len(frame)}", reply)
        return replies

    def _open(self) -> SpiDevice:
        try:
            spi = self._make()
        except ImportError as error:
            raise LinkDown(self.name, "the module spidev is not there: pip install 'stepscope[spidev]'") from error
        try:
            spi.open(self.bus, self.device)
            spi.max_speed_hz = self.speed_hz
            spi.mode = self.mode
            spi.bits_per_word = 8
        except OSError as error:
            spi.close()
            raise LinkDown(self.name, _why(error, self.bus, self.device)) from error
        return spi

    def _shut(self) -> None:
        spi, self._spi = self._spi, None
        if spi is not None:
            spi.close()


def _spidev() -> SpiDevice:
    import spidev  # optional, and only Linux has it

    return cast("SpiDevice", spidev.SpiDev())


def _why(error: OSError, bus: int, device: int) -> str:
    path = f"/dev/spidev{bus}.{device}"
    if error.errno in (errno.ENOENT, errno.ENODEV, errno.ENXIO):
        return f"no {path}: is SPI switched on (on a Raspberry Pi: raspi-config, or dtparam=spi=on)?"
    if error.errno in (errno.EACCES, errno.EPERM):
        return f"permission denied for {path}; join its group: sudo usermod -aG spi $USER, then log in again"
    return error.strerror or str(error)
