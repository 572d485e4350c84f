"""Where everything is in `fb`, the one flat float64 array of the feedback unit.

`fb[0:k.REALS]` are the float cells of the drive's motor (app/emulators/drive/kernel.py, `k` here and below), so its
physics works on this array as it is. The cells below follow. From `INTEGERS_AT` on the same memory holds int64 cells:
`n` in all the code here is that view. It begins with the drive's int64 cells, so `n` and `fb` are what the
drive calls `s` and `f`.

Register words are kept raw, by address, at `n[WORD + address]`, as they were written last.
"""

# numpy's stubs type a cell as Any; inside compiled code it is an int64 or a float64 and nothing else.
# mypy: disable-error-code="no-any-return"

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from ...drive import kernel as k
from ..compiled import inlined

Cells = NDArray[np.int64]
Floats = NDArray[np.float64]

# --- float cells -----------------------------------------------------------------------------------------------
ENC_POS, X_NEW, SHAFT_FULLSTEPS = range(k.REALS, k.REALS + 3)
"""ENC_POS as registers show it, and XACTUAL-to-be of FB_SET_X (both whole numbers); shaft [full steps of the motor]."""
PLACE, EDGE_AT, LAST_EDGE = range(k.REALS + 3, k.REALS + 6)
"""Encoder before it is cut into counts [counts]; when it counted last; when that was at the last V_ENC [clocks]."""
CLK_FREQ, TURN, PERIOD, REACH = range(k.REALS + 6, k.REALS + 10)
"""CLK_FREQ [Hz]; microsteps a revolution; those of a circular encoder's range (0: it counts on); fraction of a 1/256
full step that the catch-up limiter has in store."""
DUTY_A, DUTY_B = range(k.REALS + 10, k.REALS + 12)
"""Share of the time in which STPOUT_PWMA and DIROUT_PWMB are high."""
COUNT_RATE, COUNT_TURNS = range(k.REALS + 12, k.REALS + 14)
"""Velocity of one count a clock [pps]; turns a count. Divisions are what a tick has no time for."""

MOTOR_CLOCKS = 256
"""Clocks from one step of the motor to the next, as in the drive: every other tick."""
INTEGERS_AT = COUNT_TURNS + 1
"""From here on int64: right behind the last float cell."""

# --- int64 cells (after the drive's) ---------------------------------------------------------------------------
_I = k.INTEGERS
NOW, COMMANDED, PHASE, DIRECTION = range(_I, _I + 4)
"""Clocks since power-on; steps that had been sent at the last tick and phase of the coils since ever [1/256 full step];
-1 with reverse_motor_dir."""
DEV, ANGLE, SATURATED, CL_ISUM, CL_OFFSET, CL_DUE = range(_I + 5, _I + 11)
"""XACTUAL - ENC_POS; angle of the field over the rotor [1/256 full step] and whether CL_BETA cuts it; the catch-up
limiter's integral; CL_OFFSET; clock of the next closed-loop cycle."""
PID_E, PID_LAST, PID_DIFF, PID_ISUM, PID_VEL, PID_COUNT, PID_FRESH = range(_I + 11, _I + 18)
SCALE, SCALE_CLOCKS, STILL, RUNNING, FREE, FS_ACTIVE = range(_I + 18, _I + 24)
"""Current scale in use, 0..255; clocks saved for its next step; clocks without and with motion; freewheeling; full
steps instead of microsteps."""
CURRENT_A, CURRENT_B, CURRENT_A_SPI, CURRENT_B_SPI = range(_I + 24, _I + 28)
COUNTS, NUM, DEN, BASE, BASE_COUNTS = range(_I + 28, _I + 33)
"""Counter of the encoder unit; microsteps a count as a fraction (sign: direction); position, and the count there."""
N_LEVEL, LATCH, LATCH_FLAG, V_ENC, MEAN_Q16, V_AT, V_COUNTS, MEAN_AT, MOVED_AT, VEL0 = range(_I + 33, _I + 43)
"""N condition met; ENC_LATCH and whether it waits to be read; V_ENC [pps], V_ENC_MEAN [1/65536 pps]; clocks and count
of their last updates; clock of the last count; the encoder stands."""
REQUEST_AT, ASKED_AT, SINGLE, TURNS, ANSWERED, ENC_FLAGS, FAILED, DATA_DONE, GLITCH = range(_I + 43, _I + 52)
"""Serial encoder: clock of the next request and of the last one, its single-turn value, turns counted by the chip,
whether there was an answer, its flags, whether it was refused, data of ADDR_FROM_ENC are new, bits to spoil once."""
KIND, PER_TURN, SINGLE_BITS, MULTI_BITS, GRAY, STATUS_BITS, STATUS_WORD = range(_I + 52, _I + 59)
"""The encoder that is really there: as serial_enc_in_mode counts kinds, counts a turn, bits of its answer."""
UNASKED = _I + 60
"""The shaft may have moved since a serial encoder was asked."""
HOT = _I + 59
"""Driver flags as STATUS 31:24 has them, as far as they come from outside: temperature, shorts, unplugged coils."""
DRIVER, POLLED, POLL_AT, SENT_A, SENT_B, SEND_AT, STEP_REST, SETTLED, STRAY, TOLD = range(_I + 61, _I + 71)
"""Of a real driver behind: which it is (0: none), its flags as they were told last, clock of the next question;
currents that it was sent last, and clock from which on the SPI output is free; 1/256 full steps that are no pulse yet;
nothing waits to be sent or asked; currents were sent to a driver that takes none; a datagram of the chip's own went
out since the last look."""
WORD = _I + 72
WAVE = WORD + 128
"""The microstep wave, 1024 values of about -248..247."""
TABLE = INTEGERS_AT + WAVE + 1024
"""From here on in `fb`, `k.TABLE` float cells: what a driver behind makes of its microstep table."""
SIZE = TABLE + k.TABLE

ABN, SSI, SPI = 0, 1, 3
"""serial_enc_in_mode, and kinds of encoders."""
OPEN_LOOP, CLOSED_LOOP, PID_ALONE, PID_OVER_RAMP = range(4)
"""regulation_modus."""

# --- registers ---------------------------------------------------------------------------------------------------
GENERAL_CONF, REFERENCE_CONF, INPUT_FILT_CONF, SPI_OUT_CONF = WORD + 0x00, WORD + 0x01, WORD + 0x03, WORD + 0x04
CURRENT_CONF, SCALE_VALUES, ENC_IN_CONF, ENC_IN_DATA, STEP_CONF = (WORD + a for a in (0x05, 0x06, 0x07, 0x08, 0x0A))
STDBY_DELAY, FREEWHEEL_DELAY, VDRV_SCALE_LIMIT, UP_SCALE_DELAY = (WORD + a for a in (0x15, 0x16, 0x17, 0x18))
DOWN_SCALE_DELAY, DRV_SCALE_DELAY, BOOST_TIME, CL_ANGLES = (WORD + a for a in (0x19, 0x1A, 0x1B, 0x1C))
PWM_FREQ, FREEZE, ENC_RESET_VAL, CL_TR_TOLERANCE, ENC_POS_DEV_TOL = (WORD + a for a in (0x1F, 0x4E, 0x51, 0x52, 0x53))
ENC_IN_RES, SER_CLK, SSI_DELAY, SER_PTIME = WORD + 0x54, WORD + 0x56, WORD + 0x57, WORD + 0x58
GAIN_P, GAIN_I, GAIN_D, I_CLIP_D_DIV, DV_CLIP, TOLERANCE = (WORD + a for a in (0x5A, 0x5B, 0x5C, 0x5D, 0x5E, 0x5F))
"""PID_P, PID_I, PID_D (CL_DELTA_P), their clips, PID_TOLERANCE (CL_TOLERANCE)."""
VMIN_EMF, VADD_EMF, ENC_VEL_ZERO, ENC_VMEAN = WORD + 0x60, WORD + 0x61, WORD + 0x62, WORD + 0x63
"""VMIN_EMF is FS_VEL without closed loop; ENC_VMEAN is SER_ENC_VARIATION and CL_CYCLE with a serial encoder."""
MS_OFFSET, ENC_COMP, START_SIN = WORD + 0x79, WORD + 0x7D, WORD + 0x7E


TMC26X, TMC2130 = 1, 2
"""Drivers behind."""
TMC23X, TMC24X = 8, 9
"""spi_output_format."""


@inlined
def bit(word: int, at: int) -> bool:
    """Whether a bit of a register word is set."""
    return (word >> at) & 1 != 0


@inlined
def wrap32(value: int) -> int:
    """To a signed 32-bit number."""
    return ((value + 0x80000000) & 0xFFFFFFFF) - 0x80000000


@inlined
def wrap10(value: int) -> int:
    """To a place within half an electrical turn, -512..511."""
    return ((value + 512) & 1023) - 512


@inlined
def clip(value: int, limit: int) -> int:
    """To -limit..limit."""
    return min(max(value, -limit), limit)
