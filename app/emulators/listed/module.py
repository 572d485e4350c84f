"""A plain emulated module: every parameter of its table holds what was written, and TMCL moves its axes.

Nothing here knows what a parameter does, but for those of TMCL's standard meaning: target, position, speeds and
acceleration. Their numbers are taken for counts, counts/s and counts/s^2. After power-on everything is 0, but for speed
and acceleration, with which it can move.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping

from ...clock import Clock
from ...links.tmcl import FRAME_BYTES, Reply, Request, checksum
from ...registers.entry import Model
from ...registers.listed.modules import role_of
from ...registers.model import Register, Space
from ...registers.tmcl.commands import Opcode, Status
from ..core.noise import cut, flip
from .axis import Axis
from .options import PLAIN, ListedOptions, ListedState
from .plain_emulator import ACCELERATION, SPEED, PlainEmulatorBase

HOST = 2
"""Whom a module answers as it comes (global parameter 76)."""
FIRMWARE = 0x0100
"""What it calls its version: 1.00."""
ABS, REL = 0, 1
STATUS = 2
_SPACES = {0: Space.GLOBAL_0, 2: Space.GLOBAL_2, 3: Space.GLOBAL_3}
_PORTS = {0: Space.DIGITAL_IN, 1: Space.ANALOG_IN, 2: Space.OUTPUT}
"""By the bank of SIO and GIO."""

Key = tuple[Space, int, int]
"""Space, axis, number."""


class Refused(Exception):
    """A command that is answered with a status of an error."""

    def __init__(self, status: Status) -> None:
        super().__init__(status)
        self.status = status


class ListedModule(PlainEmulatorBase):
    """Frames of nine bytes in and out, at its own clock's time; safe to use from several threads."""

    reply_pause_s = 0.0

    def __init__(self, model: Model, clock: Clock, options: ListedOptions) -> None:
        super().__init__(model, clock, options)
        self._rows: Mapping[Key, Register] = {
            (row.space, row.axis or 0, row.address): row
            for row in reversed(model.table.registers)  # of several names of one number the first counts
            if row.space is not Space.AXIS or row.address not in options.unknown_parameters
        }
        self._roles = {key: role_of(row) for key, row in self._rows.items()}
        self._stored: dict[Key, int] = {}
        self._held: dict[Key, int] = {}
        self._power_on()

    # --- frames ----------------------------------------------------------------------------------

    def receive(self, frame: bytes, at_s: float | None = None) -> bytes | None:
        """Obey one frame at module time `at_s` [s], by default now; None where there is no answer: another address.

        Raises ValueError for a frame of another length.
        """
        if len(frame) != FRAME_BYTES:
            raise ValueError(f"a TMCL frame has {FRAME_BYTES} bytes, not {len(frame)}")
        with self._lock:
            self._run_until(at_s)
            if frame[0] != self.options.address:
                return None
            if frame[8] != checksum(frame[:8]):
                return self._reply(Status.WRONG_CHECKSUM, 0)
            request = Request.decode(frame)
            if request.opcode == Opcode.GET_VERSION and request.type == 0:
                return bytes((HOST,)) + f"{self._number:04d}V100".encode("ascii")[:8]
            try:
                return self._reply(Status.OK, request.opcode, self._obey(request))
            except Refused as refused:
                return self._reply(refused.status, request.opcode)

    def unsolicited(self, at_s: float | None = None) -> list[tuple[float, bytes]]:
        """It sends nothing unasked."""
        del at_s
        return []

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        """`receive` for a port in the same process, faults included.

        Raises ValueError for a frame of another length, ConnectionError while unplugged, and TimeoutError where no
        answer comes.
        """
        self.faults.require_plugged(self.model)
        reply = self.receive(frame, at_s)
        if reply is None:
            raise TimeoutError(f"emulated {self.model} does not answer this")
        if self.faults.silence or self.faults.late_reply_s:
            raise TimeoutError(f"emulated {self.model} is silent")
        return cut(flip(reply, self.faults.bit_error_rate, self._noise), self.faults.half_frame_rate, self._noise)

    def _reply(self, status: Status, opcode: int, value: int = 0) -> bytes:
        return Reply(HOST, self.options.address, status, opcode, value).encode()

    @property
    def _number(self) -> int:
        """What it calls itself: the digits of its title, as the maker's modules do."""
        digits = re.search(r"\d+", self._model.title)
        return 0 if digits is None else int(digits[0][:4])

    # --- commands --------------------------------------------------------------------------------

    def _obey(self, request: Request) -> int:
        """The value of the answer. Raises Refused."""
        command = self._commands.get(request.opcode)
        if command is None:
            raise Refused(Status.INVALID_COMMAND)
        return command(self, request)

    def _ror(self, request: Request) -> int:
        self._axis(request).turn(request.value)
        return request.value

    def _rol(self, request: Request) -> int:
        self._axis(request).turn(-request.value)
        return request.value

    def _mst(self, request: Request) -> int:
        self._axis(request).turn(0)
        return 0

    def _mvp(self, request: Request) -> int:
        axis = self._axis(request)
        if request.type not in (ABS, REL):
            raise Refused(Status.WRONG_TYPE)
        target = request.value + (axis.counter if request.type == REL else 0)
        if not -(1 << 31) <= target < 1 << 31:
            raise Refused(Status.INVALID_VALUE)
        axis.go_to(target)
        return target

    def _sap(self, request: Request) -> int:
        self._put(self._axis_key(request), request.value)
        return request.value

    def _gap(self, request: Request) -> int:
        return self._get(self._axis_key(request))

    def _stap(self, request: Request) -> int:
        key = self._axis_key(request)
        self._stored[key] = self._get(key)
        return 0

    def _rsap(self, request: Request) -> int:
        key = self._axis_key(request)
        if key in self._stored:
            self._put(key, self._stored[key])
        return self._get(key)

    def _sgp(self, request: Request) -> int:
        self._put(self._global_key(request), request.value)
        return request.value

    def _ggp(self, request: Request) -> int:
        return self._get(self._global_key(request))

    def _stgp(self, request: Request) -> int:
        key = self._global_key(request)
        self._stored[key] = self._get(key)
        return 0

    def _rsgp(self, request: Request) -> int:
        key = self._global_key(request)
        if key in self._stored:
            self._put(key, self._stored[key])
        return self._get(key)

    def _sio(self, request: Request) -> int:
        self._put(self._port_key(request), request.value)
        return request.value

    def _gio(self, request: Request) -> int:
        return self._get(self._port_key(request))

    def _rfs(self, request: Request) -> int:
        """No search runs, and none can be started."""
        self._axis(request)
        if request.type != STATUS:
            raise Refused(Status.NOT_AVAILABLE)
        return 0

    def _version(self, request: Request) -> int:
        if request.type != 1:
            raise Refused(Status.WRONG_TYPE)
        return self._number << 16 | FIRMWARE

    _commands: Mapping[int, Callable[[ListedModule, Request], int]] = {
        Opcode.ROR: _ror,
        Opcode.ROL: _rol,
        Opcode.MST: _mst,
        Opcode.MVP: _mvp,
        Opcode.SAP: _sap,
        Opcode.GAP: _gap,
        Opcode.STAP: _stap,
        Opcode.RSAP: _rsap,
        Opcode.SGP: _sgp,
        Opcode.GGP: _ggp,
        Opcode.STGP: _stgp,
        Opcode.RSGP: _rsgp,
        Opcode.RFS: _rfs,
        Opcode.SIO: _sio,
        Opcode.GIO: _gio,
        Opcode.GET_VERSION: _version,
    }

    # --- parameters ------------------------------------------------------------------------------

    def _axis(self, request: Request) -> Axis:
        """Raises Refused for a motor that it has not."""
        if request.motor >= len(self._axes):
            raise Refused(Status.INVALID_VALUE)
        return self._axes[request.motor]

    def _axis_key(self, request: Request) -> Key:
        """Of numbers from 256 on the upper bits are in the upper half of the motor byte (PyTrinamic)."""
        axis, number = request.motor & 0xF, request.type | request.motor >> 4 << 8
        if axis >= len(self._axes):
            raise Refused(Status.INVALID_VALUE)
        return self._known((Space.AXIS, axis, number))

    def _global_key(self, request: Request) -> Key:
        space = _SPACES.get(request.motor)
        if space is None:
            raise Refused(Status.INVALID_VALUE)
        return self._known((space, 0, request.type))

    def _port_key(self, request: Request) -> Key:
        space = _PORTS.get(request.motor)
        if space is None:
            raise Refused(Status.INVALID_VALUE)
        return self._known((space, 0, request.type))

    def _known(self, key: Key) -> Key:
        if key not in self._rows:
            raise Refused(Status.WRONG_TYPE)
        return key

    def _put(self, key: Key, value: int) -> None:
        row = self._rows[key]
        if not row.access.writable:
            raise Refused(Status.NOT_AVAILABLE)
        if not row.minimum <= value <= row.maximum:
            raise Refused(Status.INVALID_VALUE)
        role, axis = self._roles[key], self._axes[key[1]]
        if role in ("max_speed", "max_acceleration") and value < 0:
            raise Refused(Status.INVALID_VALUE)
        self._held[key] = value
        match role:
            case "target_position":
                axis.go_to(value)
            case "position":
                axis.set_position(value)
            case "target_speed":
                axis.turn(value)
            case "max_speed":
                axis.max_speed = value
            case "max_acceleration":
                axis.acceleration = value

    def _get(self, key: Key) -> int:
        axis = self._axes[key[1]]
        match self._roles[key]:
            case "target_position":
                return axis.target
            case "position":
                return axis.counter
            case "target_speed":
                return axis.target_speed
            case "speed":
                return round(axis.speed)
            case "position_reached":
                return int(axis.reached)
        return self._held.get(key, 0)

    def _power_on(self) -> None:
        self._held = {}
        self._axes = [Axis() for _ in range(self._model.axes)]
        for key, role in self._roles.items():
            if role in ("max_speed", "max_acceleration"):
                self._put(key, SPEED if role == "max_speed" else ACCELERATION)
        for key, value in self._stored.items():
            if self._roles[key] not in ("target_position", "position", "target_speed"):
                self._put(key, value)

    # --- plant ----------------------------------------------------------------------------------

    def _describe(self) -> ListedState:
        return self._told(PLAIN, self.options.address)
