"""The ramp generator of TMC428 and TMC4210 in exact integers, run from event to event.

The data sheets (DS-TMC428 and DS-TMC4210) do not print the law by which the chip picks its target velocity. This is a
reading of them that reproduces their statements:

- the velocity has 8 fractional bits; a ramp tick (every 32 * 2^ramp_div clocks) moves it toward the target
  velocity by at most a_max of them (DS-TMC428 8.11);
- a pulse tick (every 32 * 2^pulse_div clocks) adds the whole part of |v| to an 11-bit accumulator, whose
  overflow is one step (DS-TMC428 8.14); where both ticks fall together the ramp tick comes first;
- with d = min(|x_target - x_actual|, 2^19 - 1) and p = (128 + pmul) / 2^(3 + pdiv) the target velocity is
  floor(sqrt(2048 * p * d)) in RAMP_MODE and floor(p * d) in SOFT_MODE, raised to v_min, cut to v_max;
- the step that reaches the target also stops the motor if the whole part of |v| is v_min or less; else the
  motor brakes and comes back.

Ticks are not run one by one. As long as the velocity climbs, falls or stays by the same amount each ramp
tick, the pulses add up to a sum of floors with a closed form, so that a stretch of any length costs the same.
The emulators have a reading of their own: neither knows the other.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray

from ...kernels import Kernels

IntArray = NDArray[np.int64]

# What `settings` holds, in order.
MODE, V_MIN, V_MAX, A_MAX, RAMP_PERIOD, PULSE_PERIOD, P_MUL, P_SHIFT, V_FIXED = range(9)
SETTINGS: Final = 9
# modes; VELOCITY also serves HOLD_MODE, whose velocity just never changes
RAMP, SOFT, VELOCITY = range(3)

# What `state` holds, in order. Times are in clocks, velocities in 1/256 chip units, `TO_GO` is x_target - x_actual.
(
    NEXT_RAMP,
    NEXT_PULSE,
    TO_GO,
    VELOCITY_256,
    ACCUMULATOR,
    ENDING,
    END_CLOCK,
    BEYOND,  # farthest beyond the target so far [microsteps]
    FIRST_ARRIVAL,  # clock of the first arrival at the target, -1 before
    ARRIVALS,
    SLEWED,  # sum of all velocity changes but the stop at the target
    RAMP_TICKS,
    PHASES,  # how many phases are recorded
    EVENTS,
    DIRECTION,  # +1, -1: the way from the start to the target
) = range(15)
STATE: Final = 15

# endings
RUNNING, SETTLED, STUCK, OSCILLATES, UNDECIDED = range(5)

# phases
ACCELERATION, CONSTANT, DECELERATION, APPROACH, SETTLING, REVERSAL = range(6)

LONGEST_BRAKING: Final = (1 << 19) - 1  # steps: the chip counts the braking distance in 19 bits (DS-TMC428 8.7.1)
MAX_ARRIVALS: Final = 256
MAX_EVENTS: Final = 4_000_000
MAX_PHASES: Final = 32
NEVER: Final = 1 << 61


compiled = Kernels(__file__, options={}, plain=True).compiled


@compiled
def floor_sum(count: int, modulus: int, slope: int, offset: int) -> int:
    """Sum of floor((slope * i + offset) / modulus) for i in 0..count-1; slope and offset not negative.

    Euclid's algorithm on the lattice points below a line: logarithmic in the modulus.
    """
    total = 0
    while count > 0:
        total += count * (count - 1) // 2 * (slope // modulus) + count * (offset // modulus)
        slope %= modulus
        offset %= modulus
        top = slope * count + offset
        if top < modulus:
            break
        count = top // modulus
        offset = top % modulus
        slope, modulus = modulus, slope
    return total


@compiled
def target_velocity(settings: IntArray, distance: int) -> int:
    """Target velocity [chip units] at `distance` > 0 microsteps from the target."""
    product = settings[P_MUL] * min(distance, LONGEST_BRAKING)
    if settings[MODE] == RAMP:
        # below 2^39, where the square root of a double is exact enough to floor
        wanted = np.int64(np.sqrt((product << 11) >> settings[P_SHIFT]))
    else:
        wanted = product >> settings[P_SHIFT]
    return int(min(settings[V_MAX], max(settings[V_MIN], wanted)))


@compiled
def least_distance(settings: IntArray, velocity: int) -> int:
    """The nearest distance [microsteps] that still has target velocity `velocity` or more; may be 0."""
    if velocity <= settings[V_MIN]:
        return 1
    scale = settings[P_MUL]
    wanted = velocity
    if settings[MODE] == RAMP:
        scale <<= 11
        wanted *= velocity
    return int(((wanted << settings[P_SHIFT]) + scale - 1) // scale)


@compiled
def stretch(settings: IntArray, state: IntArray, speed: int, slope: int, ticks: int) -> tuple[int, int]:
    """Pulse ticks, and what they add to the accumulator, in `ticks` ramp ticks that each change `speed` by `slope`."""
    ramp, pulse = settings[RAMP_PERIOD], settings[PULSE_PERIOD]
    if ramp >= pulse:
        each = ramp // pulse
        lowest = speed + slope if slope >= 0 else speed + slope * ticks
        return each * ticks, each * floor_sum(ticks, 256, abs(slope), lowest)
    end = state[NEXT_RAMP] + ramp * ticks
    if state[NEXT_PULSE] >= end:
        return 0, 0
    pulses = (end - 1 - state[NEXT_PULSE]) // pulse + 1
    first = (state[NEXT_PULSE] - state[NEXT_RAMP]) // ramp + 1  # ramp ticks before the first pulse
    each = pulse // ramp
    lowest = speed + slope * first if slope >= 0 else speed + slope * (first + (pulses - 1) * each)
    return pulses, floor_sum(pulses, 256, abs(slope) * each, lowest)


@compiled
def note_phase(state: IntArray, phases: IntArray, code: int, clock: int) -> None:
    """Append (code, clock, velocity, distance to go) to `phases` where the code is new. The last row is reused."""
    count = state[PHASES]
    if count > 0 and phases[count - 1, 0] == code:
        return
    if count < MAX_PHASES:
        phases[count, 0] = code
        phases[count, 1] = clock
        phases[count, 2] = state[VELOCITY_256]
        phases[count, 3] = state[TO_GO]
        state[PHASES] = count + 1


@compiled
def arrive(state: IntArray, clock: int) -> None:
    if state[FIRST_ARRIVAL] < 0:
        state[FIRST_ARRIVAL] = clock
    state[ARRIVALS] += 1


@compiled
def settle(state: IntArray, clock: int) -> None:
    state[VELOCITY_256] = 0
    state[ENDING] = SETTLED
    state[END_CLOCK] = clock


@compiled
def run_pulses(settings: IntArray, state: IntArray, last: int) -> None:
    """All pulse ticks up to clock `last`, which lies before the next ramp tick."""
    if state[NEXT_PULSE] > last:
        return
    period = settings[PULSE_PERIOD]
    count = (last - state[NEXT_PULSE]) // period + 1
    velocity = state[VELOCITY_256]
    whole = abs(velocity) >> 8
    if whole > 0:
        way = 1 if velocity > 0 else -1
        total = state[ACCUMULATOR] + count * whole
        steps = total >> 11
        before = state[TO_GO] * way
        if settings[MODE] != VELOCITY and 0 < before <= steps:
            needed = (before * 2048 - state[ACCUMULATOR] + whole - 1) // whole
            clock = state[NEXT_PULSE] + (needed - 1) * period
            arrive(state, clock)
            if whole <= settings[V_MIN]:
                state[ACCUMULATOR] = (state[ACCUMULATOR] + needed * whole) & 2047
                state[TO_GO] = 0
                state[NEXT_PULSE] = clock + period
                settle(state, clock)
                return
        state[ACCUMULATOR] = total & 2047
        state[TO_GO] -= way * steps
        if state[FIRST_ARRIVAL] >= 0:
            state[BEYOND] = max(state[BEYOND], -state[DIRECTION] * state[TO_GO])
    state[NEXT_PULSE] += count * period


@compiled
def phase_now(settings: IntArray, state: IntArray, target: int) -> int:
    """The phase that the coming ramp tick belongs to; `target` is the signed target velocity in 1/256 units."""
    velocity, to_go = state[VELOCITY_256], state[TO_GO]
    positioning = settings[MODE] != VELOCITY
    if positioning and (state[FIRST_ARRIVAL] >= 0 or to_go == 0):
        return SETTLING
    if (velocity > 0 and target < 0) or (velocity < 0 and target > 0) or (positioning and velocity * to_go < 0):
        return REVERSAL
    if abs(velocity) < abs(target):
        return ACCELERATION
    if abs(velocity) > abs(target):
        return DECELERATION
    if not positioning or abs(target) == target_velocity(settings, LONGEST_BRAKING) << 8:
        return CONSTANT
    return APPROACH if abs(target) == settings[V_MIN] << 8 else DECELERATION


@compiled
def leap(settings: IntArray, state: IntArray, target: int, last: int) -> bool:
    """Run many ramp ticks of one slope at once, where that changes no decision on the way. False: nothing done."""
    velocity, to_go = state[VELOCITY_256], state[TO_GO]
    positioning = settings[MODE] != VELOCITY
    speed = abs(velocity)
    way = 1 if velocity > 0 or (velocity == 0 and target > 0) else -1
    goal = target * way  # of the speed; negative while the motor goes the wrong way
    period = settings[RAMP_PERIOD]
    ticks = (last + 1 - state[NEXT_RAMP]) // period
    frozen = settings[A_MAX] == 0  # no target velocity matters, only the way to the target
    if speed == goal or frozen:
        slope = 0
    elif speed < goal:
        slope = settings[A_MAX]
        ticks = min(ticks, (goal - speed) // slope)
    else:
        slope = -settings[A_MAX]
        lowest = max(goal, 0)
        if positioning and to_go == 0:
            lowest = (settings[V_MIN] + 1) << 8  # below that the stop rule may end the move at this very place
        ticks = min(ticks, (speed - lowest) // settings[A_MAX])
    before = to_go * way
    toward = positioning and before > 0
    if slope == 0 and toward and speed >= 256:
        spare = before if frozen else before - least_distance(settings, speed >> 8) + 1
        pulses = (spare << 11) // (speed >> 8) + 1
        ticks = min(ticks, pulses * settings[PULSE_PERIOD] // period + 1)
    while ticks >= 2:
        pulses, added = stretch(settings, state, speed, slope, ticks)
        total = state[ACCUMULATOR] + added
        after = before - (total >> 11)
        end_speed = speed + slope * ticks
        # The target velocity only falls on the way in: what is still below it at the end was so at each tick.
        undecided = slope >= 0 and not frozen
        if not toward or (after > 0 and not (undecided and target_velocity(settings, after) << 8 < end_speed)):
            state[ACCUMULATOR] = total & 2047
            state[TO_GO] = after * way
            state[VELOCITY_256] = end_speed * way
            state[NEXT_RAMP] += ticks * period
            state[NEXT_PULSE] += pulses * settings[PULSE_PERIOD]
            state[SLEWED] += way * slope * ticks
            state[RAMP_TICKS] += ticks
            if state[FIRST_ARRIVAL] >= 0:
                state[BEYOND] = max(state[BEYOND], -state[DIRECTION] * state[TO_GO])
            return True
        ticks >>= 1
    return False


@compiled
def last_stretch(settings: IntArray, state: IntArray, last: int) -> bool:
    """At v_min or below nothing changes any more before the target: go there at once, if clock `last` allows."""
    velocity = state[VELOCITY_256]
    way = 1 if velocity > 0 else -1
    whole, before = abs(velocity) >> 8, state[TO_GO] * way
    if whole == 0 or before <= 0:
        return False
    needed = (before * 2048 - state[ACCUMULATOR] + whole - 1) // whole
    clock = state[NEXT_PULSE] + (needed - 1) * settings[PULSE_PERIOD]
    if clock > last:
        return False
    state[RAMP_TICKS] += (clock - state[NEXT_RAMP]) // settings[RAMP_PERIOD] + 1
    state[ACCUMULATOR] = (state[ACCUMULATOR] + needed * whole) & 2047
    state[TO_GO] = 0
    arrive(state, clock)
    settle(state, clock)
    return True


@compiled
def advance(settings: IntArray, state: IntArray, phases: IntArray, last: int) -> None:
    """Run `state` through every tick up to and with clock `last`, or to its ending.

    settings : int64[SETTINGS]; state : int64[STATE], changed; phases : int64[MAX_PHASES, 4], appended to.
    """
    positioning = settings[MODE] != VELOCITY
    while state[ENDING] == RUNNING:
        run_pulses(settings, state, min(last, state[NEXT_RAMP] - 1))
        if state[ENDING] != RUNNING or state[NEXT_RAMP] > last:
            return
        to_go, velocity = state[TO_GO], state[VELOCITY_256]
        target = settings[V_FIXED]
        if positioning:
            target = 0
            if to_go != 0:
                target = target_velocity(settings, abs(to_go)) << 8
                if to_go < 0:
                    target = -target
            elif abs(velocity) >> 8 <= settings[V_MIN]:
                settle(state, state[NEXT_RAMP])
                return
            if to_go != 0 and velocity == target and abs(velocity) < 256:
                state[ENDING] = STUCK
                return
        state[EVENTS] += 1
        if last == NEVER and state[ARRIVALS] > MAX_ARRIVALS:
            state[ENDING] = OSCILLATES
            return
        if state[EVENTS] > MAX_EVENTS:
            state[ENDING] = UNDECIDED
            return
        note_phase(state, phases, phase_now(settings, state, target), state[NEXT_RAMP])
        at_last_speed = positioning and velocity == target and abs(velocity) <= settings[V_MIN] << 8
        if at_last_speed and last_stretch(settings, state, last):
            return
        if leap(settings, state, target, last):
            continue
        change = min(max(target - velocity, -settings[A_MAX]), settings[A_MAX])
        state[VELOCITY_256] = velocity + change
        state[SLEWED] += change
        state[RAMP_TICKS] += 1
        state[NEXT_RAMP] += settings[RAMP_PERIOD]


@compiled
def sample(settings: IntArray, state: IntArray, phases: IntArray, clocks: IntArray, samples: IntArray) -> None:
    """The state after the ticks up to each of `clocks` [n], rising, as rows of `samples` [n, 4].

    Columns: distance to go, velocity in 1/256 units, velocity slewed so far, ramp ticks so far.
    """
    for row in range(len(clocks)):
        advance(settings, state, phases, clocks[row])
        samples[row, 0] = state[TO_GO]
        samples[row, 1] = state[VELOCITY_256]
        samples[row, 2] = state[SLEWED]
        samples[row, 3] = state[RAMP_TICKS]
