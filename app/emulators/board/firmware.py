"""Commands of the board: nine bytes to nine bytes, at the time that the chip's registers are told.

As the published firmware answers, where that can be seen:
- another module's address is not answered; the address is 1, the host's 2, and neither can be changed;
- a frame with a wrong checksum is answered with status 1 and value 0, and with the module and command of the frame
  before it (0 and 0 at first);
- a value that has no meaning in an answer is the one that was sent.
Open there, and decided here: the motor of commands 1..6 must be 0; setting up a chip that was reset takes no time.
"""

from __future__ import annotations

import struct
from collections.abc import Callable

from ...registers.evaluation_board import (
    ADDRESS,
    CHANNEL_1_BOARDS,
    CHANNEL_2_BOARDS,
    REGISTER_ADDRESS_BITS,
    BoardOpcode,
    SlotState,
)
from ...registers.tmcl.commands import MAGIC, Opcode, Status
from .functions import AxisFunctions, BoardFunctions, DriverFunctions
from .identity import ABSENT, HARDWARE_VERSION, IdentityEeprom
from .refusal import Refusal, invalid_command, invalid_value, wrong_type
from .registers import ChipRegisters

HOST = 2
MODULE = 12
VERSION_MAJOR, VERSION_MINOR = 3, 10
VERSION_STRING = b"%04dV%d%02d" % (MODULE, VERSION_MAJOR, VERSION_MINOR)
VERSION_BINARY = MODULE // 100 << 24 | MODULE % 100 << 16 | VERSION_MAJOR << 8 | VERSION_MINOR
SUPPLY_DECIVOLTS = 240
SPI_HZ = (2_000_000, 2_000_000)
Handler = Callable[[int, int, int], int]
"""(type, motor or bank, value) to the value of the answer. Raises Refusal."""
_BODY = struct.Struct(">BBBBi")
_UF_WRITE, _UF_READ = 69, 70
NO_FUNCTION, NO_MOTOR = 2, 8
"""Error codes of the firmware (TMC_ERROR_FUNCTION, TMC_ERROR_MOTOR)."""
_INFO = {
    0: MODULE,
    1: VERSION_MAJOR << 16 | VERSION_MINOR,
    2: 2,  # speaks TMCL
    3: 0,  # a public release
    20: 8,  # bits of an axis parameter's number
    21: REGISTER_ADDRESS_BITS,
    200: 0,  # patch
}


class Firmware:
    """One board between two power-offs. `make_functions` makes those for the chip in the slot, as after power-on."""

    def __init__(self, registers: ChipRegisters, make_functions: Callable[[ChipRegisters], BoardFunctions]) -> None:
        self._registers = registers
        self._make_functions = make_functions
        self.power_on()
        board, driver = self._board.board_id, self._driver_id
        self._identities = {1: IdentityEeprom(CHANNEL_1_BOARDS[board], board)}
        if driver:
            self._identities[2] = IdentityEeprom(CHANNEL_2_BOARDS[driver], driver)

    def power_on(self) -> None:
        """Start the microcontroller: it finds the boards and sets the chip up."""
        self._board = self._make_functions(self._registers)
        self._globals = {1: 0, 2: 1, 3: 0, 5: 0, 7: SPI_HZ[0], 8: SPI_HZ[1], 9: 3, 10: 3, 11: 243, 12: 9600}
        """Errors, drivers enabled, debug mode, hardware, SPI clocks [Hz] and modes, bulk bytes, UART's baud rate."""
        self._heard = (0, 0)
        self._board.power_on()

    def pass_time(self, until_s: float, chip_s: float) -> None:
        """Live on to `until_s` [s] without a command; the chip already stands at `chip_s`."""
        self._board.pass_time(until_s, chip_s)

    @property
    def _driver_id(self) -> int:
        """The board in slot 2; 0 for none."""
        return 0 if self._board.driver is None else self._board.driver.board_id

    @property
    def _slots(self) -> int:
        """Channel 1, its state, channel 2, its state, from the lowest byte on."""
        other = SlotState.DONE if self._driver_id else SlotState.NO_ANSWER
        return self._board.board_id | SlotState.DONE << 8 | self._driver_id << 16 | other << 24

    def receive(self, frame: bytes) -> bytes | None:
        """Obey one 9-byte frame; None where it is for another module."""
        if sum(frame[:8]) & 0xFF != frame[8]:
            return _pack(self._heard[0], Status.WRONG_CHECKSUM, self._heard[1], 0)
        module, opcode, type_, motor, value = _BODY.unpack_from(frame)
        self._heard = (module, opcode)
        if module != ADDRESS:
            return None
        if opcode == Opcode.GET_VERSION and type_ == 0:
            return bytes((HOST,)) + VERSION_STRING
        try:
            return _pack(module, Status.OK, opcode, self._obey(opcode, type_, motor, value))
        except Refusal as refusal:
            return _pack(module, refusal.status, opcode, value if refusal.value is None else refusal.value)

    def _obey(self, opcode: int, type_: int, motor: int, value: int) -> int:
        """The value of the answer. Raises Refusal."""
        address = motor >> 4 << 8 | type_
        if opcode in (BoardOpcode.READ_MC, _UF_READ):
            return self._registers.read(address)
        if opcode in (BoardOpcode.WRITE_MC, _UF_WRITE):
            self._registers.write(address, value)
            return value
        if opcode in (BoardOpcode.READ_DRV, BoardOpcode.WRITE_DRV):
            return self._driver_register(opcode, address, value)
        if Opcode.ROR <= opcode <= Opcode.GAP:
            return self._axis(opcode, type_, motor, value)
        handlers: dict[int, Handler] = {
            Opcode.SGP: self._set_global,
            Opcode.GGP: self._get_global,
            Opcode.GIO: self._input,
            Opcode.UF0: self._enable_drivers,
            Opcode.UF1: self._read_identity,
            Opcode.UF2: self._write_identity,
            Opcode.UF4: self._measured,
            Opcode.GET_VERSION: self._version,
            Opcode.RESET_MODULE: self._restart,
            BoardOpcode.GET_IDS: self._assign,
            BoardOpcode.USER_FUNCTION_MC: self._user_function,
            BoardOpcode.USER_FUNCTION_DRV: self._driver_function,
            BoardOpcode.MEASURED_SPEED: self._measured_of,
            BoardOpcode.BOARD_ERROR: self._errors,
            BoardOpcode.BOARD_RESET: self._board_reset,
            BoardOpcode.GET_INFO: self._info,
        }
        if opcode not in handlers:
            raise invalid_command()
        return handlers[opcode](type_, motor, value)

    def _axis(self, opcode: int, type_: int, motor: int, value: int) -> int:
        if motor >= len(self._board.axes):
            raise wrong_type()
        axis = self._board.axes[motor]
        if opcode in (Opcode.ROR, Opcode.ROL, Opcode.MST):
            axis.rotate({Opcode.ROR: value, Opcode.ROL: -value}.get(Opcode(opcode), 0))
        elif opcode == Opcode.MVP and type_ == 0:
            axis.move_to(value)
        elif opcode == Opcode.MVP and type_ == 1:
            return axis.move_by(value)
        elif opcode == Opcode.MVP and type_ == 2:
            raise invalid_command()
        elif opcode in (Opcode.SAP, Opcode.GAP):
            try:
                return self._parameter(axis, opcode, type_, value)
            except Refusal as refusal:
                if refusal.status != Status.WRONG_TYPE or self._board.driver is None:
                    raise
                return self._parameter(self._board.driver, opcode, type_, value)
        else:
            raise wrong_type()
        return value

    @staticmethod
    def _parameter(of: AxisFunctions | DriverFunctions, opcode: int, number: int, value: int) -> int:
        if opcode == Opcode.GAP:
            return of.get(number)
        of.set(number, value)
        return value

    # --- the driver's board ----------------------------------------------------------------------

    def _driver_register(self, opcode: int, address: int, value: int) -> int:
        """An empty slot takes everything, and answers with what it was asked with."""
        driver = self._board.driver
        if driver is None:
            return value
        if opcode == BoardOpcode.READ_DRV:
            return driver.read(address)
        driver.write(address, value)
        return value

    def _driver_function(self, type_: int, motor: int, value: int) -> int:
        del motor
        if self._board.driver is None:
            raise invalid_command()
        return self._board.driver.user_function(type_, value)

    # --- the board itself ------------------------------------------------------------------------

    def _get_global(self, type_: int, motor: int, value: int) -> int:
        del motor, value
        if type_ == 4:
            return self._slots
        if type_ not in self._globals:
            raise wrong_type()
        return self._globals[type_]

    def _set_global(self, type_: int, motor: int, value: int) -> int:
        del motor
        if type_ not in self._globals or type_ == 5:
            raise wrong_type()
        if (type_ == 3 and value not in (0, 1)) or (type_ in (9, 10) and not 0 <= value <= 3):
            raise invalid_value()
        if type_ == 2:
            value = int(value != 0)
        if type_ != 1:  # sets which errors count, and reads which there are: none here
            self._globals[type_] = value
        return value

    def _enable_drivers(self, type_: int, motor: int, value: int) -> int:
        del type_, motor
        self._globals[2] = int(value != 0)
        return value

    def _read_identity(self, type_: int, motor: int, value: int) -> int:
        """Four bytes of the EEPROM of the board in slot 1 or 2."""
        del motor
        if type_ not in (1, 2):
            raise wrong_type()
        return self._identities[type_].read(value) if type_ in self._identities else ABSENT

    def _write_identity(self, type_: int, motor: int, value: int) -> int:
        """One byte there: the motor's place has it."""
        if type_ not in (1, 2):
            raise wrong_type()
        if type_ not in self._identities:
            raise Refusal(Status.EEPROM_LOCKED)
        self._identities[type_].write(value, motor)
        return value

    def _speed(self, slot: int, motor: int) -> tuple[int, int]:
        """The firmware's own error code (0: none), and the measured velocity of a motor of the board in that slot."""
        driver, axes = self._board.driver, self._board.axes
        if slot == 0:
            if not self._board.measures_velocity:
                return NO_FUNCTION, 0
            return (0, axes[motor].get(axes[motor].measured_velocity)) if motor < len(axes) else (NO_MOTOR, 0)
        if driver is None:
            return NO_FUNCTION, 0
        return (NO_MOTOR, 0) if motor else (0, driver.get(driver.measured_velocity))

    def _measured(self, type_: int, motor: int, value: int) -> int:
        """The measured velocity of the first board that measures one."""
        del type_, value
        error, velocity = self._speed(0, motor)
        if error == NO_FUNCTION:
            error, velocity = self._speed(1, motor)
        if error:
            raise invalid_command() if error == NO_FUNCTION else wrong_type()
        return velocity

    def _measured_of(self, type_: int, motor: int, value: int) -> int:
        """Command 150, of one of the slots: its status is the error code itself, so 0 where all is well."""
        if type_ > 1:
            raise wrong_type()
        error, velocity = self._speed(type_, motor)
        raise Refusal(error, value if error else velocity)

    def _input(self, type_: int, motor: int, value: int) -> int:
        """Analog inputs: 0 with nothing at them; 5 and 6 are the motor supply."""
        del motor, value
        if type_ > 7:
            raise wrong_type()
        return SUPPLY_DECIVOLTS if type_ in (5, 6) else 0

    def _version(self, type_: int, motor: int, value: int) -> int:
        del motor
        motors = len(self._board.axes)
        by_eeprom = 0x0202 if 2 in self._identities else 0x0002
        return {1: VERSION_BINARY, 4: by_eeprom, 5: VERSION_MAJOR * 100 + VERSION_MINOR, 6: motors}.get(type_, value)

    def _info(self, type_: int, motor: int, value: int) -> int:
        del motor, value
        if type_ == 201:
            return self._board.board_id << 16 | self._driver_id
        if type_ == 202:
            version = HARDWARE_VERSION[0] << 8 | HARDWARE_VERSION[1]
            return version << 16 | (version if 2 in self._identities else 0xFFFF)
        if type_ not in _INFO:
            raise wrong_type()
        return _INFO[type_]

    def _errors(self, type_: int, motor: int, value: int) -> int:
        del motor, value
        if type_ > 1:
            raise wrong_type()
        return 0

    def _assign(self, type_: int, motor: int, value: int) -> int:
        """Command 143: 0 looks for the boards anew, which resets the chip; 4 and 5 only tell; no board of another kind
        can be put into the slots."""
        del motor, value
        if type_ == 0:
            self._board.reset()
        elif type_ not in (4, 5):
            raise wrong_type() if type_ > 5 else invalid_value()
        return self._slots

    def _board_reset(self, type_: int, motor: int, value: int) -> int:
        del motor
        if type_ > 2:
            raise wrong_type()
        if type_ != 1:
            self._board.reset()
        if type_ != 0 and self._board.driver is not None:
            self._board.driver.reset()
        return value

    def _user_function(self, type_: int, motor: int, value: int) -> int:
        return self._board.user_function(type_, motor, value)

    def _restart(self, type_: int, motor: int, value: int) -> int:
        del type_, motor
        if value == MAGIC:
            heard = self._heard
            self.power_on()
            self._heard = heard  # the answer goes out before the restart
        return value


def _pack(module: int, status: int, opcode: int, value: int) -> bytes:
    body = _BODY.pack(HOST, module, status, opcode, (value + (1 << 31)) % (1 << 32) - (1 << 31))
    return body + bytes((sum(body) & 0xFF,))
