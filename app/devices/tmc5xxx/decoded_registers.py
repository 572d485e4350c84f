"""Decodes the shadow registers of a TMC5xxx: ramps, microsteps, encoders, switches."""

from __future__ import annotations

from ...calc.units.mechanics import Mechanics
from ..core.register_io import Snapshot
from ..core.session import Session
from . import roles as r
from .memory import ChipMemory
from .ramp import Ramp


class DecodedRegisters:
    """Configuration as the shadow registers hold it; reads nothing from the chip."""

    def __init__(self, session: Session, memory: ChipMemory) -> None:
        self._session = session
        self._memory = memory

    def ramp(self, axis: int) -> Ramp:
        """The ramp as the user wants it."""
        words = {name: self._memory.wanted(row) for name, row in self._memory.rows(axis).ramp.items()}
        return Ramp(words, self._session.clock_hz)

    def goes_nowhere(self, axis: int) -> bool:
        """Whether the axis would stay where it is if nothing held it."""
        rows = self._memory.rows(axis)
        return self._memory.known(rows.rampmode) in (r.FORWARD, r.BACKWARD) and self._memory.word(rows.vmax) == 0

    def mechanics(self, axis: int) -> Mechanics:
        """Conversions of the axis, its microsteps by CHOPCONF."""
        rows = self._memory.rows(axis)
        return self._session.axes[axis].settings.mechanics(rows.microsteps(self._memory.known(rows.chopconf)))

    # --- encoders and switches ------------------------------------------------------------------

    def counts_encoder(self, axis: int) -> bool:
        """Whether X_ENC counts as configured: there is one, GCONF leaves it its pins, and ENC_CONST is not as after a
        reset."""
        row = self._memory.rows(axis).enc_const
        if row is None or self._memory.word(row) in (0, row.reset):
            return False
        return self.has_encoder_pins(axis)

    def has_encoder_pins(self, axis: int) -> bool:
        """Whether GCONF leaves the encoder its pins: those of the second one are switches' else."""
        if not self._memory.chip.two_axes:
            return True
        return self._gconf("enc2_enable") if axis else not self._gconf("poscmp_enable")

    def has_right_switch(self) -> bool:
        """Whether the pins of the right switches are theirs: encoder 2 takes both."""
        return not self._gconf("enc2_enable")

    def _gconf(self, name: str) -> bool:
        """A bit of GCONF as last seen; False where the chip has none of that name."""
        gconf = self._memory.chip.gconf
        part = gconf.field_named(name)
        return part is not None and bool(part.unpack(self._memory.known(gconf) or 0))

    # --- positions ------------------------------------------------------------------------------

    def tell_positions(self, held: Snapshot, asked_at_s: float) -> None:
        """Tell of the position counters that were among what was read, with the encoders that count."""
        for rows in self._memory.chip.axes:
            if rows.xactual.address in held.words:
                encoder = rows.x_enc if self.counts_encoder(rows.axis) else None
                seen = None if encoder is None or encoder.address not in held.words else held.value(encoder)
                self._session.saw_position(rows.axis, held.value(rows.xactual), asked_at_s, seen)
