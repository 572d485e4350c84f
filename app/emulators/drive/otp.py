"""The memory of a TMC2209 that is burnt bit by bit, once and for all: resets of other registers (DS-TMC2209 5.1.1).

Burning takes effect at the next power-on (a reading). What byte 0 and OTP_PWM_GRAD stand for is kept without effect.
"""

from __future__ import annotations

from collections.abc import Mapping

KEY = 0xBD
"""OTP_PROG burns with this in bits 15:8 alone."""
BYTES = 3
TPWMTHRS = (0, 200, 300, 400, 500, 800, 1200, 4000)
IHOLD = (16, 2, 8, 24)
IHOLDDELAY = (1, 2, 4, 8)
_SPREAD, _GRADES, _OFFSET, _REGULATION, _FREQUENCY, _DELAY, _HOLD = 23, 13, 16, 17, 18, 19, 21
_HEND_1 = 1 << 8


def burnt(held: int, word: int) -> int:
    """What the memory holds after OTP_PROG was written `word`: bits only ever come."""
    place = word >> 4 & 3
    return held | 1 << 8 * place + (word & 7) if word >> 8 & 0xFF == KEY and place < BYTES else held


def resets(memory: int, resets: Mapping[str, int]) -> dict[str, int]:
    """Words after power-on by register, of those that the memory has a say in; `resets` are those of an empty one."""
    spread = memory >> _SPREAD & 1
    ihold, delay = IHOLD[memory >> _HOLD & 3], IHOLDDELAY[memory >> _DELAY & 3]
    found = {
        "GCONF": resets["GCONF"] | spread << 2,
        "IHOLD_IRUN": resets["IHOLD_IRUN"] & ~0xF001F | delay << 16 | ihold,
        "TPWMTHRS": 0 if spread else TPWMTHRS[memory >> _GRADES & 7],
        "CHOPCONF": resets["CHOPCONF"],
        "PWMCONF": resets["PWMCONF"],
    }
    if memory >> _FREQUENCY & 1:
        found["PWMCONF"] = found["PWMCONF"] & ~(3 << 16) | 2 << 16
    if memory >> _REGULATION & 1:
        found["PWMCONF"] = found["PWMCONF"] & ~(0xF << 24) | 2 << 24
    if memory >> _OFFSET & 1:
        if spread:
            found["CHOPCONF"] |= _HEND_1
        else:
            found["PWMCONF"] &= ~(0xFF | 1 << 19)
    return found
