"""Global parameters of banks 0, 2 and 3 (FM-PD42-1241 5)."""

from __future__ import annotations

from collections.abc import Callable

from ...registers.model import Register, Space, to_signed
from ...registers.tmcl.commands import BAUD_RATES, CAN_BIT_RATES
from ...registers.tmcl.description import TmclModule
from ...registers.tmcl.pd42_globals import VARIABLES, VARIABLES_STORED
from .application import PROTECT_READ, Application
from .eeprom import Eeprom
from .refused import invalid_value, wrong_type

CONFIGURATION, USER_VARIABLES, INTERRUPT_SETUP = 0, 2, 3
"""Banks."""
BAUD, ADDRESS, HEARTBEAT, PAUSE, HOST, AUTOSTART, PROTECTION = 65, 66, 68, 75, 76, 77, 81
CAN_RATE, CAN_SEND, CAN_RECEIVE, CAN_HEARTBEAT, CAN_SECONDARY = 69, 70, 71, 82, 83
KEEP_COORDINATES, FORGET_VARIABLES, SECONDARY = 84, 85, 87
STATUS, DOWNLOADING, COUNTER, LAST_ERROR, TICKS, RANDOM, SUPPRESS = 128, 129, 130, 131, 132, 133, 255
_FIRST_STORED, _LAST_STORED = 64, 127
_TICKS_WRAP = 1 << 31
_FASTER_BAUDS = {8: 230_400, 9: 250_000, 10: 500_000, 11: 1_000_000}
"""Codes that only the sister module's table has."""


class GlobalParameters:
    """What SGP, GGP, STGP and RSGP reach. `milliseconds` tells the module's time since power-on [ms]."""

    def __init__(self, module: TmclModule, eeprom: Eeprom, application: Application, delivered: dict[int, int]) -> None:
        """`delivered` are settings of bank 0 that an erased EEPROM has other than by the table."""
        self._bank0, self._bank3 = module.rows(Space.GLOBAL_0), module.rows(Space.GLOBAL_3)
        self._defaults = {
            number: row.reset or 0 for number, row in self._bank0.items() if _FIRST_STORED <= number <= _LAST_STORED
        }
        self.eeprom = eeprom
        self._application = application
        self._variables = application.variables
        self._delivered = {number: value for number, value in delivered.items() if number in self._bank0}
        self.milliseconds: Callable[[], int] = lambda: 0
        self.timer_set: Callable[[int], None] = lambda number: None
        """Hears the number of each setting of bank 3 that was written."""
        self.changed: Callable[[int], None] = lambda number: None
        """Hears the number of each setting of bank 0 that was written."""
        self.power_on()

    def power_on(self) -> None:
        """Everything as after switching on (FM-PD42-1241 5.1, 5.3, 8.4)."""
        known = {
            number: value for number, value in self.eeprom.globals.items() if _allowed(self._bank0.get(number), value)
        }
        self.configuration = {**self._defaults, **self._delivered, **known}
        self.baud_in_force = baud_of(self.configuration[BAUD])
        self.can_rate_in_force = can_bit_rate_of(self.configuration[CAN_RATE]) if self.has_can else None
        self.suppress = 0
        self._variables[:] = 0
        if not self.configuration[FORGET_VARIABLES]:
            for number, value in self.eeprom.variables.items():
                self._variables[number % VARIABLES] = value
        self.interrupt_setup = {number: row.reset or 0 for number, row in self._bank3.items()}
        self._ticks_from = 0
        self._random = 1

    def factory_default(self) -> None:
        """Erase the EEPROM (command 137). What was set at delivery is gone too: the address is 1 again."""
        self._delivered = {}
        self.eeprom.erase()

    @property
    def has_can(self) -> bool:
        """Whether the module has a CAN interface: then it has identifiers to listen to."""
        return CAN_RECEIVE in self._bank0

    @property
    def address(self) -> int:
        return self.configuration[ADDRESS]

    def read(self, number: int, bank: int) -> int:
        """GGP. Raises Refused: status 3 for a parameter that there is not, 4 for another bank."""
        if bank == USER_VARIABLES:
            return int(self._variables[number])
        if bank == CONFIGURATION:
            if number in self.configuration:
                return self.configuration[number]
            return self._read_live(number)
        if bank == INTERRUPT_SETUP:
            if number not in self.interrupt_setup:
                raise wrong_type()
            return self.interrupt_setup[number]
        raise invalid_value()

    def write(self, number: int, bank: int, value: int) -> None:
        """SGP, AGP. Raises Refused: status 3 where it cannot be written, 4 for the value or the bank."""
        if bank == USER_VARIABLES:
            self._variables[number] = value
        elif bank == CONFIGURATION:
            self._write_configuration(number, value)
        elif bank == INTERRUPT_SETUP:
            row = self._bank3.get(number)
            if row is None:
                raise wrong_type()
            if row.maximum >= 1 << 31:  # periods use all 32 bits without a sign
                value &= 0xFFFF_FFFF
            if not _allowed(row, value):
                raise invalid_value()
            self.interrupt_setup[number] = to_signed(value & 0xFFFF_FFFF, 32)
            self.timer_set(number)
        else:
            raise invalid_value()

    def store(self, number: int, bank: int) -> None:
        """STGP (FM-PD42-1241 3.6.9). Bank 0 is stored as it is written, so there it only has to exist."""
        if bank == USER_VARIABLES:
            if number >= VARIABLES_STORED:
                raise wrong_type()
            self.eeprom.variables[number] = int(self._variables[number])
            self.eeprom.save()
        elif bank != CONFIGURATION:
            raise invalid_value()
        elif number not in self.configuration:
            raise wrong_type()

    def restore(self, number: int, bank: int) -> None:
        """RSGP (FM-PD42-1241 3.6.10). What was never stored is 0."""
        if bank == USER_VARIABLES:
            if number >= VARIABLES_STORED:
                raise wrong_type()
            self._variables[number] = self.eeprom.variables.get(number, 0)
        elif bank != CONFIGURATION:
            raise invalid_value()
        elif number not in self.configuration:
            raise wrong_type()

    def _read_live(self, number: int) -> int:
        application = self._application
        if number not in self._bank0:
            raise wrong_type()
        if number == STATUS:
            return application.status
        if number == DOWNLOADING:
            return int(application.downloading)
        if number == COUNTER:
            return application.counter
        if number == LAST_ERROR:
            return application.last_error
        if number == TICKS:
            return (self.milliseconds() - self._ticks_from) % _TICKS_WRAP
        if number == RANDOM:
            # Any generator will do; this one needs no state but the number itself (Park and Miller, 1988).
            self._random = self._random * 48271 % 0x7FFF_FFFF
            return self._random
        if number == SUPPRESS:
            return self.suppress
        raise wrong_type()

    def _write_configuration(self, number: int, value: int) -> None:
        row = self._bank0.get(number)
        if row is None or not row.access.writable:
            raise wrong_type()
        if not _allowed(row, value):
            raise invalid_value()
        if number == TICKS:
            self._ticks_from = self.milliseconds() - value
        elif number == RANDOM:
            self._random = value % 0x7FFF_FFFE + 1  # the generator must never stand on 0
        elif number == SUPPRESS:
            self.suppress = value
        else:
            unprotected = number == PROTECTION and self.configuration[PROTECTION] & PROTECT_READ and not value & 1
            if unprotected:  # else the protection would be none
                self._application.erase()
            self.configuration[number] = value
            self.eeprom.globals[number] = value
            self.eeprom.save()
            self.changed(number)


def baud_of(code: int) -> int:
    """Baud rate of a code of global parameter 65."""
    return BAUD_RATES.get(code) or _FASTER_BAUDS[code]


def can_bit_rate_of(code: int) -> int:
    """CAN bit rate of a code of global parameter 69 [bit/s]."""
    return CAN_BIT_RATES[code]


def _allowed(row: Register | None, value: int) -> bool:
    return row is not None and row.minimum <= value <= row.maximum
