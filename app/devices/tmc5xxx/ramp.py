"""What moves an axis: its ramp registers, as far as anybody knows them, and what they make of a motion.

Most chips can read none of the registers. A word is None where it was set before this connection and the chip was not
reset since.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ...calc.ramps.sixpoint import SixPoint
from ...calc.ramps.sixpoint_registers import EIGHT_POINT, REGISTERS, findings, ramp_of
from ...calc.units.tmc5xxx import VELOCITY_MAX, velocity_unit_pps
from ...calc.units.tmc5xxx_times import zero_wait_s
from ...errors import CannotMove
from .roles import FURTHER, RAMP

LONG_WAIT_S = 0.5
"""From this TZEROWAIT on a move tells of it [s]."""
TOLD = {"vstop_zero", "vstop_low", "vstart_above_vstop", "vstart_above_vmax", "d1_zero", "d2_zero", "vmax_beyond"}
"""What a move tells of its ramp; nothing that a user may well have meant."""


@dataclass(frozen=True)
class Ramp:
    """Words by register name, VMAX and AMAX as the user has set them."""

    words: Mapping[str, int | None]
    clock_hz: float

    def __post_init__(self) -> None:
        if set(self.words) not in ({*RAMP}, {*RAMP, *FURTHER}):
            raise ValueError(f"a ramp is {', '.join(RAMP)}, with eight points {', '.join(FURTHER)} besides")

    @property
    def known(self) -> bool:
        return None not in self.words.values()

    @property
    def velocity_unit_pps(self) -> float:
        return velocity_unit_pps(self.clock_hz)

    def pps(self, name: str) -> float | None:
        """A velocity register [pps]."""
        word = self.words[name]
        return None if word is None else word * self.velocity_unit_pps

    def sixpoint(self, vmax: int | None = None, amax: int | None = None) -> SixPoint | None:
        """The ramp with these VMAX and AMAX (None: the user's); None where it is not known or moves nothing."""
        words = dict(self.words)
        if vmax is not None:
            words["VMAX"] = vmax
        if amax is not None:
            words["AMAX"] = amax
        if None in words.values():
            return None
        try:
            registers = EIGHT_POINT if "V2" in words else REGISTERS
            return ramp_of({name: word or 0 for name, word in words.items()}, self.clock_hz, registers)
        except ValueError:
            return None

    def require_acceleration(self, axis: int) -> None:
        """Raises CannotMove where no command can change the velocity."""
        if self.words["AMAX"] == 0:
            raise CannotMove(f"axis {axis} cannot change its speed: AMAX is 0", "write AMAX, 1..65535", axis)

    def require_move(self, axis: int) -> None:
        """Raises CannotMove where no target can be reached."""
        if self.words["VMAX"] == 0:
            raise CannotMove(f"axis {axis} cannot move: VMAX is 0", f"write VMAX, 1..{VELOCITY_MAX}", axis)
        self.require_acceleration(axis)
        v1, v2 = self.words["V1"] or 0, self.words.get("V2") or 0
        needed = ("DMAX", *(("A1", "D1") if v1 else ()), *(("A2", "D2") if v2 > v1 else ()))
        for name in needed:
            if self.words[name] == 0:
                why = f"nothing gets it to V{name[1]}" if name in ("A1", "A2") else "nothing brakes at a target"
                raise CannotMove(f"axis {axis} cannot move: {name} is 0, and {why}", f"write {name}, 1..65535", axis)

    def warnings(self) -> list[str]:
        """What a move by this ramp will do that nobody may want."""
        if not self.known:
            unknown = [name for name, word in self.words.items() if word is None]
            names, were = ", ".join(unknown), "was" if len(unknown) == 1 else "were"
            return [f"{names} cannot be read and {were} set before this connection: nothing is predicted"]
        number = {name: word or 0 for name, word in self.words.items()}
        told = [finding.text for finding in findings(number) if finding.code in TOLD]
        wait_s = zero_wait_s(number["TZEROWAIT"], self.clock_hz)
        if wait_s >= LONG_WAIT_S:
            told.append(f"TZEROWAIT keeps the motor for {wait_s:.2g} s before it turns round")
        return told
