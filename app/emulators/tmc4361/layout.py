"""Where everything is in the flat arrays that the clockwork of an emulated TMC4361 works on.

Four arrays. Python writes into them between two calls of `kernel.advance`; nothing else holds state.

- `r` int64[128]: register words by address as they were written last, raw and unsigned. Where reading and writing are
  different registers at one address this is what was written.
- `s` int64[`INTEGERS`]: the chip's counters, flags and timers.
- `f` float64[`REALS`]: velocities [pps], accelerations [pps^2] and the plan of the running ramp.
- `fb` float64: the feedback unit (encoder, regulation, currents, motor): `feedback/layout.py`, which owns it.

The clockwork calls two compiled functions of `feedback/kernel.py`, every `FEEDBACK_CLOCKS`, in this order:

- `regulation_tick(fb, x_actual, velocity_pps) -> float`: the velocity that the step output really gets [pps]: the
  argument itself without a PID, the PID's, or their sum.
- `motor_and_encoder_tick(fb, commanded_position_256ths, velocity_pps, clocks, x_actual, ramp_state) -> int`: what the
  steps sent so far ask of the motor [1/256 full step, since ever], `clocks` after the last call; `ramp_state` is
  STATUS.RAMP_STATE_F (0 constant, 1 rising, 2 falling) | 4 while VACTUAL is not 0 | 8 while frozen. Answers the word
  below.

It reads three cells of `feedback/layout.py`: `ENC_POS` (a whole number), `X_NEW`, `SHAFT_FULLSTEPS`. Python talks to
the unit through `feedback/unit.py`: `FeedbackUnit(options, clock_hz)` with `fb`, `write(address, word)` (told every
register write, takes its own), `read(address) -> int | None` (None: not its register), `reset()` (registers and what
hangs on them; motor and load stay), `change(patch)` and `describe()`.

Time is counted in clocks of the oscillator from power-on of the emulator. The ramp generator and all that it meets are
worked out every `TICK_CLOCKS`, the feedback unit and the motor every `FEEDBACK_CLOCKS`. Pulses and accelerations are
per second of the second that the chip believes in, i.e. `CLK_FREQ` clocks.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Cells = NDArray[np.int64]
Floats = NDArray[np.float64]

TICK_CLOCKS = 64
"""Clocks from one tick to the next: the bow update of 002, 8.2."""
FEEDBACK_CLOCKS = 128
"""Clocks from one call of the feedback unit to the next: the rate of the PID."""
ADDRESSES = 128
NEVER = 1 << 62
"""A tick that does not come."""
SLOW_SLOPE_S = 20.0
"""A trapezoid that takes so long to brake from its highest velocity runs over its target (002, 8.2.2) [s]."""

# --- what the feedback unit tells the clockwork, in one word ---------------------------------------------------
# `motor_and_encoder_tick` returns it. Bits that STATUS (0x0F) has stand where STATUS has them (13, 14, 15, 16, 17, 19,
# 20..23 serial encoder flags, 24..31 driver flags); the others are these. Levels are levels: the clockwork finds edges.
FB_QUIET = 1 << 0
"""Level: nothing in the feedback unit will change until a register, the world or the commanded position does."""
FB_TARGET_OK = 1 << 1
"""Level: the deviation is within CL_TR_TOLERANCE, or nothing regulates: TARGET_REACHED may be told."""
FB_ENC_DONE = 1 << 2
"""Now: ENC_LATCH was written (event 20)."""
FB_LATCH_X = 1 << 3
"""Now: latch_x_on_n took place: the clockwork copies XACTUAL to X_LATCH (event 16)."""
FB_SET_X = 1 << 4
"""Now: XACTUAL becomes `fb[X_NEW]` (cl_clr_xact, cl_velocity_mode_en)."""
FB_ENC_VEL0 = 1 << 5
"""Level: the encoder stands (event 26)."""
FB_CL_MAX = 1 << 6
"""Level: the correction angle is at CL_BETA (event 27)."""
FB_SER_FAIL = 1 << 7
"""Now: a serial encoder's answer was wrong (event 21)."""
FB_SER_DONE = 1 << 8
"""Now: data from the serial encoder for ADDR_FROM_ENC came (event 23)."""
FB_N_EVENT = 1 << 9
"""Now: the N event (home_event 0 waits for it)."""
FB_FS_ACTIVE, FB_ENC_FAIL, FB_N_ACTIVE, FB_ENC_LATCH, FB_MULTI_FAIL, FB_CL_FIT = (
    1 << 13,
    1 << 14,
    1 << 15,
    1 << 16,
    1 << 17,
    1 << 19,
)
FB_STATUS_MASK = 0xFFFB_E000
"""The bits of that word that go into STATUS as they are."""
FB_STALL = 1 << 24
"""Level: the driver's stall flag, STATUS 24."""

# --- cells of `s` ----------------------------------------------------------------------------------------------
TICK, CLOCK, DIRTY, IDLE, WAKE = range(5)
"""Ticks done, clocks done; registers or the world have changed since the last tick; nothing moves; first tick at which
a timer ends."""
X, FIELD, FEEDBACK = range(5, 8)
"""XACTUAL (signed); where the microsteps sent have turned the field [1/256 full step]; last word of the feedback."""
EVENTS, STATUS, FLAGS = range(8, 11)
"""EVENTS; STATUS; conditions whose rising edges are events, by event bit."""
KIND, PLAN_TICK, PIECES, PIECE, STEPPED, GOAL = range(11, 17)
"""What the running plan is for (`IDLING`...), its first tick, its pieces, the one it is in, steps sent since its start,
steps at its end."""
DIR, DIR_READY, HELD, STEPS, EDGES, TOO_FAST, TURNS = range(17, 24)
"""DIROUT (+1, -1), tick from which steps may go out after it changed, steps held back till then; step pulses sent in
all, STPOUT edges, pulses sent faster than the pulse length lets a driver see, direction changes."""
INPUTS, SEEN, RAW, RAW_CLOCK = range(24, 28)
"""Input pins as they are (`PIN_...`), after the filters, and where each began to differ: see `io.py`."""
LBLOCK, RBLOCK, VLBLOCK, VRBLOCK, STALLED, FROZEN = range(28, 34)
"""Directions that a stop has closed; stopped on stall; frozen until reset."""
X_LATCH, REV_CNT, X_RANGE = range(34, 37)
START_AT, STARTED, START_OUT, BUSY, MISSED = range(37, 42)
"""Tick of the start that is under way (`NEVER`: none), starts so far, tick at which the START output ends, starts
till the shadow registers are taken."""
PENDING = 42
"""Bits of start_en whose register waits for a start."""
P_XTARGET, P_VMAX, P_RAMPMODE, P_GEAR = range(43, 47)
"""What is acted on while the register waits."""
EXT_LEFT, EXT_LEVEL = 47, 48
"""Pulses that the external step source still has to give (signed)."""
ZERO_WAIT = 49
"""Tick until which the ramp generator rests after a stop (TZEROWAIT)."""
HOME_SIDE, HOME_FROM, HOME_MARK = range(50, 53)
"""Home tracking: the last level, XACTUAL at the rising edge of the zone, whether one was seen."""
STANDBY, GATED, GATE_AT, STANDBY_AT = range(53, 57)
"""In standby, clock stopped, and the ticks at which that happens."""
FORCE, FORCED = 57, 58
"""Which pins are forced, and to what."""
COVER_DONE, DEFERRED = 59, 60
REACHED_ONCE = 61
FILTER = 62
"""From here: pins with a change on its way, four cells (`PIN` order): clock at which it counts, or `NEVER`."""
INTEGERS = 80

# --- cells of `f` ----------------------------------------------------------------------------------------------
V, A, P = range(3)
"""Velocity [pps], acceleration [pps^2], position since the plan's start [pulses]."""
DT, V_OUT = 3, 4
"""A tick [s of the chip], velocity of the step output [pps]: that of the regulation where one works."""
VMAX, VSTART, VSTOP, VBREAK, AMAX, DMAX, ASTART, DFINAL, DSTOP = range(5, 14)
BOW1, BOW2, BOW3, BOW4, DFREEZE = range(14, 19)
"""The ramp registers in pps, pps^2, pps^3; VMAX signed."""
EXTRA, GEAR, GEAR_SUM, EXT_RATE, EXT_PHASE = range(19, 24)
"""Fraction of a 1/256 full step that regulation has added; GEAR_RATIO and its accumulator; the external source."""
REV_FRACTION = 24
"""CIRCULAR_DEC's share, collected over the turns."""
LEFT_AT, RIGHT_AT, HOME_LOW, HOME_HIGH = range(25, 29)
"""The stage's switches [full steps of the shaft]."""
P0, V0, A0 = range(29, 32)
"""Where a plan starts."""
END_T, END_P, END_V, END_A = range(32, 36)
"""Where a plan under construction has got to."""
BEFORE_P, BEFORE_V, BEFORE_A = range(36, 39)
"""Where the running plan started: a write in the same tick starts there again."""
PLAN = 40
"""Pieces of the plan, `PIECE_CELLS` each: when it begins [s since the plan's start], position, velocity, acceleration
there, jerk."""
PIECE_CELLS, MOST_PIECES = 5, 28
P_T, P_P, P_V, P_A, P_J = range(PIECE_CELLS)
PLAN_END = PLAN + PIECE_CELLS * MOST_PIECES
"""When the plan is over [s since its start]; infinite at constant velocity."""
REALS = PLAN_END + 2

# --- kinds of plans --------------------------------------------------------------------------------------------
IDLING, MOVING, STOPPING, TO_ZERO, FREEZING, EXTERNAL = range(6)
"""At rest; what RAMPMODE asks for; a stop's linear slope; to standstill first and then what RAMPMODE asks for; frozen;
the step input has control."""

# --- pins (bits of INPUTS, SEEN, FORCE, FORCED) ----------------------------------------------------------------
PIN_STOPL, PIN_HOME, PIN_STOPR, PIN_START, PIN_FREEZE = (1 << n for n in range(5))
PINS = 5
