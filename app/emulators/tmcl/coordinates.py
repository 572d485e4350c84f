"""The 21 coordinates that MVP COORD goes to (FM-PD42-1241 3.6.22 to 3.6.25)."""

from __future__ import annotations

from ...registers.tmcl.pd42_globals import COORDINATES
from .eeprom import Eeprom
from .global_parameters import KEEP_COORDINATES, GlobalParameters
from .refused import invalid_value, wrong_type


class Coordinates:
    """In RAM; in the EEPROM where a command asks for it, or always (global parameter 84). Number 0 is RAM alone."""

    def __init__(self, eeprom: Eeprom, parameters: GlobalParameters) -> None:
        self._eeprom = eeprom
        self._parameters = parameters
        self.power_on()

    def power_on(self) -> None:
        """Zeros, or what the EEPROM holds where coordinates are kept."""
        self._values = [0] * COORDINATES
        if self._parameters.configuration[KEEP_COORDINATES]:
            self.restore(0)

    def get(self, number: int) -> int:
        """Raises Refused (status 3) for a number that there is not."""
        _check(number)
        return self._values[number]

    def target(self, number: int) -> int:
        """Where MVP COORD goes. There the number is a value, so a wrong one is refused with status 4."""
        if not 0 <= number < COORDINATES:
            raise invalid_value()
        return self._values[number]

    def set(self, number: int, position: int) -> None:
        """SCO, CCO, ACO. Raises Refused: status 3 for a number that there is not, 5 for a locked EEPROM."""
        _check(number)
        self._values[number] = position
        if number and self._parameters.configuration[KEEP_COORDINATES]:
            self.store(number)

    def store(self, number: int) -> None:
        """SCO with motor 255: into the EEPROM; number 0 stands for all the others."""
        for each in _copied(number):
            self._eeprom.coordinates[each] = self._values[each]
        self._eeprom.save()

    def restore(self, number: int) -> None:
        """GCO with motor 255: out of the EEPROM; number 0 stands for all the others. What was never stored is 0."""
        for each in _copied(number):
            self._values[each] = self._eeprom.coordinates.get(each, 0)


def _check(number: int) -> None:
    if number >= COORDINATES:
        raise wrong_type()


def _copied(number: int) -> range:
    _check(number)
    return range(1, COORDINATES) if number == 0 else range(number, number + 1)
