"""The smallest module that a line can serve: parameters that it keeps, and one move that ends when it is told to."""

from __future__ import annotations

from dataclasses import dataclass, field

from app.clock import Clock, ScaledClock
from app.links import tmcl
from app.registers.tmcl.commands import Opcode, Status


@dataclass
class Faults:
    silence: bool = False
    late_reply_s: float = 0.0
    bit_error_rate: float = 0.0
    half_frame_rate: float = 0.0
    unplugged: bool = False


@dataclass
class SmallModule:
    """GAP and SAP of 256 parameters, MVP that takes `move_s` [s], events, status 1 and 2, global parameter 75."""

    base: Clock
    address: int = 1
    host: int = 2
    move_s: float = 0.05
    scale: float = 1.0
    faults: Faults = field(default_factory=Faults)
    reply_pause_s: float = 0.0
    heard: list[tuple[float, bytes]] = field(default_factory=list)
    lived_s: float = 0.0

    def __post_init__(self) -> None:
        self.clock = ScaledClock(self.base, self.scale)
        self._parameters = [0] * 256
        self._arrives_s: float | None = None
        self._event: int | None = None

    def receive(self, frame: bytes, at_s: float | None = None) -> bytes | None:
        at_s = self.clock.now() if at_s is None else at_s
        self.heard.append((at_s, frame))
        if frame[0] != self.address:
            return None
        if not tmcl.sound(frame):
            return self._reply(Status.WRONG_CHECKSUM, 0, 0)
        request = tmcl.Request.decode(frame)
        match request.opcode:
            case Opcode.GAP:
                return self._reply(Status.OK, request.opcode, self._parameters[request.type])
            case Opcode.SAP:
                self._parameters[request.type] = request.value
                return self._reply(Status.OK, request.opcode, request.value)
            case Opcode.MVP:
                self._arrives_s = at_s + self.move_s
                return self._reply(Status.OK, request.opcode, request.value)
            case Opcode.REQUEST_EVENT:
                self._event = request.type
                return self._reply(Status.OK, request.opcode, request.value)
            case _:
                return self._reply(Status.INVALID_COMMAND, request.opcode, request.value)

    def unsolicited(self, at_s: float | None = None) -> list[tuple[float, bytes]]:
        at_s = self.clock.now() if at_s is None else at_s
        if self._arrives_s is None or self._arrives_s > at_s or self._event is None:
            return []
        arrived_s, self._arrives_s = self._arrives_s, None
        return [(arrived_s, self._reply(Status.EVENT, Opcode.REQUEST_EVENT, 1))]

    def catch_up(self, slice_s: float) -> bool:
        now_s = self.clock.now()
        self.lived_s = min(now_s, self.lived_s + slice_s)
        return self.lived_s == now_s

    def _reply(self, status: int, opcode: int, value: int) -> bytes:
        return tmcl.Reply(self.host, self.address, status, opcode, value).encode()


def gap(parameter: int = 1, address: int = 1) -> bytes:
    """The question for an axis parameter."""
    return tmcl.Request(address, Opcode.GAP, parameter).encode()


def sap(parameter: int, value: int, address: int = 1) -> bytes:
    return tmcl.Request(address, Opcode.SAP, parameter, 0, value).encode()
