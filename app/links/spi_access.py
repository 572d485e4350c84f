"""Registers behind datagrams of a told format, or whose upper bits say a register, as `RegisterAccess`."""

from __future__ import annotations

from collections.abc import Sequence

from ..errors import BadReply, WrongState
from ..registers.spi_format import SpiFormat, TaggedFormat
from .spi_datagram import Request, data_of, decode, encode


class SpiAccess:
    """Datagrams of `form`. `name` names the link in errors, `fetch_address` is read to end a chain."""

    def __init__(self, form: SpiFormat, name: str = "spi", fetch_address: int = 0) -> None:
        self.form = form
        self.name = name
        self._later = form.answer == "next"
        self._fetch = (encode(form, Request(fetch_address, write=False)),) if self._later else ()

    @property
    def frame_bytes(self) -> int:
        return self.form.frame_bytes

    @property
    def reply_bytes(self) -> int:
        return self.form.frame_bytes

    def read_frames(self, addresses: Sequence[int]) -> tuple[bytes, ...]:
        frames = [encode(self.form, Request(address, write=False)) for address in addresses]
        return (*frames, *self._fetch) if frames else ()

    def words(self, replies: Sequence[bytes]) -> list[int]:
        for reply in replies:
            self._check_length(reply)
        return [data_of(self.form, reply) for reply in (replies[1:] if self._later else replies)]

    def status(self, replies: Sequence[bytes]) -> int | None:
        if not replies:
            return None
        self._check_length(replies[-1])
        return replies[-1][0]

    def write_frame(self, address: int, data: int) -> bytes:
        return encode(self.form, Request(address, write=True, data=data))

    def write_frames(self, writes: Sequence[tuple[int, int]]) -> tuple[bytes, ...]:
        return (*(self.write_frame(address, data) for address, data in writes), *self._fetch) if writes else ()

    def is_read(self, frame: bytes) -> bool:
        return not decode(self.form, frame).write

    def check(self, frame: bytes, reply: bytes) -> None:
        del frame  # whether what was written comes back is not told of every chip: reading it back tells
        self._check_length(reply)

    def check_all(self, frames: Sequence[bytes], replies: Sequence[bytes]) -> None:
        check_count(self.name, frames, replies)
        for reply in replies:
            self._check_length(reply)

    def _check_length(self, reply: bytes) -> None:
        if len(reply) != self.form.frame_bytes:
            raise BadReply(self.name, f"{len(reply)} bytes instead of {self.form.frame_bytes}", reply)


HIDDEN = 1
"""Lowest bit of a frame longer than its datagram: a controller in between shows the flags of the answer alone."""


class TaggedAccess:
    """Datagrams of 20 bits. A status is read by two of them: one that selects it, and one that puts the selection back
    and is answered by it. So nothing is read before the selecting register was written over this connection: until
    then nobody knows what else it holds, and every datagram writes."""

    def __init__(self, form: TaggedFormat, name: str = "spi") -> None:
        self.form = form
        self.name = name
        self._selecting: int | None = None
        """The latest datagram of the selecting register that went out."""

    @property
    def ready(self) -> bool:
        """Whether a status can be read: what the selecting register holds is known."""
        return self._selecting is not None

    @property
    def frame_bytes(self) -> int:
        return self.form.frame_bytes

    @property
    def reply_bytes(self) -> int:
        return self.form.frame_bytes

    def read_frames(self, addresses: Sequence[int]) -> tuple[bytes, ...]:
        frames: list[bytes] = []
        mask = (1 << self.form.select_bits) - 1 << self.form.select_lsb
        for address in addresses:
            if self.form.is_written(address):
                raise ValueError(f"what was written to {address:#x} cannot be read")
            if self._selecting is None:
                raise WrongState(
                    "no status can be read yet: each datagram of this chip writes, and what its selecting register "
                    "holds is not known",
                    f"write register {self.form.selecting:#x} once",
                )
            selected = self._selecting & ~mask | address << self.form.select_lsb
            frames += [self._frame(selected), self._frame(self._selecting)]
        return tuple(frames)

    def words(self, replies: Sequence[bytes]) -> list[int]:
        """Raises WrongState where a controller in between shows the flags of an answer alone."""
        found = self.words_or_flags(replies)
        if not all(self.known(replies)):
            raise WrongState(
                "the controller does not show all of this driver's answer, but its flags alone",
                "have fewer bits behind it in the chain, or look at the flags",
            )
        return found

    def words_or_flags(self, replies: Sequence[bytes]) -> list[int]:
        """The same, with 0 for what a controller in between does not show."""
        for reply in replies:
            self._check_length(reply)
        return [self._word(reply) for reply in replies[1::2]]

    def known(self, replies: Sequence[bytes]) -> list[bool]:
        """Of each word whether all of it was shown: the bits behind it are 0 on a wire, and 1 where some are hidden."""
        return [not reply[-1] & HIDDEN for reply in replies[1::2]]

    def status(self, replies: Sequence[bytes]) -> int | None:
        if not replies:
            return None
        self._check_length(replies[-1])
        return self._word(replies[-1]) & 0xFF

    def write_frame(self, address: int, data: int) -> bytes:
        if not self.form.is_written(address):
            raise ValueError(f"a status cannot be written: {address:#x}")
        if not 0 <= data < 1 << self.form.width_of(address):
            raise ValueError(f"data is {self.form.width_of(address)} bits, not {data:#x}")
        return self._frame(self.form.tag_of(address) | data)

    def write_frames(self, writes: Sequence[tuple[int, int]]) -> tuple[bytes, ...]:
        return tuple(self.write_frame(address, data) for address, data in writes)

    def is_read(self, frame: bytes) -> bool:
        del frame
        return False

    def check(self, frame: bytes, reply: bytes) -> None:
        self._check_length(reply)
        self._heed(frame)

    def check_all(self, frames: Sequence[bytes], replies: Sequence[bytes]) -> None:
        check_count(self.name, frames, replies)
        for frame, reply in zip(frames, replies, strict=True):
            self.check(frame, reply)

    def on_state(self, state: str, problem: Exception | None) -> None:
        """`Session.state_hooks`: where the link failed, it may be another chip, or this one after a reset."""
        del problem
        if state == "failed":
            self._selecting = None

    def _heed(self, frame: bytes) -> None:
        datagram = int.from_bytes(frame, "big")
        if self.form.address_of(datagram) == self.form.selecting:
            self._selecting = datagram

    def _frame(self, datagram: int) -> bytes:
        return datagram.to_bytes(self.form.frame_bytes, "big")

    def _word(self, reply: bytes) -> int:
        return int.from_bytes(reply, "big") >> 8 * self.form.frame_bytes - self.form.word_bits

    def _check_length(self, reply: bytes) -> None:
        if len(reply) != self.form.frame_bytes:
            raise BadReply(self.name, f"{len(reply)} bytes instead of {self.form.frame_bytes}", reply)


def check_count(name: str, frames: Sequence[bytes], replies: Sequence[bytes]) -> None:
    """Raises BadReply where not every frame has a reply."""
    if len(frames) != len(replies):
        raise BadReply(name, f"{len(replies)} replies to {len(frames)} frames", b"".join(replies))
