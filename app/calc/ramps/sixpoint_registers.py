"""A SixPoint ramp as the registers of a TMC5xxx hold it, and what the data sheets warn of.

Sources: DS-TMC5160 (TMC5160 data sheet), 6.3.1 and 12; the sheets of the others say the same. Of eight points:
FIELDS-TMC5240.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Literal, NamedTuple

from ...number_text import plain
from ..units.tmc5xxx import (
    ACCELERATION_MAX,
    CLOCK_HZ,
    KNEE_MAX,
    START_STOP_MAX,
    VELOCITY_MAX,
    acceleration_unit_pps2,
    clock_of,
    velocity_unit_pps,
)
from ..units.tmc5xxx_times import WAIT_CLOCKS, WAIT_MAX
from .sixpoint import SixPoint

Kind = Literal["pps", "pps^2", "s"]
CRAWL = 10
"""VSTOP below this may take its time on the last microsteps (DS-TMC5160, VSTOP)."""


class SixPointRegister(NamedTuple):
    """A register of the ramp: the parameter of SixPoint that it holds, its unit, the most it can hold, and why."""

    parameter: str
    unit: Kind
    most: int
    why: str


REGISTERS = {
    "VSTART": SixPointRegister("v_start", "pps", START_STOP_MAX, "18 bits"),
    "A1": SixPointRegister("a1", "pps^2", ACCELERATION_MAX, "16 bits"),
    "V1": SixPointRegister("v1", "pps", KNEE_MAX, "20 bits"),
    "AMAX": SixPointRegister("a_max", "pps^2", ACCELERATION_MAX, "16 bits"),
    "VMAX": SixPointRegister("v_max", "pps", VELOCITY_MAX, "the ramp generator ends at 2^23 - 512"),
    "DMAX": SixPointRegister("d_max", "pps^2", ACCELERATION_MAX, "16 bits"),
    "D1": SixPointRegister("d1", "pps^2", ACCELERATION_MAX, "16 bits"),
    "VSTOP": SixPointRegister("v_stop", "pps", START_STOP_MAX, "18 bits"),
    "TZEROWAIT": SixPointRegister("t_zero_wait_s", "s", WAIT_MAX, "16 bits"),
}
"""In the order of their addresses."""
WIDE_ACCELERATION_MAX = (1 << 18) - 1
_HELD_MORE = {
    "TVMAX": SixPointRegister("t_v_max_s", "s", WAIT_MAX, "16 bits"),
    "V2": SixPointRegister("v2", "pps", KNEE_MAX, "20 bits"),
    "A2": SixPointRegister("a2", "pps^2", WIDE_ACCELERATION_MAX, "18 bits"),
    "D2": SixPointRegister("d2", "pps^2", WIDE_ACCELERATION_MAX, "18 bits"),
}
EIGHT_POINT = {
    name: held._replace(most=WIDE_ACCELERATION_MAX, why="18 bits") if held.unit == "pps^2" else held
    for name, held in (REGISTERS | _HELD_MORE).items()
}
"""Of the chips with two more corners, a time at constant velocity, and accelerations of 18 bits."""
Registers = Mapping[str, SixPointRegister]
_MOVING = ("AMAX", "VMAX")
"""With 0 in one of them the motor never moves, so a wish above 0 stays above 0."""


def unit_of(register: str, clock_hz: float = CLOCK_HZ) -> float:
    """What one more in the register is [pps, pps^2 or s]."""
    kind = EIGHT_POINT[register].unit
    if kind == "s":
        return WAIT_CLOCKS / clock_of(clock_hz)
    return velocity_unit_pps(clock_hz) if kind == "pps" else acceleration_unit_pps2(clock_hz)


def to_raw(register: str, value: float, clock_hz: float = CLOCK_HZ, registers: Registers = REGISTERS) -> int:
    """The nearest whole number for a value [pps, pps^2, s]. Raises ValueError for one that the register cannot hold."""
    held, unit = registers[register], unit_of(register, clock_hz)
    units = value / unit
    if not 0 <= units < held.most + 0.5:  # also false for NaN
        most = f"{plain(held.most * unit)} {held.unit}"
        raise ValueError(f"{held.parameter} is up to {most} ({held.why}), got {plain(value)}")
    raw = int(units + 0.5)
    return max(raw, 1) if value > 0 and (register in _MOVING or held.unit == "pps^2") else raw


def from_raw(register: str, raw: int, clock_hz: float = CLOCK_HZ, registers: Registers = REGISTERS) -> float:
    """What a register's number stands for [pps, pps^2, s]. Raises ValueError for one that it cannot hold."""
    if not 0 <= raw <= registers[register].most:
        raise ValueError(f"{register} is 0 to {registers[register].most}, got {raw}")
    return raw * unit_of(register, clock_hz)


def registers_of(ramp: SixPoint, clock_hz: float = CLOCK_HZ, registers: Registers = REGISTERS) -> dict[str, int]:
    """Every register of the ramp, by name: each at its nearest whole number; VMAX ends at what the chip can do.

    What is above 0 and decides whether the motor moves at all (VMAX, accelerations) stays above 0. Raises ValueError
    for another number that its register cannot hold.
    """
    highest = VELOCITY_MAX * velocity_unit_pps(clock_hz)
    wanted = {name: getattr(ramp, held.parameter) for name, held in registers.items()}
    wanted["VMAX"] = min(wanted["VMAX"], highest)
    return {name: to_raw(name, value, clock_hz, registers) for name, value in wanted.items()}


def ramp_of(raw: Mapping[str, int], clock_hz: float = CLOCK_HZ, registers: Registers = REGISTERS) -> SixPoint:
    """The ramp of these registers, all of them. Raises ValueError for numbers and ramps that cannot be."""
    return SixPoint(
        **{held.parameter: from_raw(name, raw[name], clock_hz, registers) for name, held in registers.items()}
    )


def held(ramp: SixPoint, clock_hz: float = CLOCK_HZ, registers: Registers = REGISTERS) -> SixPoint:
    """The ramp that the chip makes of wanted parameters. Raises ValueError as `registers_of`."""
    return ramp_of(registers_of(ramp, clock_hz, registers), clock_hz, registers)


@dataclass(frozen=True)
class Finding:
    """Something that the data sheet warns of, or that makes a register idle. `code` is stable, for programs."""

    code: str
    register: str
    text: str


def findings(raw: Mapping[str, int], positioning: bool = True) -> list[Finding]:
    """What is to be said of a ramp's registers (all of them, by name), for positioning or for a velocity mode."""
    found = list[Finding]()

    def say(code: str, register: str, text: str) -> None:
        found.append(Finding(code, register, text))

    vstart, vstop, vmax, v1 = (raw[name] for name in ("VSTART", "VSTOP", "VMAX", "V1"))
    if positioning:
        _of_positioning(raw, say)
        if vstart > vmax:
            say("vstart_above_vmax", "VSTART", f"VMAX, {vmax}, is below VSTART, {vstart}")
        if v1 >= vmax > 0:
            say("v1_above_vmax", "V1", f"V1, {v1}, is not below VMAX, {vmax}: AMAX and DMAX have no part in the ramp")
        if "V2" in raw:
            _of_eight_points(raw, say)
    if vmax > VELOCITY_MAX:
        say("vmax_beyond", "VMAX", f"VMAX, {vmax}, is above the limit of {VELOCITY_MAX}")
    elif vmax == VELOCITY_MAX:
        say("vmax_limit", "VMAX", "VMAX is the most that the ramp generator can do")
    if not raw["TZEROWAIT"] and max(vstop, vstart) > _JUMP:
        say("no_zero_wait", "TZEROWAIT", "without TZEROWAIT a reversal jumps from VSTOP to VSTART at once")
    return found


def _of_positioning(raw: Mapping[str, int], say: Callable[[str, str, str], None]) -> None:
    vstart, vstop, v1 = raw["VSTART"], raw["VSTOP"], raw["V1"]
    if not vstop:
        say("vstop_zero", "VSTOP", "VSTOP is 0, which positioning must not have: the target may never be reached")
    elif vstop < CRAWL:
        say("vstop_low", "VSTOP", f"VSTOP is {vstop}: below {CRAWL} the last microsteps may take long")
    if vstart > vstop:
        say("vstart_above_vstop", "VSTART", f"VSTOP, {vstop}, is below VSTART, {vstart}: a short move may not end")
    if not raw["D1"]:
        say("d1_zero", "D1", "D1 is 0, which positioning must not have, even with V1 0")
    if not raw["DMAX"]:
        say("dmax_zero", "DMAX", "DMAX is 0: the motor never brakes for its target")
    if v1 and not raw["A1"]:
        say("a1_zero", "A1", "A1 is 0: the motor never gets from VSTART to V1")
    if not v1 and (raw["A1"] not in (0, raw["AMAX"]) or raw["D1"] not in (0, raw["DMAX"])):
        say("v1_zero", "V1", "V1 is 0, which leaves A1 and D1 out: AMAX and DMAX all the way")


def _of_eight_points(raw: Mapping[str, int], say: Callable[[str, str, str], None]) -> None:
    v1, v2, vmax = raw["V1"], raw["V2"], raw["VMAX"]
    if not raw["D2"]:
        say("d2_zero", "D2", "D2 is 0, which positioning must not have, even with V2 0")
    if 0 < v2 <= v1:
        say("v2_below_v1", "V2", f"V2, {v2}, is not above V1, {v1}: A2 and D2 have no part in the ramp")
    elif v2 and not raw["A2"]:
        say("a2_zero", "A2", "A2 is 0: the motor never gets from V1 to V2")
    if v2 > v1 and v2 >= vmax > v1:
        say("v2_above_vmax", "V2", f"V2, {v2}, is not below VMAX, {vmax}: AMAX and DMAX have no part in the ramp")


_JUMP = 1000
"""VSTART or VSTOP from which on a reversal without rest is worth a word: about a full step in 0.3 s [units]."""
