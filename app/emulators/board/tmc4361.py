"""What the firmware does with a TMC4361 in the slot: sets it up, moves it, and names its registers as parameters.

The axis parameters are those that PyTrinamic has names for; the closed-loop ones of the firmware (108..137, 200..225)
are refused with status 3: their registers can be reached as such. What it has no parameter for, the driver's board has.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from ...registers.evaluation_board import BoardStatus
from .functions import Parameters, Read, Write
from .refusal import Refusal, invalid_value, wrong_type
from .registers import ChipRegisters
from .tmc2660 import Tmc2660Board

GENERAL_CONF, SPI_OUT_CONF, CURRENT_CONF, SCALE_VALUES, STATUS = 0x00, 0x04, 0x05, 0x06, 0x0F
RAMPMODE, XACTUAL, VACTUAL, VMAX, XTARGET = 0x20, 0x21, 0x22, 0x24, 0x37
POSITION_MODE = 1 << 2
RAMP_TYPE, S_RAMP, TRAPEZOID = 3, 2, 1
VELOCITY_MAX_PPS = 8_000_000
POSITIONING_PPS = 51_200
"""Velocity of positioning until parameter 4 is set [pps]."""
ACCELERATION_BITS = 0x3F_FFFF
PRESETS = {
    0x10: 0x0004_0001,  # STP_LENGTH_ADD 1, DIR_SETUP_TIME 4
    0x20: 0x0000_0001,  # velocity mode, trapezoid
    0x28: 80_000 << 2,  # AMAX
    0x29: 80_000 << 2,  # DMAX
    0x2D: 1000,  # BOW1..BOW4
    0x2E: 1000,
    0x2F: 1000,
    0x30: 1000,
    0x54: 40_000,  # ENC_IN_RES
}
"""What the firmware writes after a reset; every other register that comes up as zero is written with zero."""
OUTPUT_TO_TMC2660 = 0x4440_004B
"""SPI_OUT_CONF with the driver board that goes with the emulated motor: TMC26x, step and direction."""


class Tmc4361Board(Parameters):
    """`BoardFunctions` and those of its one motor. Addresses of `app.registers.tmc4361.table`.

    `reset_chip` pulses the chip's reset pin.
    """

    board_id = 11
    """TMC4361A; the firmware of today does not know 4, the TMC4361 without A."""
    measures_velocity = False

    def __init__(self, registers: ChipRegisters, reset_chip: Callable[[], None]) -> None:
        self.axes = (self,)
        self.driver = Tmc2660Board(registers)
        self._registers = registers
        self._reset_chip = reset_chip
        self._positioning_pps = POSITIONING_PPS
        same = partial(self._register, shift=0)
        known: dict[int, tuple[Read, Write | None]] = {
            0: same(XTARGET),
            1: same(XACTUAL),
            2: (lambda: registers.signed(VMAX) >> 8, self._set_velocity),
            3: (lambda: registers.signed(VACTUAL), None),
            4: (lambda: self._positioning_pps, self._set_positioning_velocity),
            5: self._acceleration(0x28),
            8: (lambda: registers.read(STATUS) & 1, None),
            14: (self._is_s_ramp, self._set_ramp_type),
            15: self._coarse(0x25, 256),
            16: self._acceleration(0x2A),
            17: self._acceleration(0x29),
            18: self._coarse(0x27, 256),
            19: self._acceleration(0x2B),
            20: self._coarse(0x26, 256),
            21: self._coarse(0x2C, 4, ACCELERATION_BITS),
            22: same(0x2D),
            23: same(0x2E),
            24: same(0x2F),
            25: same(0x30),
            26: same(0x33),
            27: same(0x34),
            214: (lambda: registers.signed(0x15), lambda value: registers.write(0x15, value * 160_000)),
        }
        super().__init__(known)

    def power_on(self) -> None:
        """The firmware resets the chip, and sets it up."""
        self.reset()

    def reset(self) -> None:
        """Pulse the chip's reset pin, and write what the firmware writes then."""
        self._reset_chip()
        registers = self._registers
        registers.forget()
        for address in registers.zeroed:
            registers.write(address, PRESETS.get(address, 0))
        registers.write(SPI_OUT_CONF, OUTPUT_TO_TMC2660)
        registers.write(CURRENT_CONF, 3)
        registers.write(SCALE_VALUES, 0)
        registers.write(GENERAL_CONF, 0x6000)
        self.driver.reset()

    # --- motion ----------------------------------------------------------------------------------

    def rotate(self, velocity_pps: int) -> None:
        """Turn at a velocity, by its sign."""
        self._registers.change(RAMPMODE, POSITION_MODE, 0)
        self._set_velocity(velocity_pps)

    def move_to(self, position: int) -> None:
        """Go to a position at the velocity of parameter 4."""
        self._registers.change(RAMPMODE, POSITION_MODE, POSITION_MODE)
        self._set_velocity(self._positioning_pps)
        self._registers.write(XTARGET, position)

    def move_by(self, distance: int) -> int:
        """Go on from where the chip is; the new target."""
        target = (self._registers.signed(XACTUAL) + distance + (1 << 31)) % (1 << 32) - (1 << 31)
        self.move_to(target)
        return target

    # --- axis parameters -------------------------------------------------------------------------

    def _register(self, address: int, shift: int) -> tuple[Read, Write]:
        registers = self._registers
        return lambda: registers.signed(address) >> shift, lambda value: registers.write(address, value << shift)

    def _acceleration(self, address: int) -> tuple[Read, Write]:
        read, write = self._register(address, 2)

        def checked(value: int) -> None:
            if value & ~ACCELERATION_BITS:
                raise invalid_value()
            write(value)

        return read, checked

    def _coarse(self, address: int, factor: int, allowed: int = -1) -> tuple[Read, Write]:
        """The other way round than one would think, and so in the firmware: reading multiplies, writing divides."""
        registers = self._registers

        def write(value: int) -> None:
            if value & ~allowed:
                raise invalid_value()
            registers.write(address, abs(value) // factor * (1 if value >= 0 else -1))

        return lambda: registers.signed(address) * factor, write

    def _set_velocity(self, velocity_pps: int) -> None:
        self._registers.write(VMAX, max(-VELOCITY_MAX_PPS, min(velocity_pps, VELOCITY_MAX_PPS)) << 8)

    def _set_positioning_velocity(self, velocity_pps: int) -> None:
        self._positioning_pps = velocity_pps
        if self._registers.read(RAMPMODE) & POSITION_MODE:
            self._set_velocity(velocity_pps)

    def _is_s_ramp(self) -> int:
        return int(self._registers.read(RAMPMODE) & RAMP_TYPE == S_RAMP)

    def _set_ramp_type(self, value: int) -> None:
        self._registers.change(RAMPMODE, RAMP_TYPE, S_RAMP if value else TRAPEZOID)

    def pass_time(self, until_s: float, chip_s: float) -> None:
        """Nothing that this board does unasked can be seen."""

    # --- user functions --------------------------------------------------------------------------

    def user_function(self, number: int, motor: int, value: int) -> int:
        """Command 144. Switch inputs that the board can pull (0..2) are refused: here they belong to the plant."""
        del motor, value
        if number == 3:  # closed-loop calibration by the firmware; ours is `app.procedures`
            raise Refusal(BoardStatus.DELAYED)
        raise wrong_type()
