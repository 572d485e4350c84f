"""What the rules of all register chips have in common, and of those behind whatever says registers over a link."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from ...links.register_access import LandungsbrueckeAccess
from .axis_limits import AxisLimits
from .frames import Decoder, decoder_of, moves_by_board, refuse_board
from .parts import View
from .rules import Rules

if TYPE_CHECKING:
    from ..core.register_chip import RegisterChip
    from ..core.shadow_registers import KeepingChip


class ChipRules(Rules):
    """`registers` is the driver."""

    def __init__(self, registers: RegisterChip, limits: Sequence[AxisLimits], clock_hz: float) -> None:
        self._registers = registers
        super().__init__(limits, clock_hz)

    def readable(self, address: int) -> bool:
        row = self._registers.table.at(address, write=True)
        return row is not None and row.access.readable

    def remembered(self, address: int) -> int | None:
        return self._registers.remembered_word(address)


class AccessRules(ChipRules):
    """A chip on SPI, on its UART or on an evaluation board, whose commands can move it behind the chip's registers."""

    def __init__(self, registers: KeepingChip, limits: Sequence[AxisLimits], clock_hz: float) -> None:
        self._decode = decoder_of(registers.access)
        self._board = isinstance(registers.access, LandungsbrueckeAccess)
        super().__init__(registers, limits, clock_hz)

    def writes(self, frame: bytes) -> Sequence[tuple[int, int]]:
        return self._decode(frame)

    def decoder(self) -> Decoder:
        return self._decode

    @property
    def tells_more(self) -> bool:
        return self._board

    def concerns(self, frame: bytes) -> bool:
        return self._board and moves_by_board(frame)

    def require_told(self, frame: bytes, view: View) -> None:
        if self._board:
            refuse_board(frame)
