"""Coil currents: the scale of 0x05 and 0x06 with its delays, the microstep wave, the driver or the PWM outputs.

The current driver behind is like a TMC26x: it regulates each coil to what CURRENTA_SPI and CURRENTB_SPI say, 248 being
its full scale. Facts: tmc4361-io section 9, tmc4361-encoder-closed-loop section 6, tmc-microstep-table. What they leave
open is read like this:

- a delay of 0x18..0x1A is that of one step of the scale by 1; a delay of 0 takes over at once;
- FREEWHEEL_DELAY begins when the hold current does; the scale without drive_current_scale_en is 255;
- a closed loop's scale climbs on the line from CL_START_UP to CL_BETA and falls on that from CL_START_UP to
  CL_START_DN; between the two lines it stays;
- CURRENTx_SPI = CURRENTx * (scale + 1) / 256, floored; DAC_OFFSET (signed) is added where an SPI DAC is the driver
  (spi_output_format 1..3);
- full steps (fs_en above FS_VEL, or dcStep above DC_VEL, the same register) are the middle of each full step of the
  wave;
- a PWM's scale without pwm_scale_en is the 1/2 of full voltage. Its duty has the resolution of PWM_FREQ clocks.
"""

# mypy: disable-error-code="no-any-return"

from __future__ import annotations

import math

from ...drive import kernel as k
from ...drive.table import PEAK
from ..compiled import compiled, inlined
from . import layout as c
from .layout import Cells, Floats, bit

HOLD_EN, DRIVE_EN, BOOST_ACC, BOOST_DEC, BOOST_START, DRIVE2_EN, FREEWHEEL_EN, CL_SCALE_EN, PWM_SCALE_EN = range(9)
"""Bits of CURRENT_CONF."""
FS_EN, PWM_OUT_EN = 19, 23
"""Bits of GENERAL_CONF."""
RISING, FALLING, MOVING, FROZEN = 1, 2, 4, 8
"""In the `ramp_state` that the kernel hands over."""
LONGEST = 1 << 33
"""Clocks without or with motion are counted up to here: more than any two delays together."""


@inlined
def _scale_to(n: Cells, wanted: int, delay: int, clocks: int) -> None:
    """Go towards a scale, one step every `delay` clocks."""
    scale = n[c.SCALE]
    if scale == wanted:
        n[c.SCALE_CLOCKS] = 0
        return
    if delay == 0:
        n[c.SCALE] = wanted
        return
    n[c.SCALE_CLOCKS] += clocks
    steps = n[c.SCALE_CLOCKS] // delay
    n[c.SCALE_CLOCKS] -= steps * delay
    n[c.SCALE] = min(scale + steps, wanted) if wanted > scale else max(scale - steps, wanted)


@inlined
def _line(deviation: int, start: int, end: int, low: int, high: int) -> int:
    """From `low` at `start` to `high` at `end`."""
    if deviation >= end:
        return high
    if deviation <= start:
        return low
    return low + (high - low) * (deviation - start) // (end - start)


@inlined
def _closed_loop_scale(n: Cells, clocks: int) -> None:
    """As much current as the deviation asks for."""
    values = n[c.SCALE_VALUES]
    low, high, start = values & 0xFF, values >> 8 & 0xFF, values >> 16 & 0xFF
    beta = n[c.CL_ANGLES] & 0x1FF
    falling = values >> 24 & 0xFF
    if falling == 0:
        falling = beta
    deviation = abs(n[c.DEV])
    up = _line(deviation, start, beta, low, high)
    down = max(_line(deviation, start, falling, low, high), up)
    if n[c.SCALE] < up:
        _scale_to(n, up, n[c.UP_SCALE_DELAY], clocks)
    elif n[c.SCALE] > down:
        _scale_to(n, down, n[c.DOWN_SCALE_DELAY], clocks)
    else:
        n[c.SCALE_CLOCKS] = 0


@inlined
def _ramp_scale(n: Cells, speed_pps: float, ramp_state: int, clocks: int) -> None:
    """As much current as what the ramp generator does asks for."""
    conf, values = n[c.CURRENT_CONF], n[c.SCALE_VALUES]
    drive = values >> 8 & 0xFF if bit(conf, DRIVE_EN) else 255
    if not ramp_state & MOVING:
        held = n[c.STILL] > n[c.STDBY_DELAY]
        n[c.FREE] = bit(conf, FREEWHEEL_EN) and n[c.STILL] > n[c.STDBY_DELAY] + n[c.FREEWHEEL_DELAY]
        if bit(conf, HOLD_EN) and held:
            _scale_to(n, values >> 24 & 0xFF, n[c.DOWN_SCALE_DELAY], clocks)
            return
    else:
        n[c.FREE] = 0
        if bit(conf, DRIVE2_EN) and speed_pps > n[c.VDRV_SCALE_LIMIT]:
            drive = values >> 16 & 0xFF
        if (
            (bit(conf, BOOST_ACC) and ramp_state & 3 == RISING)
            or (bit(conf, BOOST_DEC) and ramp_state & 3 == FALLING)
            or (bit(conf, BOOST_START) and n[c.RUNNING] <= n[c.BOOST_TIME])
        ):
            drive = values & 0xFF
    _scale_to(n, drive, n[c.UP_SCALE_DELAY] if drive > n[c.SCALE] else n[c.DRV_SCALE_DELAY], clocks)


@inlined
def _bridges(fb: Floats, n: Cells) -> int:
    """What the driver's bridges do."""
    if not n[k.DRIVER_ON] or n[c.FREE]:
        return k.OPEN
    return k.VOLTAGE if bit(n[c.GENERAL_CONF], PWM_OUT_EN) else k.REGULATED


@inlined
def _duty(n: Cells, scale: float, value: int) -> float:
    """A PWM output's duty: half, and the wave around it."""
    duty = 0.5 + scale * (value + 0.5) / PEAK
    period = n[c.PWM_FREQ] & 0xFFFF
    if period > 0:
        duty = math.floor(duty * period + 0.5) / period
    return min(max(duty, 0.0), 1.0)


@inlined
def _pwm_scale(n: Cells, speed_pps: float) -> float:
    """Amplitude of the PWM's duty: from (PWM_AMPL + 1) / 2^17 at rest to 1/2 at PWM_VMAX."""
    conf = n[c.CURRENT_CONF]
    if not bit(conf, PWM_SCALE_EN):
        return 0.5
    least = ((conf >> 16 & 0xFFFF) + 1) / 131072.0
    fastest = float(n[c.VDRV_SCALE_LIMIT])  # PWM_VMAX at the same address
    if speed_pps >= fastest and speed_pps > 0.0:
        return 0.5
    return least + (0.5 - least) * speed_pps / fastest if fastest > 0.0 else least


@compiled
def _values(n: Cells, at: int) -> None:
    """Both values of the wave at a place, and scaled, for a driver behind."""
    a, b = n[c.WAVE + (at & 1023)], n[c.WAVE + (at + 256 & 1023)]
    factor = n[c.SCALE] + 1
    n[c.CURRENT_A], n[c.CURRENT_B] = a, b
    n[c.CURRENT_A_SPI], n[c.CURRENT_B_SPI] = a * factor >> 8, b * factor >> 8


@compiled
def energise(fb: Floats, n: Cells, velocity_pps: float, ramp_state: int, clocks: int, motor_too: bool) -> None:
    """Scale, wave and driver of one tick; with `motor_too` a step of the motor, unless it rests and nothing changed."""
    speed = abs(velocity_pps)
    if ramp_state & MOVING:
        n[c.STILL] = 0
        n[c.RUNNING] = min(n[c.RUNNING] + clocks, LONGEST)
    else:
        n[c.RUNNING] = 0
        n[c.STILL] = min(n[c.STILL] + clocks, LONGEST)
    closed = n[c.ENC_IN_CONF] >> 22 & 3 == c.CLOSED_LOOP
    if ramp_state & FROZEN:
        n[c.FREE] = 0
        if n[c.FREEZE] >> 24 & 0xFF:
            n[c.SCALE] = n[c.FREEZE] >> 24 & 0xFF
    elif closed and bit(n[c.CURRENT_CONF], CL_SCALE_EN):
        n[c.FREE] = 0
        _closed_loop_scale(n, clocks)
    else:
        _ramp_scale(n, speed, ramp_state, clocks)
    at = n[c.PHASE]
    n[c.FS_ACTIVE] = (
        not closed
        and (bit(n[c.GENERAL_CONF], FS_EN) or n[c.GENERAL_CONF] >> 21 & 3 != 0)
        and n[c.VMIN_EMF] & 0xFFFFFF > 0
        and speed >= (n[c.VMIN_EMF] & 0xFFFFFF)
    )
    if n[c.FS_ACTIVE]:
        at = (at & ~0xFF) + 128
    if n[c.DRIVER]:
        _values(n, at)
        return
    n[k.LOOK] = at
    bridges = _bridges(fb, n)
    pwm = bridges == k.VOLTAGE
    if pwm:
        at += n[c.MS_OFFSET] & 0x3FF
    a, b = n[c.WAVE + (at & 1023)], n[c.WAVE + (at + 256 & 1023)]
    factor = n[c.SCALE] + 1
    n[c.CURRENT_A], n[c.CURRENT_B] = a, b
    a_spi, b_spi = a * factor >> 8, b * factor >> 8
    if pwm:
        scale = _pwm_scale(n, speed)
        fb[c.DUTY_A], fb[c.DUTY_B] = _duty(n, scale, a), _duty(n, scale, b)
        ref_a = fb[k.SUPPLY] * (2.0 * fb[c.DUTY_A] - 1.0)
        ref_b = fb[k.SUPPLY] * (2.0 * fb[c.DUTY_B] - 1.0)
    else:
        ref_a = fb[k.FULL_SCALE] * (a_spi + 0.5) / PEAK
        ref_b = fb[k.FULL_SCALE] * (b_spi + 0.5) / PEAK
    if 1 <= n[c.SPI_OUT_CONF] & 15 <= 3:
        offset = ((n[c.START_SIN] >> 24) + 128 & 0xFF) - 128
        a_spi += offset
        b_spi += offset
    n[c.CURRENT_A_SPI], n[c.CURRENT_B_SPI] = a_spi, b_spi
    n[k.CS] = n[c.SCALE] >> 3
    if bridges != n[k.BRIDGES]:
        n[k.BRIDGES] = bridges
        n[k.REST] = 0
    if motor_too and (not n[k.REST] or ref_a != fb[k.REF_A] or ref_b != fb[k.REF_B]):
        k.turn(n, fb, ref_a, ref_b)
