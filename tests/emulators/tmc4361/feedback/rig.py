"""A feedback unit on a bench: a ramp generator that does what the test says, and a hand that turns the shaft."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numba import njit
from numpy.typing import NDArray

from app.emulators.tmc4361.feedback import FeedbackOptions, FeedbackPatch, FeedbackUnit
from app.emulators.tmc4361.feedback import layout as c
from app.emulators.tmc4361.feedback.kernel import motor_and_encoder_tick, regulation_tick
from app.emulators.tmc4361.layout import FB_SET_X

F_CLK = 16e6
TICK_S = 128 / F_CLK
MOTOR_S = 2 * TICK_S
TURN = 51_200

GENERAL_CONF, REFERENCE_CONF, INPUT_FILT_CONF, SPI_OUT_CONF, CURRENT_CONF, SCALE_VALUES = 0, 1, 3, 4, 5, 6
ENC_IN_CONF, ENC_IN_DATA, STEP_CONF = 0x07, 0x08, 0x0A
STDBY_DELAY, FREEWHEEL_DELAY, VDRV_SCALE_LIMIT, PWM_VMAX = 0x15, 0x16, 0x17, 0x17
UP_SCALE_DELAY, HOLD_SCALE_DELAY, DRV_SCALE_DELAY, BOOST_TIME, CL_ANGLES, PWM_FREQ = 0x18, 0x19, 0x1A, 0x1B, 0x1C, 0x1F
X_RANGE, FREEZE = 0x36, 0x4E
ENC_POS, ENC_LATCH, ENC_RESET_VAL, ENC_POS_DEV, CL_TR_TOLERANCE, ENC_POS_DEV_TOL = 0x50, 0x51, 0x51, 0x52, 0x52, 0x53
ENC_IN_RES, ENC_CONST, SER_PTIME, CL_OFFSET = 0x54, 0x54, 0x58, 0x59
PID_P, PID_I, PID_D, PID_CLIP, PID_DV_CLIP, PID_TOLERANCE = 0x5A, 0x5B, 0x5C, 0x5D, 0x5E, 0x5F
PID_VEL, PID_ISUM, PID_E = 0x5A, 0x5B, 0x5D
CL_VMIN_EMF, CL_VADD_EMF, ENC_VEL_ZERO, ENC_VMEAN = 0x60, 0x61, 0x62, 0x63
V_ENC, V_ENC_MEAN, MSCNT, CURRENTS, CURRENTS_SPI, SCALE_PARAM, ENC_COMP = 0x65, 0x66, 0x79, 0x7A, 0x7B, 0x7C, 0x7D

CLOSED_LOOP, PID_ALONE, PID_OVER_RAMP = (mode << 22 for mode in (1, 2, 3))
CALIBRATION = 1 << 24


def _loop(fb: Any, state: Any, ticks: int, velocity: float, ramp_state: int) -> int:
    """`state`: XACTUAL, commanded position, last word, clock. A sum of many ticks may miss a step by its rounding."""
    seen = 0
    word = 0
    spare = 1e-6
    for _ in range(ticks):
        state[0] += velocity * 128.0 / 16e6
        state[3] += 128.0
        out = regulation_tick(fb, math.floor(state[0] + spare), velocity)
        state[1] += out * 128.0 / 16e6
        word = motor_and_encoder_tick(
            fb, math.floor(state[1] + spare), out, int(state[3]), math.floor(state[0] + spare), ramp_state
        )
        seen |= word
        if word & FB_SET_X:
            state[0] = fb[c.X_NEW]
    state[2] = float(word)
    return seen


_compiler: Any = njit
_run: Any = _compiler(nogil=True, error_model="numpy", _nrt=False)(_loop)


def signed(word: int | None, bits: int = 32) -> int:
    assert word is not None
    half = 1 << (bits - 1)
    return int((word & (1 << bits) - 1 ^ half) - half)


class Bench:
    """One unit with 256 microsteps a full step, ENC_IN_RES set for its encoder."""

    def __init__(self, registers: Mapping[int, int] | None = None, **options: Any) -> None:
        self.unit = FeedbackUnit(FeedbackOptions(**options), F_CLK)
        self.state: NDArray[np.float64] = np.zeros(4)
        self.seen = 0
        self.write({ENC_IN_RES: self.unit.options.encoder.counts} | dict(registers or {}))

    def write(self, registers: Mapping[int, int]) -> None:
        for address, word in registers.items():
            self.unit.write(address, word)

    def read(self, address: int) -> int:
        """A register as a signed number."""
        return signed(self.unit.read(address))

    def change(self, **patch: Any) -> None:
        self.unit.change(FeedbackPatch(**patch))

    @property
    def x(self) -> int:
        """XACTUAL."""
        return math.floor(float(self.state[0]) + 1e-6)

    @x.setter
    def x(self, value: int) -> None:
        self.state[0] = value

    @property
    def word(self) -> int:
        """The last word to the kernel."""
        return int(self.state[2])

    @property
    def rotor(self) -> float:
        """Where the rotor is [microsteps]."""
        return self.unit.plant_state.rotor_fullsteps * 256

    def run(self, seconds: float, velocity: float = 0.0, ramp_state: int | None = None) -> int:
        """Let the ramp generator send steps at a constant velocity [pps]; the bits that were set meanwhile."""
        return self.ticks(round(seconds / TICK_S), velocity, ramp_state)

    def ticks(self, count: int, velocity: float = 0.0, ramp_state: int | None = None) -> int:
        if ramp_state is None:
            ramp_state = 4 if velocity else 0
        seen = int(_run(self.unit.fb, self.state, count, velocity, ramp_state))
        self.seen |= seen
        return seen

    def accelerate(self, start: float, end: float, seconds: float) -> None:
        """From one velocity to another, every quarter of a millisecond a little."""
        total = round(seconds / TICK_S)
        parts = max(total // 32, 1)
        for part in range(parts):
            velocity = start + (end - start) * (part + 0.5) / parts
            count = total * (part + 1) // parts - total * part // parts
            self.ticks(count, velocity, 4 | (1 if abs(end) > abs(start) else 2))

    def move(self, velocity: float, ramp_s: float, at_speed_s: float) -> None:
        """There and stop."""
        self.accelerate(0.0, velocity, ramp_s)
        self.run(at_speed_s, velocity)
        self.accelerate(velocity, 0.0, ramp_s)

    def turn_by_hand(self, microsteps: float) -> None:
        """Put the shaft there, and let the encoder see it. The motor has to be let go: `loose()`."""
        self.change(rotor_fullsteps=microsteps / 256)
        self.ticks(2)

    def calibrate(self, conf: int = 0, align: bool = True) -> None:
        """The vendor's procedure, NOTES-TMC4361-ENCODER 6, then closed loop with `conf`.

        `align`: ENC_POS is set to XACTUAL first, so that closing the loop moves nothing.
        """
        self.run(0.1)
        while (offset := (128 - int(self.unit.read(MSCNT) or 0)) % 256) != 0:
            self.run(offset / 10_000, 10_000)
        self.run(0.1)
        if align:
            self.write({ENC_POS: self.x & 0xFFFFFFFF})
        self.write({ENC_IN_CONF: conf | CALIBRATION})
        self.run(0.01)
        self.write({ENC_IN_CONF: conf | CLOSED_LOOP})
        self.run(0.01)


def loose(registers: Mapping[int, int] | None = None, **options: Any) -> Bench:
    """A bench whose shaft stays where it is put: the motor is unplugged and the shaft clamped."""
    bench = Bench(registers, **options)
    bench.change(connected=False, blocked=True)
    return bench
