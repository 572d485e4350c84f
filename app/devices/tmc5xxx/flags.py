"""GSTAT and RAMP_STAT as one word of events, and what of it a reading leaves behind.

RAMP_STAT keeps its bits, GSTAT's stand 16 above. Which flags latch is inferred (NOTES-TMC5XXX 5): those of the latches,
of a stall's stop, of an arrival and of a second move; the two stop events stay as long as their cause.
"""

from __future__ import annotations

from dataclasses import dataclass

from .roles import AxisRoles, ChipRoles, part

GSTAT_LSB = 16
LATCHING = ("status_latch_l", "status_latch_r", "event_stop_sg", "event_pos_reached", "second_move")
LASTING = ("event_stop_l", "event_stop_r")
SAME = "register_reset"
"""Comes with `reset`, and is no event of its own."""


@dataclass(frozen=True)
class AxisFlags:
    """The events of one axis, by bits of the joint word."""

    names: dict[int, str]
    """By bit."""
    latching: int
    """What a reading, or a written 1, clears for good."""
    stall: int
    """event_stop_sg: clearing it lets the motor go on."""
    reset: int

    @classmethod
    def of(cls, chip: ChipRoles, rows: AxisRoles) -> AxisFlags:
        stat = {part(rows.ramp_stat, name).lsb: name for name in (*LATCHING, *LASTING)}
        errors = {"drv_err", f"drv_err{rows.axis + 1}"}
        gstat = {
            field.lsb + GSTAT_LSB: field.name
            for field in chip.gstat.fields
            if field.name != SAME and (not field.name.startswith("drv_err") or field.name in errors)
        }
        return cls(
            names=dict(sorted({**stat, **gstat}.items())),
            latching=part(chip.gstat, "reset").mask << GSTAT_LSB
            | sum(part(rows.ramp_stat, name).mask for name in LATCHING),
            stall=part(rows.ramp_stat, "event_stop_sg").mask,
            reset=part(chip.gstat, "reset").mask << GSTAT_LSB,
        )

    @property
    def mask(self) -> int:
        return sum(1 << bit for bit in self.names)

    def names_of(self, bits: int) -> tuple[str, ...]:
        return tuple(name for bit, name in self.names.items() if bits >> bit & 1)

    def bit(self, name: str) -> int:
        """The bit of an event, 0 where this axis has no such event."""
        return sum(1 << bit for bit, known in self.names.items() if known == name)
