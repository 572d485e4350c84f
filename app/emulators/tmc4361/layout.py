"""Where everything is in the flat arrays that the simulation kernel of an emulated TMC4361 works on.

Four arrays. Python writes into them between two calls of `kernel.advance`; nothing else holds state.

- `r` int64[128]: register words by address as they were written last, raw and unsigned. Where reading and writing are
  different registers at one address this is what was written.
- `s` int64[`INTEGERS`]: the chip's counters, flags and timers.
- `f` float64[`REALS`]: velocities [pps], accelerations [pps^2] and the plan of the running ramp.
- `fb` float64: the feedback unit (encoder, regulation, currents, motor): `feedback/layout.py`, which owns it.

The kernel calls two compiled functions of `feedback/kernel.py`, every `FEEDBACK_CLOCKS`, in this order:

- `regulation_tick(fb, x_actual, velocity_pps) -> float`: the velocity that the step output really gets [pps]: the
  argument itself without a PID, the PID's, or their sum.
- `motor_and_encoder_tick(fb, commanded_position_256ths, velocity_pps, clock, x_actual, ramp_state) -> int`: what the
  steps sent so far ask of the motor [1/256 full step, since ever], at this clock; `ramp_state` is
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
"""Clocks from one tick to the next: the bow update of DS-TMC4361 8.2."""
FEEDBACK_CLOCKS = 128
"""Clocks from one call of the feedback unit to the next: the rate of the PID."""
ADDRESSES = 128
NEVER = 1 << 62
"""A tick that does not come."""
SLOW_SLOPE_S = 20.0
"""A trapezoid that takes so long to brake from its highest velocity runs over its target (DS-TMC4361 8.2.2) [s]."""

# --- what the feedback unit tells the kernel, in one word ---------------------------------------------------
# `motor_and_encoder_tick` returns it. Bits that STATUS (0x0F) has stand where STATUS has them (13, 14, 15, 16, 17, 19,
# 20..23 serial encoder flags, 24..31 driver flags); the others are these. Levels are levels: the kernel finds edges.
FB_QUIET = 1 << 0
"""Level: nothing in the feedback unit will change until a register, the plant or the commanded position does."""
FB_TARGET_OK = 1 << 1
"""Level: the deviation is within CL_TR_TOLERANCE, or nothing regulates: TARGET_REACHED may be told."""
FB_ENC_DONE = 1 << 2
"""Now: ENC_LATCH was written (event 20)."""
FB_LATCH_X = 1 << 3
"""Now: latch_x_on_n took place: the kernel copies XACTUAL to X_LATCH (event 16)."""
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
FB_SENT = 1 << 11
"""Now: a datagram that the chip sends by itself went out to the driver (event 25)."""
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
"""Level: the driver's stall flag, STATUS 24; of a TMC23x or TMC24x that is its undervoltage."""
FB_STALLED = 1 << 10
"""Level: the driver tells of a stall, whatever STATUS 24 shows."""

# --- cells of `s` ----------------------------------------------------------------------------------------------
TICK, CLOCK, IDLE, WAKE = range(4)
"""Ticks done, clocks done; nothing moves; tick at which a timer ends that then."""
X, FIELD, FEEDBACK = range(4, 7)
"""XACTUAL (signed); where the microsteps sent have turned the field [1/256 full step]; last word of the feedback."""
EVENTS, STATUS, FLAGS, PULSES = range(7, 11)
"""EVENTS; STATUS; conditions whose rising edges are events, by event bit (and the selected driver flags from bit 32);
events of this tick that are no conditions."""
KIND, PLAN_TICK, PIECES, PIECE, STEPPED = range(11, 16)
"""What the running plan is for (`IDLING`...), its first tick, its pieces, the one it is in, steps since its start."""
CORRECTS, CLOSED = range(16, 18)
"""The next ramp corrects one that missed; directions that a stop has closed (1 negative, 2 positive)."""
DIR, READY, HELD, FREE, DRAIN = range(18, 23)
"""DIROUT (+1, -1), clock from which steps may go out after it changed, steps held back, clock from
which the next pulse may begin, steps held back by DIR_SETUP_TIME are still going out."""
STEPS, TOO_FAST, TURNS = range(23, 26)
"""Step pulses sent since power-on, pulses that merged with the one before, changes of direction."""
INPUTS, SEEN = range(26, 28)
"""Input pins as they are (`PIN_...`), and after the filters."""
LBLOCK, RBLOCK, VLBLOCK, VRBLOCK, STALLED, FROZEN = range(28, 34)
"""Stops that still close their direction (until the event is cleared); stopped on stall; frozen until reset."""
X_LATCH, REV_CNT, X_RANGE, SURPLUS = range(34, 38)
"""Latched XACTUAL; turns of circular motion, half its range, steps made on the seam that XACTUAL does not count."""
START_AT, STARTED, START_OUT, MISSED = range(38, 42)
"""Tick of the start that is under way (`NEVER`: none), starts so far, tick at which the START output ends, starts
till the shadow registers are taken."""
PENDING = 42
"""Bits of start_en whose register waits for a start."""
ACT_XTARGET, ACT_VMAX, ACT_RAMPMODE, ACT_GEAR = range(43, 47)
"""What is acted on (raw words, XTARGET signed): the registers, unless they wait."""
EXT_LEFT = 47
"""Pulses that the external step source still has to give (signed)."""
ZERO_WAIT = 48
"""Tick until which the ramp generator rests after a stop (TZEROWAIT)."""
HOME_ENTERED, HOME_AT = 49, 50
"""Home tracking by the centre: the zone was entered, and where."""
STANDBY, STANDBY_AT, GATED, GATE_AT = range(51, 55)
"""In standby, clocks stopped, and the ticks at which that happens."""
FORCE, FORCED = 55, 56
"""Which pins are forced, and to what."""
COVER_AT = 57
"""Tick at which the cover datagram is through."""
REPLAN = 58
"""The ramp generator has to plan anew before the next tick."""
ZONE = 59
"""The virtual stop on whose side the closed zone of circular motion was entered: 0, 1, 2."""
PASSING = 60
"""A change is on its way through a filter."""
BEYOND = 61
"""How far the compared position is beyond the compare position."""
WATCH = 62
"""Whether time stops at the next change of what START puts out."""
NET = 63
"""Steps sent since power-on, those backwards taken off."""
FILTER = 64
"""From here, for each pin (in bit order): clock at which a change counts, or `NEVER`."""
DC_WAIT, DC_FREE = 69, 70
"""dcStep: ticks for which the ramp has waited for the motor; microsteps that go out whether it follows or not."""
INTEGERS = 72

# --- cells of `f` ----------------------------------------------------------------------------------------------
V, A, P = range(3)
"""Velocity [pps], acceleration [pps^2], position since the plan's start [pulses]."""
DT, V_OUT = 3, 4
"""A tick [s of the chip], velocity of the step output [pps]: that of the regulation where one works."""
VMAX, VSTART, VSTOP, VBREAK, AMAX, DMAX, ASTART, DFINAL, DSTOP = range(5, 14)
BOW1, BOW2, BOW3, BOW4, DFREEZE = range(14, 19)
"""The ramp registers in pps, pps^2, pps^3; VMAX signed."""
EXTRA, GEAR, GEAR_SUM, EXT_RATE, EXT_PHASE = range(19, 24)
"""Fraction of a 1/256 full step that regulation has added; GEAR_RATIO and its accumulator; external pulses a tick, and
what is left of one."""
REV_SURPLUS = 24
"""Microsteps that a turn of circular motion has more than its range (CIRCULAR_DEC)."""
LEFT_AT, RIGHT_AT, HOME_LOW, HOME_HIGH = range(25, 29)
"""The stage's switches [full steps of the shaft]."""
P0, V0, A0 = range(29, 32)
"""Where a plan starts."""
END_T, END_P, END_V, END_A = range(32, 36)
"""Where a plan under construction has got to."""
BEFORE_P, BEFORE_V, BEFORE_A, GOAL = range(36, 40)
"""Where the running plan started: a write in the same tick starts there again. Where it ends [pulses]."""
PLAN = 40
"""Pieces of the plan, `PIECE_CELLS` each: when it begins [s since the plan's start], position, velocity, acceleration
there, jerk."""
PIECE_CELLS, MOST_PIECES = 5, 28
P_T, P_P, P_V, P_A, P_J = range(PIECE_CELLS)
PLAN_END = PLAN + PIECE_CELLS * MOST_PIECES
"""When the plan is over [s since its start]; infinite at constant velocity."""
REALS = PLAN_END + 2

# --- kinds of plans --------------------------------------------------------------------------------------------
IDLING, MOVING, TO_ZERO, STOPPING, FREEZING, EXTERNAL = range(6)
"""At rest; what RAMPMODE asks for; to standstill first and then what RAMPMODE asks for; a stop's linear slope; the
same of NFREEZE; the step input has control."""

# --- pins (bits of INPUTS, SEEN, FORCE, FORCED) ----------------------------------------------------------------
PIN_STOPL, PIN_HOME, PIN_STOPR, PIN_START, PIN_FREEZE = (1 << n for n in range(5))
PINS = 5

# --- register addresses -------------------------------------------------------------------------------------------
GENERAL_CONF, REFERENCE_CONF, START_CONF, INPUT_FILT_CONF, STEP_CONF = 0x00, 0x01, 0x02, 0x03, 0x0A
DC_VEL, DC_LSPTM = 0x60, 0x62
SPI_STATUS_SELECTION, EVENT_CLEAR_CONF, INTR_CONF, R_EVENTS, R_STATUS = 0x0B, 0x0C, 0x0D, 0x0E, 0x0F
STP_LENGTH, START_OUT_ADD, GEAR_RATIO, START_DELAY, CLK_GATING_DELAY, STDBY_DELAY = range(0x10, 0x16)
HOME_SAFETY_MARGIN, RAMPMODE, XACTUAL, VACTUAL, AACTUAL = 0x1E, 0x20, 0x21, 0x22, 0x23
R_VMAX, R_VSTART, R_VSTOP, R_VBREAK, R_AMAX, R_DMAX, R_ASTART, R_DFINAL, R_DSTOP = range(0x24, 0x2D)
R_BOW1, R_BOW2, R_BOW3, R_BOW4, CLK_FREQ, POS_COMP, VIRT_STOP_LEFT, VIRT_STOP_RIGHT = range(0x2D, 0x35)
X_HOME, R_X_LATCH, XTARGET, X_PIPE0, SH_REG0, FREEZE, RESET_CLK_GATING = 0x35, 0x36, 0x37, 0x38, 0x40, 0x4E, 0x4F
VSTALL_LIMIT, COVER_LOW, COVER_HIGH, COVER_DRV_LOW, COVER_DRV_HIGH = 0x67, 0x6C, 0x6D, 0x6E, 0x6F
TZEROWAIT, CIRCULAR_DEC, VERSION = 0x7B, 0x7C, 0x7F
