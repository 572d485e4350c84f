"""Registers of 24 bits behind 4-byte datagrams (TMC428, TMC4210), as a `RegisterAccess`: a frame a register.

Nothing is pipelined: the answer comes with the question, and what was written shows only when it is read.
"""

from __future__ import annotations

from collections.abc import Sequence

from ..errors import BadReply
from . import datagram32

READ_FRAMES = tuple(datagram32.read(address) for address in range(128))
"""Made once: a read of one register costs no encoding."""


class Spi32Access:
    """32-bit datagrams (DS-TMC428 6; DS-TMC4210 5.2.2). `name` names the link in errors."""

    frame_bytes = datagram32.FRAME_BYTES
    reply_bytes = datagram32.FRAME_BYTES

    def __init__(self, name: str = "spi") -> None:
        self.name = name

    def read_frames(self, addresses: Sequence[int]) -> tuple[bytes, ...]:
        return tuple([READ_FRAMES[address] for address in addresses])

    def words(self, replies: Sequence[bytes]) -> list[int]:
        return [int.from_bytes(reply, "big") & datagram32.DATA_MASK for reply in replies]

    def status(self, replies: Sequence[bytes]) -> int | None:
        return replies[-1][0] if replies else None

    def write_frame(self, address: int, data: int) -> bytes:
        return datagram32.write(address, data)

    def write_frames(self, writes: Sequence[tuple[int, int]]) -> tuple[bytes, ...]:
        return tuple(datagram32.write(address, data) for address, data in writes)

    def is_read(self, frame: bytes) -> bool:
        return bool(frame[0] & 1)

    def check(self, frame: bytes, reply: bytes) -> None:
        del frame  # a reply says nothing of what it answers
        if len(reply) != datagram32.FRAME_BYTES:
            raise BadReply(self.name, f"{len(reply)} bytes instead of {datagram32.FRAME_BYTES}", reply)

    def check_all(self, frames: Sequence[bytes], replies: Sequence[bytes]) -> None:
        for frame, reply in zip(frames, replies, strict=True):
            self.check(frame, reply)


SPI32 = Spi32Access()
