"""The feedback unit's part of the simulation kernel: two functions, called every FEEDBACK_CLOCKS by the chip's kernel.

What the ramp generator sends goes to the sequencer, from there as currents to the driver and the motor with its load;
the encoder on its shaft comes back into ENC_POS and the regulation. Motor and driver are the drive's
(app/emulators/drive), worked out every 256 clocks as there; what regulates it works every 128.
"""

# mypy: disable-error-code="no-any-return"

from __future__ import annotations

import math

import numpy as np

from ...drive import kernel as k
from ..compiled import compiled, inlined
from ..layout import (
    FB_CL_FIT,
    FB_CL_MAX,
    FB_ENC_FAIL,
    FB_ENC_LATCH,
    FB_ENC_VEL0,
    FB_FS_ACTIVE,
    FB_MULTI_FAIL,
    FB_N_ACTIVE,
    FB_QUIET,
    FB_SENT,
    FB_SET_X,
    FB_STALL,
    FB_STALLED,
    FB_TARGET_OK,
    FEEDBACK_CLOCKS,
)
from . import layout as c
from .currents import FROZEN, LONGEST, MOVING, energise
from .driver import drive_behind
from .encoder import encode
from .layout import Cells, Floats, bit, wrap10, wrap32
from .regulation import BACKLOG, CLR_XACT, VELOCITY_MODE_EN, commutate, error_of, pid

CALIBRATION_EN = 24
"""Bit of ENC_IN_CONF."""
STANDSTILL_CLOCKS = 1 << 20
"""Without a step for so long, a TMC26x tells standstill (STST)."""
STST = 1 << 31
STALL_FLAG_INSTEAD_OF_UV, COVERS_ONLY = 7, 12
"""Bits of SPI_OUT_CONF."""
LOAD_SHIFT = 7
"""A TMC24x tells of eight loads where StallGuard2 tells of 1024 (a reading: the emulated load is the same)."""


@compiled
def regulation_tick(fb: Floats, x_actual: int, velocity_pps: float) -> float:
    """Velocity of the step output [pps]: the ramp generator's, the PID's (modus 2) or their sum (modus 3)."""
    n = fb[c.INTEGERS_AT :].view(np.int64)
    if n[c.ENC_IN_CONF] >> 22 & 3 <= c.CLOSED_LOOP:
        return velocity_pps
    return pid(fb, n, x_actual, velocity_pps)


@inlined
def _sequence(fb: Floats, n: Cells, commanded: int, velocity_pps: float, clocks: int) -> None:
    """The coils' phase: by the steps, or by the closed loop. Leaving the loop, the steps go on from where it was."""
    if n[c.ENC_IN_CONF] >> 22 & 3 == c.CLOSED_LOOP:
        commutate(fb, n, velocity_pps, clocks)
    else:
        n[c.PHASE] += n[c.DIRECTION] * (commanded - n[c.COMMANDED])
        n[c.SATURATED] = 0
    n[c.COMMANDED] = commanded


@inlined
def _stall_guard(fb: Floats, n: Cells, velocity_pps: float, before: int) -> None:
    """StallGuard2 of the driver, worked out as the TMC5160's."""
    velocity = int(velocity_pps * 256.0)
    if velocity == 0:
        n[k.V] = n[k.SG_VALID] = 0
        return
    if n[k.V] == 0:
        k.open_window(n, fb)
        n[k.SG_SUM] = n[k.SG_COUNT] = 0
    n[k.V] = velocity
    fb[k.SUM_T] += fb[k.TORQUE]
    fb[k.SUM_I2] += fb[k.IA] * fb[k.IA] + fb[k.IB] * fb[k.IB]
    n[k.SG_TICKS] += 1
    if n[k.LOOK] >> 8 != before >> 8:
        k.stall_guard(n, fb)


@inlined
def _corrected_x(fb: Floats, n: Cells) -> bool:
    """Whether XACTUAL has to follow the encoder, and to where."""
    conf, error = n[c.ENC_IN_CONF], n[c.DEV]
    position = math.floor(fb[c.ENC_POS])
    if bit(conf, CLR_XACT) and abs(error) > n[c.ENC_POS_DEV_TOL] & 0x7FFFFFFF:
        fb[c.X_NEW] = position
        return True
    if conf >> 22 & 3 == c.CLOSED_LOOP and bit(conf, VELOCITY_MODE_EN) and abs(error) > BACKLOG:
        fb[c.X_NEW] = wrap32(position + (BACKLOG if error > 0 else -BACKLOG))
        return True
    return False


@inlined
def _levels(fb: Floats, n: Cells) -> int:
    """The levels of the feedback's word."""
    error = abs(n[c.DEV])
    mode = n[c.ENC_IN_CONF] >> 22 & 3
    word = (n[c.ENC_FLAGS] & 15) << 20 | n[c.HOT] << 24
    if mode == c.OPEN_LOOP or error <= n[c.CL_TR_TOLERANCE] & 0x7FFFFFFF:
        word |= FB_TARGET_OK
    if error > n[c.ENC_POS_DEV_TOL] & 0x7FFFFFFF:
        word |= FB_ENC_FAIL
    if mode == c.CLOSED_LOOP:
        if error <= n[c.TOLERANCE] & 0xFF:
            word |= FB_CL_FIT
        if n[c.SATURATED]:
            word |= FB_CL_MAX
    if n[c.FS_ACTIVE]:
        word |= FB_FS_ACTIVE
    if n[c.N_LEVEL]:
        word |= FB_N_ACTIVE
    if n[c.LATCH_FLAG]:
        word |= FB_ENC_LATCH
    if n[c.FAILED]:
        word |= FB_MULTI_FAIL
    if n[c.VEL0]:
        word |= FB_ENC_VEL0
    if n[c.DRIVER]:
        word = word & 0xFFFFFF | n[c.POLLED] << 24
        if n[c.TOLD]:
            n[c.TOLD] = 0
            if not bit(n[c.SPI_OUT_CONF], COVERS_ONLY):
                word |= FB_SENT
        return word | FB_STALLED if word & FB_STALL else word
    form = n[c.SPI_OUT_CONF] & 15
    if form == c.TMC23X or form == c.TMC24X:
        return _tmc24x(n, word, form)
    if k.stalled(n):
        word |= FB_STALL | FB_STALLED
    if n[c.STILL] >= STANDSTILL_CLOCKS:
        word |= STST
    return word


@inlined
def _tmc24x(n: Cells, word: int, form: int) -> int:
    """The word of a TMC23x or TMC24x: a stall is a load value below STALL_LOAD_LIMIT, and shows where UV does."""
    if form == c.TMC23X:
        return word
    conf = n[c.SPI_OUT_CONF]
    if bit(conf, STALL_FLAG_INSTEAD_OF_UV):
        word &= ~FB_STALL
    if n[k.SG_VALID] and n[k.V] and n[k.SG] >> LOAD_SHIFT < conf >> 8 & 7:
        word |= FB_STALLED
        if bit(conf, STALL_FLAG_INSTEAD_OF_UV):
            word |= FB_STALL
    return word


@inlined
def _quiet(n: Cells, moved: bool, ramp_state: int) -> bool:
    """Whether nothing here will change by itself."""
    if (
        moved
        or not (n[c.SETTLED] if n[c.DRIVER] else n[k.REST])
        or ramp_state & (MOVING | FROZEN) == MOVING
        or not n[c.VEL0]
    ):
        return False
    if n[c.SCALE_CLOCKS] or n[c.STILL] < min(n[c.STDBY_DELAY] + n[c.FREEWHEEL_DELAY] + STANDSTILL_CLOCKS, LONGEST):
        return False
    if n[c.ENC_IN_CONF] >> 22 & 3 > c.CLOSED_LOOP and (n[c.PID_E] or n[c.PID_VEL] or n[c.PID_DIFF]):
        return False
    return n[c.GENERAL_CONF] >> 10 & 3 == c.ABN or not n[c.UNASKED]


@compiled
def motor_and_encoder_tick(
    fb: Floats,
    commanded_position_256ths: int,
    velocity_pps: float,
    clock: int,
    x_actual: int,
    ramp_state: int,
) -> int:
    """One tick of sequencer, driver, motor and encoder; answers the word that app/emulators/tmc4361/layout.py lists.

    `commanded_position_256ths` is what the steps sent so far ask of the field [1/256 full step], `velocity_pps` the
    step output's, `clock` the chip's clocks since power-on, `ramp_state` RAMP_STATE_F | 4 while VACTUAL is not 0 | 8
    while frozen. While the word says FB_QUIET calls may be left out.
    """
    n = fb[c.INTEGERS_AT :].view(np.int64)
    clocks = clock - n[c.NOW]
    n[c.NOW] = clock
    phase, look, rested = n[c.PHASE], n[k.LOOK], n[k.REST] != 0
    motor_too = clock & (c.MOTOR_CLOCKS - 1) < FEEDBACK_CLOCKS
    _sequence(fb, n, commanded_position_256ths, velocity_pps, clocks)
    energise(fb, n, velocity_pps, ramp_state, clocks, motor_too)
    if n[c.DRIVER]:
        drive_behind(fb, n, n[c.PHASE] - phase, clock)
    else:
        _stall_guard(fb, n, velocity_pps, look)
    fb[c.SHAFT_FULLSTEPS] = fb[k.THETA] * fb[k.TEETH] / (math.pi / 2.0)
    turned = motor_too and not (rested and n[k.REST])
    if turned:
        n[c.UNASKED] = 1
    word = encode(fb, n, turned)
    n[c.DEV] = error_of(fb, x_actual)
    conf = n[c.ENC_IN_CONF]
    if bit(conf, CALIBRATION_EN) and conf >> 22 & 3 == c.OPEN_LOOP:
        n[c.CL_OFFSET] = wrap10(n[c.PHASE] - n[c.DIRECTION] * math.floor(fb[c.ENC_POS]))
    if _corrected_x(fb, n):
        word |= FB_SET_X
    word |= _levels(fb, n)
    if motor_too and _quiet(n, n[c.PHASE] != phase, ramp_state):
        word |= FB_QUIET
    return word
