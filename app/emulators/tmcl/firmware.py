"""The module's firmware: frames in, answers out, and what it does by itself (FM-PD42-1241 3).

Open in all sources, and decided here (what is about one command: see `commands`):
- an answer bears the addresses that held when the command came, so a new address begins with the next command;
  whether answers are suppressed (parameter 255) counts from the very command that changes it;
- a frame whose checksum is wrong is answered with command 0 and value 0, for nothing in it can be trusted;
- a heartbeat counts commands over its own interface: parameter 68 those of the serial ones, 82 those over CAN;
- the second CAN identifier (83) is obeyed and never answered, as the second serial address is; 0 is none;
- a CAN message of 8 bytes is a command of 7 with one that means nothing, but for the version as a string.
"""

from __future__ import annotations

import struct
from collections.abc import Collection

from ...links.tmcl import has_plain_reply
from ...registers.tmcl.commands import CONTROL_FIRST, Opcode, Status
from ..drive import Drive
from ..line.can_message import CanMessage
from .application import Application, wrapped
from .axis import Axis
from .commands import MOTOR_BITS, Commands, NoAnswer, Special
from .coordinates import Coordinates
from .eeprom import Eeprom
from .global_parameters import (
    ADDRESS,
    AUTOSTART,
    CAN_HEARTBEAT,
    CAN_RECEIVE,
    CAN_SECONDARY,
    CAN_SEND,
    HEARTBEAT,
    HOST,
    PAUSE,
    SECONDARY,
    GlobalParameters,
)
from .interpreter import Interpreter
from .models import Played
from .ports import Ports
from .refused import Refused

_BODY = struct.Struct(">BBBBi")
HEARTBEATS = (HEARTBEAT, CAN_HEARTBEAT)
_COMMAND = struct.Struct(">BBBi")
_CAN_LENGTHS = (7, 8)
ALWAYS_ANSWERED = frozenset({Opcode.GAP, Opcode.GGP, Opcode.GIO})
"""Commands that parameter 255 does not silence."""


class Firmware:
    """One module between two power-offs. Time is the drive's; whoever calls has run it to the present."""

    def __init__(
        self,
        played: Played,
        drive: Drive,
        eeprom: Eeprom,
        delivered: dict[int, int],
        command_s: float,
        unknown: Collection[int] = (),
        later: bool = False,
    ) -> None:
        """`delivered` as of `GlobalParameters`; a command of a program takes `command_s` [s].

        `unknown` are axis parameters that this firmware does not have; `later`: it has the commands of later ones.
        """
        self.drive = drive
        self.eeprom = eeprom
        self.application = Application(eeprom, later)
        self.globals = GlobalParameters(played.module, eeprom, self.application, delivered)
        self.globals.milliseconds = self._milliseconds
        self.axis = Axis(played, drive, lambda number: self.globals.configuration[number], eeprom.axis, unknown)
        self.globals.changed = self.axis.parameters.configured
        self.ports = Ports(
            played.module,
            lambda: drive.switches.home,
            lambda: drive.plant.driver_supply_v,
            lambda: drive.plant.temperature_c,
        )
        self.axis.arrived = self._arrived
        self.events: list[tuple[int, bytes]] = []
        """Position reached events that nobody fetched yet: (time [clocks], frame)."""
        self._clocks_per_ms = round(drive.options.clock_hz / 1000)
        self.coordinates = Coordinates(eeprom, self.globals)
        commands = Commands(
            played.module,
            self.axis,
            self.globals,
            self.ports,
            self.application,
            self.coordinates,
            restart=self.power_on,
            later=later,
        )
        self._handlers = commands.table()
        self.interpreter = Interpreter(
            self.application, self.axis, self.ports, self.globals, drive, self._handlers, command_s
        )
        commands.waits = lambda: self.interpreter.waits
        self._start()

    def power_on(self) -> None:
        """Restart the CPU and all it controls; the EEPROM and the mechanics stay."""
        self.drive.power_cycle()
        self.globals.power_on()
        self.axis.power_on()
        self._start()

    def _start(self) -> None:
        self.events.clear()
        self.globals.power_on()
        self.ports.power_on()
        self.application.power_on(autostart=bool(self.globals.configuration[AUTOSTART]))
        self.interpreter.power_on()
        self.coordinates.power_on()
        self._started = self.drive.clocks
        self._heard: dict[int, int | None] = dict.fromkeys(HEARTBEATS, self.drive.clocks)
        """When the latest command came, by the heartbeat of its interface [clocks]; None since that failed."""

    # --- time ------------------------------------------------------------------------------------

    def run(self, until_clocks: int) -> None:
        """Let time pass to `until_clocks`; events and a missing heartbeat are dealt with as they come."""
        drive = self.drive
        while drive.clocks < until_clocks:
            silent_at, silent = min((self._silent_at(beat, until_clocks), beat) for beat in HEARTBEATS)
            event = self.interpreter.advance(min(until_clocks, silent_at))
            if event is not None:
                self.axis.happened(event)
                self.interpreter.happened(event)
            elif silent_at <= drive.clocks:
                self._heard[silent] = None
                self.axis.stop_search()
                self.axis.stop()

    def _silent_at(self, heartbeat: int, else_at: int) -> int:
        """When a heartbeat (parameter 68 or 82) runs out [clocks]; past `else_at` where none is awaited."""
        limit_ms, heard = self.globals.configuration.get(heartbeat, 0), self._heard[heartbeat]
        if not limit_ms or heard is None:
            return else_at + 1
        return max(heard + limit_ms * self._clocks_per_ms, self.drive.clocks)

    def _milliseconds(self) -> int:
        return (self.drive.clocks - self._started) // self._clocks_per_ms

    def _arrived(self, clocks: int) -> None:
        configuration = self.globals.configuration
        frame = _pack(configuration[HOST], configuration[ADDRESS], Status.EVENT, Opcode.REQUEST_EVENT, MOTOR_BITS)
        self.events.append((clocks, frame))

    # --- frames ----------------------------------------------------------------------------------

    def receive(self, frame: bytes) -> bytes | None:
        """Obey one 9-byte frame. None: not for this module, or a command or setting without answer."""
        configuration = self.globals.configuration
        address = frame[0]
        mine = configuration[ADDRESS]
        if address != mine and (address != configuration[SECONDARY] or address == 0):
            return None
        host = configuration[HOST]
        if sum(frame) - frame[8] & 0xFF != frame[8]:
            if address != mine or self.globals.suppress:
                return None
            return _pack(host, mine, Status.WRONG_CHECKSUM, 0, 0)
        self._heard[HEARTBEAT] = self.drive.clocks
        reply = self._obey(frame[1:8], host, mine)
        return reply if address == mine else None

    def receive_message(self, message: CanMessage) -> CanMessage | None:
        """Obey one message of the CAN bus. None: not for this module, or a command or setting without answer."""
        configuration = self.globals.configuration
        listens, answers = configuration[CAN_RECEIVE], configuration[CAN_SEND]
        second = configuration[CAN_SECONDARY]
        wanted = message.identifier in (listens, second) if second else message.identifier == listens
        if not wanted or len(message.data) not in _CAN_LENGTHS:
            return None
        self._heard[CAN_HEARTBEAT] = self.drive.clocks
        reply = self._obey(message.data[:7], configuration[HOST], listens & 0xFF)
        if reply is None or message.identifier != listens:
            return None
        if message.data[0] == Opcode.GET_VERSION and not has_plain_reply(bytes(1) + message.data):
            return CanMessage(answers, reply[1 : 1 + len(message.data)])
        return CanMessage(answers, reply[1:8])

    def as_message(self, frame: bytes) -> CanMessage:
        """A frame of its own as it is said on the CAN bus."""
        configuration = self.globals.configuration
        return CanMessage(configuration[CAN_SEND], bytes((configuration[CAN_RECEIVE] & 0xFF,)) + frame[2:8])

    def _obey(self, command: bytes, host: int, mine: int) -> bytes | None:
        """The nine bytes that answer seven: opcode, type, motor, value; None where nothing is to be said."""
        opcode, type_, motor, value = _COMMAND.unpack(command)
        try:
            if self.application.downloading and opcode < CONTROL_FIRST:
                self.application.store(command)
                reply = _pack(host, mine, Status.STORED, opcode, value)
            else:
                reply = _pack(host, mine, Status.OK, opcode, self._handlers[opcode](type_, motor, value))
        except Refused as refusal:
            reply = _pack(host, mine, refusal.status, opcode, value)
        except NoAnswer:
            return None
        except Special as answer:
            reply = bytes((host,)) + answer.content
        return None if self.globals.suppress and opcode not in ALWAYS_ANSWERED else reply

    # --- what others ask --------------------------------------------------------------------------

    @property
    def pause_s(self) -> float:
        """How long an answer waits before it is sent [s] (parameter 75)."""
        return self.globals.configuration[PAUSE] / 1000


def _pack(host: int, module: int, status: int, opcode: int, value: int) -> bytes:
    body = _BODY.pack(host, module, status, opcode, wrapped(value))
    return body + bytes((sum(body) & 0xFF,))
