"""Inputs and outputs of the module (FM-PD42-1241 3.6.12 and 3.6.13).

Levels of open inputs and what the pull-ups do to them are in no source: here an input that nobody drives reads 1 with
its pull-up and 0 without. IN0 follows the home switch, and reads 1 where that is active. IN3, the analog input taken
as a digital one, is 1 from half of full scale on.
"""

from __future__ import annotations

from collections.abc import Callable

from ...registers.model import Space
from ...registers.tmcl.description import TmclModule
from .refused import invalid_value, wrong_type

DIGITAL, ANALOG, OUTPUT = 0, 1, 2
"""Banks."""
ALL = 255
AIN0, SUPPLY, TEMPERATURE = 0, 8, 9
_PULL_UP_HOME, _PULL_UP_OTHERS = 1, 2
_ANALOG_HALF = 2048


class Ports:
    """Three callables tell what lies outside: the home switch, the supply [V] and the temperature [deg C]."""

    def __init__(
        self,
        module: TmclModule,
        home: Callable[[], bool],
        supply_v: Callable[[], float],
        celsius: Callable[[], float],
    ) -> None:
        self._outputs = len(module.rows(Space.OUTPUT))
        self._has_pull_ups = bool(module.rows(Space.PULL_UP))
        self._home, self._supply_v, self._celsius = home, supply_v, celsius
        self.driven: dict[int, bool | None] = {1: None, 2: None}
        """Levels put on IN1 and IN2; None leaves them open."""
        self.analog = 0
        self.power_on()

    def power_on(self) -> None:
        """Outputs off, pull-ups on."""
        self.outputs = [0] * self._outputs
        self.pull_ups = _PULL_UP_HOME | _PULL_UP_OTHERS

    def read(self, port: int, bank: int) -> int:
        """GIO. Raises Refused: status 3 for a port that there is not, 4 for another bank."""
        if bank == DIGITAL:
            levels = self.levels()
            if port == ALL:
                return sum(level << place for place, level in enumerate(levels))
            if port < len(levels):
                return int(levels[port])
        elif bank == ANALOG:
            if port == AIN0:
                return self.analog
            if port == SUPPLY:
                return round(self._supply_v() * 10)
            if port == TEMPERATURE:
                return round(self._celsius())
        elif bank == OUTPUT:
            if port < self._outputs:
                return self.outputs[port]
        else:
            raise invalid_value()
        raise wrong_type()

    def write(self, port: int, bank: int, value: int, accumulator: int) -> None:
        """SIO: bank 2 the outputs (port 255 all of them as bits, -1 takes the accumulator), bank 0 the pull-ups."""
        if bank == DIGITAL:
            if port != 0 or not self._has_pull_ups:
                raise wrong_type()
            if not 0 <= value <= (_PULL_UP_HOME | _PULL_UP_OTHERS):
                raise invalid_value()
            self.pull_ups = value
        elif bank != OUTPUT:
            raise invalid_value()
        elif port == ALL:
            bits = accumulator if value == -1 else value
            self.outputs = [bits >> place & 1 for place in range(self._outputs)]
        elif port >= self._outputs:
            raise wrong_type()
        elif value not in (0, 1):
            raise invalid_value()
        else:
            self.outputs[port] = value

    def levels(self) -> list[bool]:
        """IN0..IN3."""
        pulled = bool(self.pull_ups & _PULL_UP_OTHERS)
        others = [pulled if level is None else level for level in self.driven.values()]
        return [self._home(), *others, self.analog >= _ANALOG_HALF]
