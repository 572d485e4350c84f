"""The encoder unit: from the shaft's angle to ENC_POS, N events, V_ENC and V_ENC_MEAN.

Facts: tmc4361-encoder-closed-loop, sections 1..4 and 7. What they leave open is read like this:

- ENC_CONST is rounded to its last bit; ENC_POS is the product of all counts and the constant, floored;
- the N channel's pulse is one line long, from count 0 to count 3 of a turn, so polarities of A and B choose one count;
  a level (sensitivity 0) latches and clears with every count as long as it is met; pol_n says which level is active;
- an active N channel is an N event while clr_latch_cont_on_n or clr_latch_once_on_n is set: clear_on_n,
  latch_enc_on_n and latch_x_on_n act on it, and so does home_event 0;
- pulses of A and B that the input filter cannot see (level shorter than its FILT_L + 1 samples) are not counted;
- V_ENC counts between updates and takes the time between the counts; while no count comes it falls with the time gone
  by. With no_enc_vel_preproc it is counts over ENC_VMEAN_INT;
- a serial encoder is asked every SER_PTIME or as often as its answer takes; V_ENC and V_ENC_MEAN follow its answers;
- left_aligned_data: the position comes before the status bits, else after them;
- SER_ENC_VARIATION 0 allows any difference; an answer beyond the limit is dropped and sets STATUS 17.
"""

# mypy: disable-error-code="no-any-return"

from __future__ import annotations

import math

from ...drive import kernel as k
from ..compiled import compiled, inlined
from ..layout import FB_ENC_DONE, FB_LATCH_X, FB_N_EVENT, FB_SER_DONE, FB_SER_FAIL, FEEDBACK_CLOCKS
from . import layout as c
from .layout import Cells, Floats, bit, wrap32

CLEAR_ON_N, CONTINUOUSLY, ONCE, POL_N, POL_A, POL_B, IGNORE_AB, LATCH_ENC, LATCH_X = 1, 2, 3, 4, 7, 8, 9, 10, 11
MULTI_IN, MULTI_SIGNED, CALC_MULTI, MULTI_CYCLE, GRAY_EN, LEFT_ALIGNED, PREPROC_OR_LIMIT = 12, 13, 16, 17, 18, 19, 31
"""Bits of ENC_IN_CONF."""
CIRCULAR_ENC = 31
"""Bit of REFERENCE_CONF; `PERIOD` says the same."""
SSI_REPEAT_CLOCKS = 21e-6
"""An SSI encoder's monoflop needs that long between two values [s]."""


@compiled
def true_place(fb: Floats) -> float:
    """Where the encoder on the shaft really is [counts], not cut and not wrapped."""
    if fb[k.E1] == 0.0 and fb[k.E2] == 0.0 and fb[k.EXS] == 0.0:
        return (fb[k.THETA] + fb[k.SLIP_I] - fb[k.ZERO]) * fb[k.SCALE_I]
    seen = k.internal_angle(fb)
    return (seen + fb[k.EXS] * math.sin(fb[k.LINES] * seen)) * fb[k.SCALE_I]


@compiled
def compensation(fb: Floats, n: Cells, position: int) -> int:
    """What ENC_COMP adds at an encoder position: a triangle with one period a revolution (NOTES-TMC4361-ENCODER 4)."""
    word = n[c.ENC_COMP]
    if word == 0 or fb[c.TURN] <= 0.0:
        return 0
    turn = fb[c.TURN]
    behind = position - (word & 0xFFFF) * turn / 65536.0
    behind -= math.floor(behind / turn) * turn
    half = turn / 2.0
    share = behind / half if behind <= half else 2.0 - behind / half
    lowest = ((word >> 16) + 128 & 0xFF) - 128
    return math.floor(lowest + (word >> 24 & 0xFF) * share + 0.5)


@compiled
def position_at(fb: Floats, n: Cells, counts: int) -> int:
    """ENC_POS at a count: scaled, compensated, wrapped to 32 bits or to the circular range."""
    gone = (counts - n[c.BASE_COUNTS]) * n[c.NUM]
    position = n[c.BASE] + (gone >> 16 if n[c.DEN] == 65536 else gone // n[c.DEN])
    position += compensation(fb, n, position)
    period = fb[c.PERIOD]
    if period > 0.0:
        return position - math.floor(math.floor((position + period / 2.0) / period) * period + 0.5)
    return wrap32(position)


@inlined
def _in_turn(fb: Floats, n: Cells, counts: int) -> int:
    """Place of a count in its turn."""
    place = counts - math.floor(counts * fb[c.COUNT_TURNS]) * n[c.PER_TURN]
    if place < 0:
        return place + n[c.PER_TURN]
    return place - n[c.PER_TURN] if place >= n[c.PER_TURN] else place


@inlined
def _n_condition(fb: Floats, n: Cells, counts: int) -> bool:
    """Whether N, A and B are as pol_n, pol_a_for_n and pol_b_for_n ask."""
    conf = n[c.ENC_IN_CONF]
    if (_in_turn(fb, n, counts) < 4) != bit(conf, POL_N):
        return False
    if bit(conf, IGNORE_AB):
        return True
    state = counts & 3  # forward, A rises first: 00, A, AB, B
    return bit(conf, POL_A) == (state == 1 or state == 2) and bit(conf, POL_B) == (state >= 2)


@inlined
def _n_event(fb: Floats, n: Cells, counts: int) -> int:
    """Latch and clear, as armed."""
    conf = n[c.ENC_IN_CONF]
    if not bit(conf, CONTINUOUSLY) and not bit(conf, ONCE):
        return 0
    word = FB_N_EVENT
    if bit(conf, LATCH_ENC):
        n[c.LATCH] = position_at(fb, n, counts)
        n[c.LATCH_FLAG] = 1
        word |= FB_ENC_DONE
    if bit(conf, LATCH_X):
        word |= FB_LATCH_X
    if bit(conf, CLEAR_ON_N):
        n[c.BASE] = wrap32(n[c.ENC_RESET_VAL])
        n[c.BASE_COUNTS] = counts
    n[c.ENC_IN_CONF] = conf & ~(1 << ONCE)
    return word


_REPEATS = 8
"""Two times four counts: behind them, and before them, nothing happens that has not happened, or will not."""


@compiled
def pass_counts(fb: Floats, n: Cells, old: int, new: int) -> int:
    """What the N channel makes of the counts between two ticks."""
    conf = n[c.ENC_IN_CONF]
    per_turn = n[c.PER_TURN]
    way = 1 if new > old else -1
    low = min(old, new)
    place = _in_turn(fb, n, low)
    if bit(conf, POL_N) and place >= 4 and place + abs(new - old) < per_turn:
        n[c.N_LEVEL] = 0  # far from the pulse
        return 0
    sensitivity = conf >> 5 & 3
    word = 0
    at = old
    if abs(new - old) > 2 * per_turn:  # turned by hand: the last two turns tell everything
        at = new - way * 2 * per_turn
    passed = 0
    while at != new:
        if passed >= _REPEATS:  # between two pulses A and B say the same every four counts
            place = _in_turn(fb, n, at)
            left = min(per_turn - 1 - place if way > 0 else place - 4, abs(new - at)) if place >= 4 else 0
            if left > 2 * _REPEATS:
                at += way * ((left - _REPEATS) // 4 * 4)
                passed = 0
        passed = passed + 1 if _in_turn(fb, n, at + way) >= 4 else 0
        at += way
        met = _n_condition(fb, n, at)
        was = n[c.N_LEVEL] != 0
        n[c.N_LEVEL] = met
        if sensitivity == 0:
            happens = met
        else:
            happens = (met and not was and sensitivity != 2) or (was and not met and sensitivity != 1)
        if happens:
            word |= _n_event(fb, n, at)
    return word


@inlined
def _filtered_out(n: Cells, delta: int) -> bool:
    """Whether A and B change too fast for INPUT_FILT_CONF: each holds a level for two counts."""
    filtering = n[c.INPUT_FILT_CONF]
    needed = ((filtering >> 4 & 7) + 1) << (filtering & 7)
    return needed > 1 and abs(delta) * needed > 2 * c.MOTOR_CLOCKS


@compiled
def _count(fb: Floats, n: Cells) -> int:
    """An ABN encoder after a step of the motor."""
    place = true_place(fb)
    counts = math.floor(place + 0.5)
    delta = counts - n[c.COUNTS]
    word = 0
    if delta != 0:
        if n[c.KIND] != c.ABN or _filtered_out(n, delta):
            n[c.BASE_COUNTS] += delta
            n[c.V_COUNTS] += delta
        else:
            word = pass_counts(fb, n, n[c.COUNTS], counts)
            # when it counted last, by how far the shaft has gone on since
            border = counts - 0.5 if delta > 0 else counts + 0.5
            since = (place - border) / (place - fb[c.PLACE]) if place != fb[c.PLACE] else 0.0
            fb[c.EDGE_AT] = n[c.NOW] - min(max(since, 0.0), 1.0) * c.MOTOR_CLOCKS
            n[c.MOVED_AT] = n[c.NOW]
            n[c.VEL0] = 0
        n[c.COUNTS] = counts
        fb[c.ENC_POS] = position_at(fb, n, counts)
    fb[c.PLACE] = place
    return word


@inlined
def _speed(fb: Floats, n: Cells) -> None:
    """V_ENC every ENC_VMEAN_INT, V_ENC_MEAN every ENC_VMEAN_WAIT, both zero after ENC_VEL_ZERO without a count."""
    if n[c.VEL0]:
        n[c.V_AT] = n[c.MEAN_AT] = n[c.NOW]
        return
    now = n[c.NOW]
    word = n[c.ENC_VMEAN]
    interval = max(word >> 16 & 0xFFFF, 256)
    gone = now - n[c.V_AT]
    if gone >= interval:
        counted = n[c.COUNTS] - n[c.V_COUNTS]
        scale = fb[c.COUNT_RATE]
        if bit(n[c.ENC_IN_CONF], PREPROC_OR_LIMIT):
            n[c.V_ENC] = math.floor(counted * scale / gone + 0.5)
        elif counted != 0:
            lasted = fb[c.EDGE_AT] - fb[c.LAST_EDGE]
            n[c.V_ENC] = math.floor(counted * scale / lasted + 0.5) if lasted > 0.0 else 0
            fb[c.LAST_EDGE] = fb[c.EDGE_AT]
        elif now - fb[c.LAST_EDGE] > 0.0:
            most = math.floor(abs(scale) / (now - fb[c.LAST_EDGE]))
            n[c.V_ENC] = min(max(n[c.V_ENC], -most), most)
        n[c.V_COUNTS] = n[c.COUNTS]
        n[c.V_AT] = now
    wait = max(word & 0xFF, 32)
    if word >> 8 & 15 == 0:  # no filter
        n[c.MEAN_Q16] = n[c.V_ENC] * 65536
        n[c.MEAN_AT] = now
    while now - n[c.MEAN_AT] >= wait:
        n[c.MEAN_AT] += wait
        _filter(n)
    if now - n[c.MOVED_AT] >= n[c.ENC_VEL_ZERO] & 0xFFFFFF:
        n[c.VEL0] = 1
        n[c.V_ENC] = n[c.MEAN_Q16] = 0


@inlined
def _filter(n: Cells) -> None:
    """One step of V_ENC_MEAN."""
    n[c.MEAN_Q16] += (n[c.V_ENC] * 65536 - n[c.MEAN_Q16]) >> (n[c.ENC_VMEAN] >> 8 & 15)


@inlined
def _frame(n: Cells, turns: int, single: int) -> int:
    """The bits that the encoder sends: turns, place in the turn, status, first bit highest."""
    value = (turns & ((1 << n[c.MULTI_BITS]) - 1)) << n[c.SINGLE_BITS] | single
    if n[c.GRAY]:
        value ^= value >> 1
    return value << n[c.STATUS_BITS] | n[c.STATUS_WORD]


@inlined
def _from_gray(value: int) -> int:
    """Gray code to number."""
    shift = 1
    while shift < 64:
        value ^= value >> shift
        shift <<= 1
    return value


@compiled
def _answer(fb: Floats, n: Cells) -> int:
    """The bits that the chip clocks in, and what the encoder on the shaft sends then. A wrong kind sends zeros."""
    if n[c.KIND] != n[c.GENERAL_CONF] >> 10 & 3:
        return 0
    data, conf = n[c.ENC_IN_DATA], n[c.ENC_IN_CONF]
    wanted = (data & 31) + 1 + (data >> 10 & 3)
    if bit(conf, MULTI_IN):
        wanted += (data >> 5 & 31) + 1
    counts = math.floor(true_place(fb) + 0.5)
    turns = counts // n[c.PER_TURN]
    frame = _frame(n, turns, counts - turns * n[c.PER_TURN])
    spare = n[c.SINGLE_BITS] + n[c.MULTI_BITS] + n[c.STATUS_BITS] - wanted
    frame = frame >> spare if spare >= 0 else frame << -spare
    frame ^= n[c.GLITCH] & ((1 << wanted) - 1)
    n[c.GLITCH] = 0
    return frame


@compiled
def _ask(fb: Floats, n: Cells) -> int:
    """One request of a serial encoder: ENC_POS and the velocities from its answer."""
    conf, data = n[c.ENC_IN_CONF], n[c.ENC_IN_DATA]
    flags_wide = data >> 10 & 3
    single_wide = (data & 31) + 1
    multi_wide = (data >> 5 & 31) + 1 if bit(conf, MULTI_IN) else 0
    word = _answer(fb, n)
    if bit(conf, MULTI_CYCLE) and n[c.GENERAL_CONF] >> 10 & 3 == c.SSI and word != _answer(fb, n):
        n[c.FAILED] = 1
        return FB_SER_FAIL
    wide = single_wide + multi_wide
    if bit(conf, LEFT_ALIGNED):
        n[c.ENC_FLAGS] = word & ((1 << flags_wide) - 1)
        value = word >> flags_wide
    else:
        n[c.ENC_FLAGS] = word >> wide & ((1 << flags_wide) - 1)
        value = word & ((1 << wide) - 1)
    if bit(conf, GRAY_EN):
        value = _from_gray(value)
    turn = 1 << single_wide
    single = value & (turn - 1)
    turns = value >> single_wide
    if multi_wide and bit(conf, MULTI_SIGNED) and turns >> (multi_wide - 1):
        turns -= 1 << multi_wide
    moved = single - n[c.SINGLE]
    moved -= (moved * 2 + turn) // (2 * turn) * turn  # the shorter way around
    if multi_wide:
        moved = turns * turn + single - n[c.COUNTS]
    if not n[c.ANSWERED]:
        moved = 0
    limit = n[c.ENC_VMEAN] & 0xFF
    if bit(conf, PREPROC_OR_LIMIT) and limit and abs(moved) * 2048 > limit * (n[c.ENC_IN_RES] & 0x7FFFFFFF):
        n[c.FAILED] = 1
        return FB_SER_FAIL
    n[c.FAILED] = 0
    if not multi_wide:
        if bit(conf, CALC_MULTI) and n[c.ANSWERED]:
            turns = (n[c.SINGLE] + n[c.TURNS] * turn + moved) // turn
        else:
            turns = n[c.TURNS] if bit(conf, CALC_MULTI) else 0
    n[c.SINGLE], n[c.TURNS] = single, turns
    n[c.COUNTS] = turns * turn + single
    gone = n[c.NOW] - n[c.ASKED_AT]
    if n[c.ANSWERED] and gone > 0:
        n[c.V_ENC] = math.floor(moved * fb[c.COUNT_RATE] / gone + 0.5)
        _filter(n)
    n[c.ANSWERED] = 1
    n[c.ASKED_AT] = n[c.NOW]
    fb[c.ENC_POS] = position_at(fb, n, n[c.COUNTS])
    if moved != 0:
        n[c.MOVED_AT] = n[c.NOW]
        n[c.VEL0] = 0
    elif n[c.NOW] - n[c.MOVED_AT] >= n[c.ENC_VEL_ZERO] & 0xFFFFFF:
        n[c.VEL0] = 1
        n[c.V_ENC] = n[c.MEAN_Q16] = 0
    return 0


@inlined
def _request_period(fb: Floats, n: Cells) -> int:
    """Clocks from one request to the next: SER_PTIME, unless the answer takes longer."""
    data, conf = n[c.ENC_IN_DATA], n[c.ENC_IN_CONF]
    wide = (data & 31) + 1 + (data >> 10 & 3)
    if bit(conf, MULTI_IN):
        wide += (data >> 5 & 31) + 1
    a_bit = (n[c.SER_CLK] & 0xFFFF) + (n[c.SER_CLK] >> 16 & 0xFFFF)
    lasts = wide * a_bit
    if n[c.GENERAL_CONF] >> 10 & 3 == c.SSI:
        lasts += n[c.SSI_DELAY] & 0xFFFF
        if bit(conf, MULTI_CYCLE):
            lasts += lasts + (n[c.SSI_DELAY] >> 16 & 0xFFFF)
        lasts += math.ceil(SSI_REPEAT_CLOCKS * fb[c.CLK_FREQ])
    return max(n[c.SER_PTIME] & 0xFFFFF, lasts)


@inlined
def _serial(fb: Floats, n: Cells) -> int:
    """A tick of an SSI or SPI encoder. Requests of ticks that were passed over had the answer that is known."""
    word = 0
    last = n[c.NOW] - FEEDBACK_CLOCKS
    if n[c.REQUEST_AT] <= last:
        period = max(_request_period(fb, n), 1)
        n[c.REQUEST_AT] += ((last - n[c.REQUEST_AT]) // period + 1) * period
        asked = n[c.REQUEST_AT] - period
        n[c.ASKED_AT] = max(n[c.ASKED_AT], (asked + FEEDBACK_CLOCKS - 1) // FEEDBACK_CLOCKS * FEEDBACK_CLOCKS)
    if n[c.NOW] >= n[c.REQUEST_AT]:
        n[c.UNASKED] = 0
        word = _ask(fb, n)
        n[c.REQUEST_AT] = max(n[c.REQUEST_AT] + _request_period(fb, n), n[c.NOW])
        if n[c.DATA_DONE]:
            n[c.DATA_DONE] = 0
            word |= FB_SER_DONE
    return word


@compiled
def encode(fb: Floats, n: Cells, turned: bool) -> int:
    """A tick of the encoder unit, the shaft having `turned` or not; answers the "now" bits of the feedback's word."""
    if n[c.GENERAL_CONF] >> 10 & 3 == c.ABN:
        word = _count(fb, n) if turned else 0
        _speed(fb, n)
        return word
    return _serial(fb, n)
