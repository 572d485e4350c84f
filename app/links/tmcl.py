"""The nine-byte frame of TMCL, both ways: pure functions, no port.

To the module (FM-PD42-1241 3.1): address, command, type, motor or bank, four bytes of value, checksum. From
the module (FM-PD42-1241 3.2): host address, module address, status, command, four bytes of value, checksum.
Values are signed, most significant byte first. The checksum is the sum of the eight bytes before
it, modulo 256 (FM-PD42-1241 3.1.1). Two answers are otherwise: the version as a string (command 136, type 0)
and program memory (command 134) fill bytes 1..8 with data and have no checksum.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

from ..errors import BadReply
from ..registers.tmcl.commands import COORDINATES_IN_EEPROM, EXTENDED_ERRORS, STATUS_TEXTS, Opcode, Status

FRAME_BYTES = 9
RFS_STOP = 1
_BODY = struct.Struct(">BBBBi")
VALUE_MIN, VALUE_MAX = -(1 << 31), (1 << 31) - 1


def checksum(body: bytes) -> int:
    """The last byte of a frame, from the eight before it (FM-PD42-1241 3.1.1)."""
    return sum(body) & 0xFF


def as_value(number: int) -> int:
    """A number of -2^31..2^32-1 as the signed 32 bits of the wire. Raises ValueError outside."""
    if not VALUE_MIN <= number < 1 << 32:
        raise ValueError(f"a TMCL value has 32 bits: {VALUE_MIN}..{(1 << 32) - 1}, not {number}")
    return number - (1 << 32) if number > VALUE_MAX else number


@dataclass(frozen=True, slots=True)
class Request:
    """One command. `motor` is the motor, or the bank of a global parameter or port; `value` signed 32 bits."""

    address: int
    opcode: int
    type: int = 0
    motor: int = 0
    value: int = 0

    def encode(self) -> bytes:
        """Raises ValueError for a number that its bytes cannot hold."""
        for name, number in (("address", self.address), ("command", self.opcode), ("type", self.type)):
            _check_byte(name, number)
        _check_byte("motor or bank", self.motor)
        body = _BODY.pack(self.address, self.opcode, self.type, self.motor, as_value(self.value))
        return body + bytes((checksum(body),))

    @classmethod
    def decode(cls, frame: bytes) -> Request:
        """Raises ValueError unless the frame is 9 bytes long; whether its checksum is right, `sound` tells."""
        return cls(*_BODY.unpack(_nine(frame)[:-1]))


@dataclass(frozen=True, slots=True)
class Reply:
    """One answer. `opcode` is the command's, `status` 100 where all went well (FM-PD42-1241 3.2.1)."""

    host: int
    module: int
    status: int
    opcode: int
    value: int = 0

    def encode(self) -> bytes:
        """Raises ValueError for a number that its bytes cannot hold."""
        for name, number in (("host", self.host), ("module", self.module), ("status", self.status)):
            _check_byte(name, number)
        _check_byte("command", self.opcode)
        body = _BODY.pack(self.host, self.module, self.status, self.opcode, as_value(self.value))
        return body + bytes((checksum(body),))

    @classmethod
    def decode(cls, frame: bytes) -> Reply:
        """Raises ValueError unless the frame is 9 bytes long; whether its checksum is right, `sound` tells."""
        return cls(*_BODY.unpack(_nine(frame)[:-1]))

    @property
    def ok(self) -> bool:
        """Done, or stored in program memory."""
        return self.status in (Status.OK, Status.STORED)

    @property
    def status_text(self) -> str:
        """The status in words."""
        return STATUS_TEXTS.get(self.status, f"unknown status {self.status}")


def sound(frame: bytes) -> bool:
    """Nine bytes, of which the last is the checksum."""
    return len(frame) == FRAME_BYTES and frame[8] == sum(frame[:8]) & 0xFF


def has_plain_reply(request: bytes) -> bool:
    """Whether the answer to `request` has status, command and checksum; those of 134 and 136 type 0 have not."""
    return not (request[1] == Opcode.READ_MEMORY or (request[1] == Opcode.GET_VERSION and request[2] == 0))


def has_reply(request: bytes) -> bool:
    """Whether `request` is answered at all (FM-PD42-1241 3.6.36): factory settings are not, a reset may be."""
    return request[1] not in (Opcode.FACTORY_DEFAULT, Opcode.RESET_MODULE, Opcode.BOOT)


def is_event(frame: bytes) -> bool:
    """Whether `frame` is the position reached event (FM-PD42-1241 3.6.35), which nobody asks for at that moment."""
    return len(frame) == FRAME_BYTES and frame[2] == Status.EVENT and frame[3] == Opcode.REQUEST_EVENT and sound(frame)


def check_reply(link: str, request: bytes, reply: bytes) -> Reply:
    """The answer to `request`, or what must not be taken for it.

    `link` names the link in errors. An answer that bears an error status is a good answer. Of the
    answers without checksum only the length can be checked; they come back with status 100 and the
    last four bytes as value.

    Raises BadReply: wrong length, checksum, module or command.
    """
    if len(reply) != FRAME_BYTES:
        raise BadReply(link, f"{len(reply)} bytes instead of {FRAME_BYTES}", reply)
    if not has_plain_reply(request):
        # Too short a wait or an error gives a plain reply even here: that one can be told by its checksum.
        if sound(reply) and reply[3] == request[1] and reply[1] == request[0]:
            return Reply.decode(reply)
        return Reply(reply[0], request[0], Status.OK, request[1], struct.unpack(">i", reply[5:])[0])
    if reply[8] != sum(reply[:8]) & 0xFF:
        raise BadReply(link, f"checksum {reply[8]:#04x} instead of {checksum(reply[:8]):#04x}", reply)
    answer = Reply.decode(reply)
    if answer.module != request[0]:
        raise BadReply(link, f"module {answer.module} answered instead of {request[0]}", reply)
    if answer.status == Status.WRONG_CHECKSUM:  # the module could not read the command, so it need not name it
        return answer
    if answer.opcode != request[1]:
        raise BadReply(link, f"an answer to command {answer.opcode} instead of {request[1]}", reply)
    return answer


def version_string(reply: bytes) -> str:
    """The eight characters of the answer to command 136 type 0, e.g. `1241V144`. Raises ValueError unless 9 bytes."""
    return _nine(reply)[1:].decode("ascii", "replace")


def module_version(value: int) -> tuple[int, str]:
    """Module number and version, e.g. (1241, "1.44"), of the answer to command 136 type 1."""
    raw = value & 0xFFFF_FFFF
    return raw >> 16, f"{raw >> 8 & 0xFF}.{raw & 0xFF:02d}"


def stops(request: bytes) -> bool:
    """Whether `request` ends a motion: MST, RFS STOP without which a search goes on after MST, and 133, without which
    a module in download mode stores both of them instead."""
    opcode = request[1]
    return opcode in (Opcode.MST, Opcode.EXIT_DOWNLOAD) or (opcode == Opcode.RFS and request[2] == RFS_STOP)


def is_retriable(request: bytes) -> bool:
    """Whether asking twice cannot matter: commands that read, and neither move nor change anything.

    Not GAP 207, which clears the flags it tells; not GCO with motor 255, which restores coordinates.
    """
    opcode, type_, motor = request[1], request[2], request[3]
    if opcode == Opcode.GAP:
        return type_ != EXTENDED_ERRORS
    if opcode == Opcode.RFS:
        return type_ == 2
    if opcode == Opcode.GCO:
        return motor != COORDINATES_IN_EEPROM
    return opcode in (Opcode.GGP, Opcode.GIO, Opcode.READ_MEMORY, Opcode.GET_STATUS, Opcode.GET_VERSION)


def _check_byte(name: str, number: int) -> None:
    if not 0 <= number <= 0xFF:
        raise ValueError(f"{name} is one byte, 0..255, not {number}")


def _nine(frame: bytes) -> bytes:
    if len(frame) != FRAME_BYTES:
        raise ValueError(f"a TMCL frame has {FRAME_BYTES} bytes, not {len(frame)}")
    return frame
