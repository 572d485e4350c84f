"""The module's firmware: frames in, answers out, and what it does by itself (004, 3).

Open in all sources, and decided here:
- a motor other than 0 and a bank that there is not are answered with status 4, an unknown parameter, port, coordinate
  or operation with status 3, an unknown command with status 2;
- a parameter that can only be read answers a write with status 3;
- a value out of range is refused with status 4, never clipped;
- a command that only programs may use is answered with status 6 in direct mode;
- where the value of an answer has no meaning, it is the one that was sent;
- an answer bears the addresses that held when the command came, so a new address begins with the next command;
- a frame whose checksum is wrong is answered with command 0 and value 0, for nothing in it can be trusted;
- what the read-memory answer holds besides the seven bytes is their sum, as in the assembler's files.
"""

from __future__ import annotations

import struct
from collections.abc import Callable

from app.emulators.drive import Drive
from app.emulators.pd42.application import Application, wrapped
from app.emulators.pd42.axis import Axis
from app.emulators.pd42.eeprom import Eeprom
from app.emulators.pd42.global_parameters import (
    ADDRESS,
    AUTOSTART,
    BAUD,
    CONFIGURATION,
    HEARTBEAT,
    HOST,
    KEEP_COORDINATES,
    PAUSE,
    PROTECTION,
    SECONDARY,
    GlobalParameters,
)
from app.emulators.pd42.ports import Ports
from app.emulators.pd42.refused import Refused, invalid_value, wrong_type
from app.links.tmcl import FRAME_BYTES
from app.registers.pd42 import MODULE
from app.registers.pd42_globals import COORDINATES
from app.registers.tmcl import COMMANDS, CONTROL_FIRST, COORDINATES_IN_EEPROM, MAGIC, Opcode, Status

VERSION_MAJOR, VERSION_MINOR = 1, 44
VERSION_STRING = b"%04dV%d%02d" % (MODULE, VERSION_MAJOR, VERSION_MINOR)
VERSION_BINARY = MODULE << 16 | VERSION_MAJOR << 8 | VERSION_MINOR
_BODY = struct.Struct(">BBBBi")
_ABSOLUTE, _RELATIVE, _COORDINATE = 0, 1, 2
_START, _STOP, _STATUS = 0, 1, 2
_MOTOR_BITS = 1
ALWAYS_ANSWERED = frozenset({Opcode.GAP, Opcode.GGP, Opcode.GIO})
"""Commands that parameter 255 does not silence."""

Handler = Callable[[int, int, int], int]
"""(type, motor or bank, value) to the value of the answer. Raises Refused."""


class Firmware:
    """One module between two power-offs. Time is the drive's; whoever calls has run it to the present."""

    def __init__(self, drive: Drive, eeprom: Eeprom, delivered: dict[int, int]) -> None:
        self.drive = drive
        self.eeprom = eeprom
        self.axis = Axis(drive)
        self.application = Application(eeprom)
        self.globals = GlobalParameters(eeprom, self.application, delivered)
        self.globals.milliseconds = self._milliseconds
        self.ports = Ports(lambda: drive.switches.home, lambda: drive.world.supply_v, lambda: drive.world.temperature_c)
        self.axis.arrived = self._arrived
        self.events: list[tuple[int, bytes]] = []
        """Position reached events that nobody fetched yet: (time [clocks], frame)."""
        self._clocks_per_ms = round(drive.options.clock_hz / 1000)
        self._handlers = self._command_table()
        self._start()

    def power_on(self) -> None:
        """Restart the CPU and all it controls; the EEPROM and the mechanics stay."""
        self.drive.power_cycle()
        self.axis.power_on()
        self._start()

    def _start(self) -> None:
        self.events.clear()
        self.globals.power_on()
        self.ports.power_on()
        self.application.power_on(autostart=bool(self.globals.configuration[AUTOSTART]))
        self.coordinates = [0] * COORDINATES
        if self.globals.configuration[KEEP_COORDINATES]:
            self._restore_coordinates()
        self._started = self.drive.clocks
        self._heard: int | None = self.drive.clocks
        """When the latest command came [clocks]; None since the heartbeat failed."""

    # --- time ------------------------------------------------------------------------------------

    def run(self, until_clocks: int) -> None:
        """Let time pass to `until_clocks`; events and a missing heartbeat are dealt with as they come."""
        drive = self.drive
        while drive.clocks < until_clocks:
            silent_at = self._silent_at(until_clocks)
            event = drive.advance(min(until_clocks, silent_at))
            if event is not None:
                self.axis.happened(event)
            elif silent_at <= drive.clocks:
                self._heard = None
                self.axis.stop_search()
                self.axis.stop()

    def _silent_at(self, else_at: int) -> int:
        """When the heartbeat (parameter 68) runs out [clocks]; `else_at` where none is awaited."""
        limit_ms = self.globals.configuration[HEARTBEAT]
        if not limit_ms or self._heard is None:
            return else_at + 1
        return max(self._heard + limit_ms * self._clocks_per_ms, self.drive.clocks)

    def _milliseconds(self) -> int:
        return (self.drive.clocks - self._started) // self._clocks_per_ms

    def _arrived(self, clocks: int) -> None:
        configuration = self.globals.configuration
        frame = _pack(configuration[HOST], configuration[ADDRESS], Status.EVENT, Opcode.REQUEST_EVENT, _MOTOR_BITS)
        self.events.append((clocks, frame))

    # --- frames ----------------------------------------------------------------------------------

    def receive(self, frame: bytes) -> bytes | None:
        """Obey one 9-byte frame. None: not for this module, or a command or setting without answer."""
        configuration = self.globals.configuration
        address, opcode, type_, motor, value = _BODY.unpack_from(frame)
        mine = configuration[ADDRESS]
        if address != mine and (address != configuration[SECONDARY] or address == 0):
            return None
        host = configuration[HOST]
        if sum(frame) - frame[8] & 0xFF != frame[8]:
            if address != mine or self.globals.suppress:
                return None
            return _pack(host, mine, Status.WRONG_CHECKSUM, 0, 0)
        self._heard = self.drive.clocks
        silent = address != mine or (self.globals.suppress and opcode not in ALWAYS_ANSWERED)
        status = Status.OK
        try:
            if self.application.downloading and opcode < CONTROL_FIRST:
                self.application.store(frame[1:8])
                status = Status.STORED
            else:
                value = self._handlers[opcode](type_, motor, value)
        except Refused as refusal:
            status = refusal.status
        except _NoAnswer:
            return None
        except _Special as answer:
            return None if silent else bytes((host,)) + answer.content
        return None if silent else _pack(host, mine, status, opcode, value)

    def _command_table(self) -> list[Handler]:
        table: list[Handler] = [_unknown] * 256
        for row in COMMANDS:
            if not row.direct:
                table[row.opcode] = _only_in_programs
        table[Opcode.ROR] = self._ror
        table[Opcode.ROL] = self._rol
        table[Opcode.MST] = self._mst
        table[Opcode.MVP] = self._mvp
        table[Opcode.SAP] = self._sap
        table[Opcode.GAP] = self._gap
        table[Opcode.SGP] = self._sgp
        table[Opcode.GGP] = self._ggp
        table[Opcode.STGP] = self._stgp
        table[Opcode.RSGP] = self._rsgp
        table[Opcode.RFS] = self._rfs
        table[Opcode.SIO] = self._sio
        table[Opcode.GIO] = self._gio
        table[Opcode.CALC] = self._calc
        table[Opcode.CALCX] = self._calcx
        table[Opcode.EI] = self._ei
        table[Opcode.DI] = self._di
        table[Opcode.SCO] = self._sco
        table[Opcode.GCO] = self._gco
        table[Opcode.CCO] = self._cco
        table[Opcode.ACO] = self._aco
        table[Opcode.AAP] = self._aap
        table[Opcode.AGP] = self._agp
        table[Opcode.CLE] = self._cle
        table[Opcode.STOP_APPLICATION] = self._stop_application
        table[Opcode.RUN_APPLICATION] = self._run_application
        table[Opcode.STEP_APPLICATION] = self._step_application
        table[Opcode.RESET_APPLICATION] = self._reset_application
        table[Opcode.ENTER_DOWNLOAD] = self._enter_download
        table[Opcode.EXIT_DOWNLOAD] = self._exit_download
        table[Opcode.READ_MEMORY] = self._read_memory
        table[Opcode.GET_STATUS] = self._get_status
        table[Opcode.GET_VERSION] = self._get_version
        table[Opcode.FACTORY_DEFAULT] = self._factory_default
        table[Opcode.REQUEST_EVENT] = self._request_event
        table[Opcode.RESET_MODULE] = self._reset_module
        return table

    # --- motion and axis parameters --------------------------------------------------------------

    def _ror(self, type_: int, motor: int, value: int) -> int:
        _only_motor(motor)
        self.axis.rotate(value)
        return value

    def _rol(self, type_: int, motor: int, value: int) -> int:
        _only_motor(motor)
        self.axis.rotate(-value)
        return value

    def _mst(self, type_: int, motor: int, value: int) -> int:
        _only_motor(motor)
        self.axis.stop()
        return value

    def _mvp(self, type_: int, motor: int, value: int) -> int:
        """The answer's value is the new target, as one published firmware has it; the manual calls it meaningless."""
        _only_motor(motor)
        if type_ == _ABSOLUTE:
            target = value
        elif type_ == _RELATIVE:
            target = self.axis.relative_base() + value
        elif type_ == _COORDINATE:
            if not 0 <= value < COORDINATES:
                raise invalid_value()
            target = self.coordinates[value]
        else:
            raise wrong_type()
        self.axis.move(target)
        return target

    def _sap(self, number: int, motor: int, value: int) -> int:
        _only_motor(motor)
        self.axis.set(number, value)
        return value

    def _gap(self, number: int, motor: int, value: int) -> int:
        if motor:
            raise invalid_value()
        reader = self.axis.readers[number]
        if reader is None:
            raise wrong_type()
        return reader()

    def _aap(self, number: int, motor: int, value: int) -> int:
        _only_motor(motor)
        self.axis.set(number, self.application.accumulator)
        return value

    def _rfs(self, type_: int, motor: int, value: int) -> int:
        _only_motor(motor)
        if type_ == _START:
            self.axis.start_search()
            return value
        if type_ == _STOP:
            self.axis.stop_search()
            return value
        if type_ == _STATUS:
            return int(self.axis.search.phase) if self.axis.search else 0
        raise wrong_type()

    def _request_event(self, type_: int, motor: int, value: int) -> int:
        """Command 138: a mask without motor 0 asks for no more events; motors that there are not are refused."""
        if type_ not in (0, 1):
            raise wrong_type()
        if value & ~_MOTOR_BITS:
            raise invalid_value()
        self.axis.request_event(every=type_ == 1, on=bool(value & _MOTOR_BITS))
        return value

    # --- global parameters, ports, coordinates ---------------------------------------------------

    def _sgp(self, number: int, bank: int, value: int) -> int:
        self.globals.write(number, bank, value)
        return value

    def _ggp(self, number: int, bank: int, value: int) -> int:
        return self.globals.read(number, bank)

    def _agp(self, number: int, bank: int, value: int) -> int:
        self.globals.write(number, bank, self.application.accumulator)
        return value

    def _stgp(self, number: int, bank: int, value: int) -> int:
        self.globals.store(number, bank)
        return value

    def _rsgp(self, number: int, bank: int, value: int) -> int:
        self.globals.restore(number, bank)
        return value

    def _sio(self, port: int, bank: int, value: int) -> int:
        self.ports.write(port, bank, value, self.application.accumulator)
        return value

    def _gio(self, port: int, bank: int, value: int) -> int:
        return self.ports.read(port, bank)

    def _sco(self, number: int, motor: int, value: int) -> int:
        """004, 3.6.22: motor 255 copies to the EEPROM, number 0 then means all of them."""
        _only_coordinate(number)
        if motor == COORDINATES_IN_EEPROM:
            for each in _copied(number):
                self.eeprom.coordinates[each] = self.coordinates[each]
            self.eeprom.save()
            return value
        _only_motor(motor)
        self._set_coordinate(number, value)
        return value

    def _gco(self, number: int, motor: int, value: int) -> int:
        """004, 3.6.23: motor 255 copies from the EEPROM; the answer is the coordinate then in RAM."""
        _only_coordinate(number)
        if motor == COORDINATES_IN_EEPROM:
            for each in _copied(number):
                self.coordinates[each] = self.eeprom.coordinates.get(each, 0)
        else:
            _only_motor(motor)
        return self.coordinates[number]

    def _cco(self, number: int, motor: int, value: int) -> int:
        _only_motor(motor)
        _only_coordinate(number)
        self._set_coordinate(number, self.axis.position)
        return self.coordinates[number]

    def _aco(self, number: int, motor: int, value: int) -> int:
        """004, 3.6.25: the accumulator, though one sentence there speaks of the actual position."""
        _only_motor(motor)
        _only_coordinate(number)
        self._set_coordinate(number, self.application.accumulator)
        return value

    def _set_coordinate(self, number: int, position: int) -> None:
        self.coordinates[number] = position
        if number and self.globals.configuration[KEEP_COORDINATES]:
            self.eeprom.coordinates[number] = position
            self.eeprom.save()

    def _restore_coordinates(self) -> None:
        for number, position in self.eeprom.coordinates.items():
            if 0 < number < COORDINATES:
                self.coordinates[number] = position

    # --- calculation, interrupts, application ----------------------------------------------------

    def _calc(self, operation: int, motor: int, value: int) -> int:
        self.application.calc(operation, value)
        return value

    def _calcx(self, operation: int, motor: int, value: int) -> int:
        self.application.calcx(operation)
        return value

    def _cle(self, flag: int, motor: int, value: int) -> int:
        self.application.clear_errors(flag)
        return value

    def _ei(self, number: int, motor: int, value: int) -> int:
        self.application.switch_interrupt(number, on=True)
        return value

    def _di(self, number: int, motor: int, value: int) -> int:
        self.application.switch_interrupt(number, on=False)
        return value

    def _stop_application(self, type_: int, motor: int, value: int) -> int:
        self.application.stop()
        return value

    def _run_application(self, type_: int, motor: int, value: int) -> int:
        self.application.run(type_, value)
        return value

    def _step_application(self, type_: int, motor: int, value: int) -> int:
        self.application.step()
        return value

    def _reset_application(self, type_: int, motor: int, value: int) -> int:
        self.application.reset()
        return value

    def _enter_download(self, type_: int, motor: int, value: int) -> int:
        self.application.enter_download(value, self.globals.configuration[PROTECTION])
        return value

    def _exit_download(self, type_: int, motor: int, value: int) -> int:
        self.application.leave_download()
        return value

    def _read_memory(self, type_: int, motor: int, value: int) -> int:
        command = self.application.stored(value, self.globals.configuration[PROTECTION])
        raise _Special(command + bytes((sum(command) & 0xFF,)))

    def _get_status(self, type_: int, motor: int, value: int) -> int:
        return self.application.told(type_)

    def _get_version(self, type_: int, motor: int, value: int) -> int:
        if type_ == 0:
            raise _Special(VERSION_STRING)
        if type_ == 1:
            return VERSION_BINARY
        raise wrong_type()

    def _factory_default(self, type_: int, motor: int, value: int) -> int:
        """Command 137: the EEPROM is erased and the module starts again. Not answered."""
        _only_magic(value)
        self.globals.factory_default()
        self.power_on()
        raise _NoAnswer

    def _reset_module(self, type_: int, motor: int, value: int) -> int:
        """Command 255: its answer may be lost on the module; here it always is."""
        _only_magic(value)
        self.power_on()
        raise _NoAnswer

    # --- what others ask --------------------------------------------------------------------------

    @property
    def pause_s(self) -> float:
        """How long an answer waits before it is sent [s] (parameter 75)."""
        return self.globals.configuration[PAUSE] / 1000

    def baud_code(self) -> int:
        """Code of the baud rate that the next power-on brings."""
        return self.globals.read(BAUD, CONFIGURATION)


class _NoAnswer(Exception):
    """A command that is never answered."""


class _Special(Exception):
    """Bytes 1..8 of an answer that has neither status nor checksum."""

    def __init__(self, content: bytes) -> None:
        super().__init__(content)
        self.content = content


def _pack(host: int, module: int, status: int, opcode: int, value: int) -> bytes:
    body = _BODY.pack(host, module, status, opcode, wrapped(value))
    return body + bytes((sum(body) & 0xFF,))


def _unknown(type_: int, motor: int, value: int) -> int:
    raise Refused(Status.INVALID_COMMAND)


def _only_in_programs(type_: int, motor: int, value: int) -> int:
    raise Refused(Status.NOT_AVAILABLE)


def _only_motor(motor: int) -> None:
    if motor != 0:
        raise invalid_value()


def _only_coordinate(number: int) -> None:
    if number >= COORDINATES:
        raise wrong_type()


def _only_magic(value: int) -> None:
    if value != MAGIC:
        raise invalid_value()


def _copied(number: int) -> range:
    """Which coordinates a copy concerns: 0 stands for all, and is itself never copied."""
    return range(1, COORDINATES) if number == 0 else range(number, number + 1)


assert len(VERSION_STRING) == FRAME_BYTES - 1
