"""What the rules of all register chips have in common, whatever says registers over a link."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ....links.register_access import BoardAccess
from ..axis_limits import AxisLimits
from ..register_file import RegisterFile
from .frames import Decoder, decoder_of, moves_by_board, refuse_board
from .quantities import View
from .rules import Rules


class ChipRules(Rules):
    """Of a chip with these registers. `known` tells what one is known to hold, by address; None for unknown.

    The commands of an evaluation board can move the axis behind the chip's registers.
    """

    def __init__(
        self,
        registers: RegisterFile,
        known: Callable[[int], int | None],
        limits: Sequence[AxisLimits],
        clock_hz: float,
    ) -> None:
        self._registers = registers
        self._link = registers.link
        self._known = known
        self._decode = decoder_of(self._link.access)
        self._board = isinstance(self._link.access, BoardAccess)
        super().__init__(limits, clock_hz)

    def readable(self, address: int) -> bool:
        row = self._link.table.at(address, write=True)
        return row is not None and row.access.readable

    def remembered(self, address: int) -> int | None:
        return self._known(address)

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
