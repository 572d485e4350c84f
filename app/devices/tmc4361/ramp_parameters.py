"""What moves the axis: its ramp registers as they were read in one turn, in pps and pps^2, and what they make of it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ...calc.ramps.sramp_parameters import SRamp
from ...calc.ramps.sramp_trapezoid import Trapezoid
from ...calc.units.tmc4361 import CLOCK_HZ_DEFAULT, CLOCK_HZ_MAX, CLOCK_HZ_MIN, Units
from ...errors import CannotMove, WrongState
from ...registers.model import Register
from . import roles

SHAPES = {roles.HOLD: "hold", roles.TRAPEZOID: "trapezoid", roles.S_SHAPED: "S-ramp"}


@dataclass(frozen=True, slots=True)
class RampParameters:
    """Words by address, of `roles.RAMP` at least."""

    words: Mapping[int, int]

    def value(self, register: Register) -> int:
        return register.decode(self.words[register.address])

    @property
    def mode(self) -> int:
        """RAMPMODE."""
        return self.value(roles.RAMPMODE)

    @property
    def positioning(self) -> bool:
        return bool(self.mode & roles.POSITIONING_BIT)

    @property
    def shape(self) -> int:
        """RAMP_PROFILE; 3, which has no meaning, counts as an S-ramp."""
        return min(self.mode & 3, roles.S_SHAPED)

    @property
    def units(self) -> Units:
        """How the chip counts. A clock that it cannot have is taken for the default."""
        general = roles.GENERAL_CONF.unpack(self.words[roles.GENERAL_CONF.address])
        told_hz = self.value(roles.CLK_FREQ)
        return Units(
            told_hz if CLOCK_HZ_MIN <= told_hz <= CLOCK_HZ_MAX else CLOCK_HZ_DEFAULT,
            bool(general["direct_acc_val_en"]),
            bool(general["direct_bow_val_en"]),
        )

    def pps(self, register: Register) -> float:
        """A ramp register in pps, pps^2 or pps^3."""
        raw = self.value(register)
        if register is roles.ASTART:
            raw &= (1 << 24) - 1  # its highest bit is a sign for something else
        return self.units.from_raw(register.name, raw)

    def s_ramp(self, vmax_pps: float) -> SRamp:
        """The S-ramp's parameters with `vmax_pps` [pps] for VMAX. Raises ValueError where they make none."""
        bow1, bow2, bow3, bow4 = (self.pps(bow) for bow in roles.BOWS)
        return SRamp(
            vmax=vmax_pps,
            amax=self.pps(roles.AMAX),
            dmax=self.pps(roles.DMAX),
            bow1=bow1,
            bow2=bow2,
            bow3=bow3,
            bow4=bow4,
            vstart=self.pps(roles.VSTART),
            vstop=self.pps(roles.VSTOP),
            astart=self.pps(roles.ASTART),
            dfinal=self.pps(roles.DFINAL),
            use_astart_and_vstart=bool(self.value(roles.GENERAL_CONF) & 1),
        )

    def trapezoid(self, vmax_pps: float) -> Trapezoid:
        """The trapezoid's parameters with `vmax_pps` [pps] for VMAX. Raises ValueError where they make none."""
        return Trapezoid(
            vmax=vmax_pps,
            amax=self.pps(roles.AMAX),
            dmax=self.pps(roles.DMAX),
            vstart=self.pps(roles.VSTART),
            vstop=self.pps(roles.VSTOP),
            vbreak=self.pps(roles.VBREAK),
            astart=self.pps(roles.ASTART),
            dfinal=self.pps(roles.DFINAL),
        )

    def gates(self) -> tuple[bool, bool, bool]:
        """Whether XTARGET, VMAX and RAMPMODE wait for a start signal."""
        word = self.words[roles.START_CONF.address]
        return (
            bool(roles.GATE_XTARGET.unpack(word)),
            bool(roles.GATE_VMAX.unpack(word)),
            bool(roles.GATE_RAMPMODE.unpack(word)),
        )

    def never_slows(self) -> bool:
        """Whether the ramp's own numbers would keep a motor from ever coming to rest."""
        if self.shape == roles.HOLD:
            return False
        braking = (roles.DMAX,) if self.shape == roles.TRAPEZOID else (roles.DMAX, *roles.BOWS[2:])
        return any(self.value(register) == 0 for register in braking)

    def require_motion(self, shape: int) -> None:
        """Raises WrongState where no command can move the motor on ramps of that shape."""
        if roles.SDIN_MODE.unpack(self.words[roles.GENERAL_CONF.address]):
            raise WrongState(
                "the steps come from STPIN, not from the ramp generator", "write GENERAL_CONF.sdin_mode 0 first"
            )
        needed = {
            roles.HOLD: (),
            roles.TRAPEZOID: (roles.AMAX, roles.DMAX),
            roles.S_SHAPED: (roles.AMAX, roles.DMAX, *roles.BOWS),
        }[shape]
        for register in needed:
            if self.value(register) == 0:
                raise CannotMove(
                    f"the axis cannot change its speed: {register.name} is 0 and the ramp is a {SHAPES[shape]}",
                    f"write {register.name}",
                    0,
                )
