"""What is remembered of a ramp generator chip: the registers that decide a motion, as they were last seen."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from ...calc.units.mechanics import Mechanics
from ...registers.model import Register
from ..core.register_io import RegisterIO
from ..core.register_link import RegisterLink
from .axis_roles import AxisRoles
from .ramp_parameters import RampParameters

MICROSTEPS_MAX_CODE = 6
"""usrs 7 has no meaning (DS-TMC428 Table 8-8)."""
DIVIDER_MAX = 13


class RampMemory:
    """Words as last seen, by address, of the axes' ramp registers and of the global ones in `besides`."""

    def __init__(self, link: RegisterLink, rows: Sequence[AxisRoles], besides: Sequence[Register] = ()) -> None:
        self.rows = tuple(rows)
        """By axis."""
        self._link = link
        self._session = link.session
        self._besides = tuple(besides)
        self._interface = next((row for row in self._besides if row.field_named("en_sd")), None)
        """The register that makes a chip with a chain give steps instead."""
        self._words: dict[int, int] = {}
        self._remembered = frozenset(
            register.address
            for registers in (
                self._besides,
                *((*RampParameters.rows(rows), rows.x_target, rows.v_target) for rows in self.rows),
            )
            for register in registers
        )

    def remembers(self, register: Register) -> bool:
        """Whether words of this register are kept."""
        return register.address in self._remembered

    def saw(self, register: Register, word: int) -> None:
        """The chip was seen to hold `word`."""
        if register.address not in self._remembered:
            return
        self._words[register.address] = word
        if self._session.limiter is not None:
            self._session.limiter.saw(register.address, word, register.width)
        axis = register.axis
        if axis is not None and register is self.rows[axis].dividers:
            rows, known = self.rows[axis], self._session.axes[axis]
            known.pulse_div = min(rows.pulse_div.unpack(word), DIVIDER_MAX)
            known.ramp_div = min(rows.ramp_div.unpack(word), DIVIDER_MAX)
            known.microsteps_per_full_step = self.microsteps(axis)
        elif register is self._interface:
            for axis, known in enumerate(self._session.axes):
                known.microsteps_per_full_step = self.microsteps(axis)

    def word(self, register: Register, unseen: int = 0) -> int:
        """The word of `register`; `unseen` before it was seen."""
        return self._words.get(register.address, unseen)

    def known(self, address: int) -> int | None:
        """The word at `address`; None before it was seen."""
        return self._words.get(address)

    # --- what words mean ------------------------------------------------------------------------

    def ramp(self, axis: int) -> RampParameters | None:
        """The ramp parameters of an axis as last seen; None before everything of it was seen once."""
        rows = self.rows[axis]
        if any(register.address not in self._words for register in RampParameters.rows(rows)):
            return None
        return RampParameters.of(rows, self._words)

    @property
    def drives_chain(self) -> bool:
        """Whether the motors hang on a chain of SPI drivers, as after power-on; else on step/direction drivers."""
        return self.rows[0].usrs is not None and not self._of_interface("en_sd")

    @property
    def compared_axis(self) -> int | None:
        """The axis whose position is compared; None where that cannot be chosen."""
        return self._of_interface("pos_comp_sel")

    def axis_compared(self) -> int | None:
        """The axis whose position compare may raise its interrupt; None while it is off. The only axis of a chip that
        has one."""
        compared = self.compared_axis
        axis = 0 if compared is None else compared
        return axis if axis < len(self.rows) else None

    def _of_interface(self, field: str) -> int | None:
        row = self._interface
        return None if row is None else row.unpack(self.word(row, row.reset or 0))[field]

    def microsteps(self, axis: int) -> int | None:
        """Microsteps per full step: by usrs, or of the step/direction driver; None where not known yet."""
        rows = self.rows[axis]
        if rows.usrs is None or not self.drives_chain:
            return self._session.axes[axis].settings.driver_microsteps
        word = self._words.get(rows.dividers.address)
        return None if word is None else int(1 << min(rows.usrs.unpack(word), MICROSTEPS_MAX_CODE))

    def mechanics(self, axis: int) -> Mechanics:
        """Conversions of an axis as the chip is set now."""
        return self._session.axes[axis].settings.mechanics(self.microsteps(axis) or 1)

    # --- reading --------------------------------------------------------------------------------

    async def read_ramp(self, io: RegisterIO, axis: int, seen: Collection[Register] = ()) -> RampParameters:
        """The ramp parameters of an axis, read in this turn; `seen` are registers that this turn has read already."""
        rows = self.rows[axis]
        for register in RampParameters.rows(rows):
            if register not in seen:
                self.saw(register, await io.read(register))
        return RampParameters.of(rows, self._words)

    async def refresh(self) -> None:
        """Read all of it that decides a motion, a turn each register: others want to ask too."""
        for rows in self.rows:
            for register in RampParameters.rows(rows):
                async with self._link.turn() as turn:
                    self.saw(register, await self._link.io(turn).read(register))
        for register in self._besides:
            self.saw(register, await self._link.read_once(register))
