"""Every command of direct mode: what it does, and the value of its answer (FM-PD42-1241 3.6).

Open in all sources, and decided here:
- a motor other than 0 and a bank that there is not are answered with status 4, an unknown parameter, port, coordinate
  or operation with status 3, an unknown command with status 2;
- a parameter that can only be read answers a write with status 3;
- a value out of range is refused with status 4, never clipped;
- a command that only programs may use is answered with status 6;
- where the value of an answer has no meaning, it is the one that was sent;
- what the read-memory answer holds besides the seven bytes is their sum, as in the assembler's files.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from ...registers.tmcl.commands import COMMANDS, COORDINATES_IN_EEPROM, MAGIC, Opcode, Status
from ...registers.tmcl.description import TmclModule
from .application import Application
from .axis import Axis
from .coordinates import Coordinates
from .global_parameters import PROTECTION, GlobalParameters
from .ports import Ports
from .refused import Refused, invalid_value, wrong_type

MOTOR_BITS = 1
"""Motors that there are, as bits of command 138."""
_ABSOLUTE, _RELATIVE, _COORDINATE = 0, 1, 2
_START, _STOP, _STATUS = 0, 1, 2

_CALCULATE = (
    Opcode.CALCVV, Opcode.CALCVA, Opcode.CALCAV, Opcode.CALCVX, Opcode.CALCXV, Opcode.CALCV,
    Opcode.SIV, Opcode.GIV, Opcode.AIV,
)  # fmt: skip

Handler = Callable[[int, int, int], int]
"""(type, motor or bank, value) to the value of the answer. Raises Refused, NoAnswer or Special."""


class NoAnswer(Exception):
    """A command that is never answered."""


class Special(Exception):
    """Bytes 1..8 of an answer that has neither status nor checksum."""

    def __init__(self, content: bytes) -> None:
        super().__init__(content)
        self.content = content


class Commands:
    """The table of handlers. `restart` is what a reset does to the whole module.

    `later`: with the commands of later firmware
    """

    def __init__(
        self,
        module: TmclModule,
        axis: Axis,
        parameters: GlobalParameters,
        ports: Ports,
        application: Application,
        coordinates: Coordinates,
        restart: Callable[[], None],
        later: bool,
    ) -> None:
        self._later = later
        self._module = module
        self._axis = axis
        self._globals = parameters
        self._ports = ports
        self._application = application
        self._coordinates = coordinates
        self._restart = restart
        self.waits: Callable[[], bool] = lambda: False
        """Whether the program waits."""

    def table(self) -> list[Handler]:
        """A handler for each of the 256 opcodes."""
        table: list[Handler] = [_unknown] * 256
        for row in COMMANDS:
            if not row.direct and (self._later or not row.later):
                table[row.opcode] = _only_in_programs
        table[Opcode.ROR] = self._ror
        table[Opcode.ROL] = self._rol
        table[Opcode.MST] = self._mst
        table[Opcode.MVP] = self._mvp
        table[Opcode.SAP] = self._sap
        table[Opcode.GAP] = self._gap
        if self._module.stores_axis:
            table[Opcode.STAP] = self._stap
            table[Opcode.RSAP] = self._rsap
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
        if self._later:
            for opcode in _CALCULATE:
                table[opcode] = partial(self._calculate, opcode)
            table[Opcode.MVPA] = lambda type_, motor, value: self._mvp(type_, motor, self._application.accumulator)
            table[Opcode.RORA] = lambda type_, motor, value: self._ror(type_, motor, self._application.accumulator)
            table[Opcode.ROLA] = lambda type_, motor, value: self._rol(type_, motor, self._application.accumulator)
        return table

    # --- motion and axis parameters --------------------------------------------------------------

    def _ror(self, type_: int, motor: int, value: int) -> int:
        _only_motor(motor)
        self._axis.rotate(value)
        return value

    def _rol(self, type_: int, motor: int, value: int) -> int:
        _only_motor(motor)
        self._axis.rotate(-value)
        return value

    def _mst(self, type_: int, motor: int, value: int) -> int:
        _only_motor(motor)
        self._axis.stop()
        return value

    def _mvp(self, type_: int, motor: int, value: int) -> int:
        """The answer's value is the new target, as one published firmware has it; the manual calls it meaningless."""
        _only_motor(motor)
        if type_ == _ABSOLUTE:
            target = value
        elif type_ == _RELATIVE:
            target = self._axis.relative_base() + value
        elif type_ == _COORDINATE:
            target = self._coordinates.target(value)
        else:
            raise wrong_type()
        self._axis.move(target)
        return target

    def _sap(self, number: int, motor: int, value: int) -> int:
        _only_motor(motor)
        self._axis.set(number, value)
        return value

    def _gap(self, number: int, motor: int, value: int) -> int:
        if motor:
            raise invalid_value()
        reader = self._axis.readers[number]
        if reader is None:
            raise wrong_type()
        return reader()

    def _aap(self, number: int, motor: int, value: int) -> int:
        _only_motor(motor)
        self._axis.set(number, self._application.accumulator)
        return value

    def _stap(self, number: int, motor: int, value: int) -> int:
        _only_motor(motor)
        self._globals.eeprom.axis[number] = self._axis.storable(number)
        self._globals.eeprom.save()
        return value

    def _rsap(self, number: int, motor: int, value: int) -> int:
        """What was never stored is as it was delivered."""
        _only_motor(motor)
        self._axis.storable(number)
        self._axis.set(number, self._globals.eeprom.axis.get(number, self._axis.parameters.defaults[number]))
        return value

    def _rfs(self, type_: int, motor: int, value: int) -> int:
        _only_motor(motor)
        if type_ == _START:
            self._axis.start_search()
            return value
        if type_ == _STOP:
            self._axis.stop_search()
            return value
        if type_ == _STATUS:
            return int(self._axis.search.phase) if self._axis.search else 0
        raise wrong_type()

    def _request_event(self, type_: int, motor: int, value: int) -> int:
        """Command 138: a mask without motor 0 asks for no more events; motors that there are not are refused."""
        if type_ not in (0, 1):
            raise wrong_type()
        if value & ~MOTOR_BITS:
            raise invalid_value()
        self._axis.request_event(every=type_ == 1, on=bool(value & MOTOR_BITS))
        return value

    # --- global parameters, ports, coordinates ---------------------------------------------------

    def _sgp(self, number: int, bank: int, value: int) -> int:
        self._globals.write(number, bank, value)
        return value

    def _ggp(self, number: int, bank: int, value: int) -> int:
        return self._globals.read(number, bank)

    def _agp(self, number: int, bank: int, value: int) -> int:
        self._globals.write(number, bank, self._application.accumulator)
        return value

    def _stgp(self, number: int, bank: int, value: int) -> int:
        self._globals.store(number, bank)
        return value

    def _rsgp(self, number: int, bank: int, value: int) -> int:
        self._globals.restore(number, bank)
        return value

    def _sio(self, port: int, bank: int, value: int) -> int:
        self._ports.write(port, bank, value, self._application.accumulator)
        return value

    def _gio(self, port: int, bank: int, value: int) -> int:
        return self._ports.read(port, bank)

    def _sco(self, number: int, motor: int, value: int) -> int:
        if motor == COORDINATES_IN_EEPROM:
            self._coordinates.store(number)
        else:
            _only_motor(motor)
            self._coordinates.set(number, value)
        return value

    def _gco(self, number: int, motor: int, value: int) -> int:
        """With motor 255 the answer is what the coordinate in RAM is then."""
        if motor == COORDINATES_IN_EEPROM:
            self._coordinates.restore(number)
        else:
            _only_motor(motor)
        return self._coordinates.get(number)

    def _cco(self, number: int, motor: int, value: int) -> int:
        _only_motor(motor)
        self._coordinates.set(number, self._axis.position)
        return self._coordinates.get(number)

    def _aco(self, number: int, motor: int, value: int) -> int:
        """FM-PD42-1241 3.6.25: the accumulator, though one sentence there speaks of the actual position."""
        _only_motor(motor)
        self._coordinates.set(number, self._application.accumulator)
        return value

    # --- calculation, interrupts, application ----------------------------------------------------

    def _calc(self, operation: int, motor: int, value: int) -> int:
        self._application.execute(Opcode.CALC, operation, value)
        return value

    def _calcx(self, operation: int, motor: int, value: int) -> int:
        self._application.execute(Opcode.CALCX, operation)
        return value

    def _calculate(self, opcode: Opcode, type_: int, motor: int, value: int) -> int:
        self._application.execute(opcode, type_, value, motor)
        return value

    def _cle(self, flag: int, motor: int, value: int) -> int:
        self._application.execute(Opcode.CLE, flag)
        return value

    def _ei(self, number: int, motor: int, value: int) -> int:
        self._application.switch_interrupt(number, on=True)
        return value

    def _di(self, number: int, motor: int, value: int) -> int:
        self._application.switch_interrupt(number, on=False)
        return value

    def _stop_application(self, type_: int, motor: int, value: int) -> int:
        self._application.stop()
        return value

    def _run_application(self, type_: int, motor: int, value: int) -> int:
        self._application.run(type_, value)
        return value

    def _step_application(self, type_: int, motor: int, value: int) -> int:
        self._application.step()
        return value

    def _reset_application(self, type_: int, motor: int, value: int) -> int:
        self._application.reset()
        return value

    def _enter_download(self, type_: int, motor: int, value: int) -> int:
        self._application.enter_download(value, self._globals.configuration[PROTECTION])
        return value

    def _exit_download(self, type_: int, motor: int, value: int) -> int:
        self._application.leave_download()
        return value

    def _read_memory(self, type_: int, motor: int, value: int) -> int:
        command = self._application.stored(value, self._globals.configuration[PROTECTION])
        raise Special(command + bytes((sum(command) & 0xFF,)))

    def _get_status(self, type_: int, motor: int, value: int) -> int:
        return self._application.told(type_, self.waits())

    def _get_version(self, type_: int, motor: int, value: int) -> int:
        if type_ == 0:
            raise Special(b"%04dV%d%02d" % (self._module.number, *self._module.version))
        if type_ == 1:
            major, minor = self._module.version
            return self._module.number << 16 | major << 8 | minor
        raise wrong_type()

    def _factory_default(self, type_: int, motor: int, value: int) -> int:
        """Command 137: the EEPROM is erased and the module starts again. Not answered."""
        _only_magic(value)
        self._globals.factory_default()
        self._restart()
        raise NoAnswer

    def _reset_module(self, type_: int, motor: int, value: int) -> int:
        """Command 255: its answer may be lost on the module; here it always is."""
        _only_magic(value)
        self._restart()
        raise NoAnswer


def _unknown(type_: int, motor: int, value: int) -> int:
    raise Refused(Status.INVALID_COMMAND)


def _only_in_programs(type_: int, motor: int, value: int) -> int:
    raise Refused(Status.NOT_AVAILABLE)


def _only_motor(motor: int) -> None:
    if motor != 0:
        raise invalid_value()


def _only_magic(value: int) -> None:
    if value != MAGIC:
        raise invalid_value()
