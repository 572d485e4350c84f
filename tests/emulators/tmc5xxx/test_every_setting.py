"""Each setting of the motor driver changes what the emulated motor does, or its row says that it does not.

Every field is set to other values in short runs of the motor, and what the bench knows of it (currents, shaft, scale,
bridges) has to come out differently in one of them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import cache

import pytest

from app.emulators.tmc5xxx import MODELS, Tmc5xxxModel
from app.registers.model import Field, Register
from app.registers.tmc5xxx.table import TABLES
from tests.emulators.tmc5xxx.rig import CHOPPER_ON, DUAL, FORWARD, ONE_TURN_A_SECOND, RAMP, Bench

REGISTERS = {
    *("CHOPCONF", "COOLCONF", "PWMCONF", "DCCTRL", "VDCMIN", "IHOLD_IRUN", "TPOWERDOWN", "GLOBAL_SCALER", "DRV_CONF"),
    *("SG4_THRS", "TPWMTHRS", "TCOOLTHRS", "THIGH", "VCOOLTHRS", "VHIGH", "SHORT_CONF"),
}
GCONF = {"en_pwm_mode", "shaft", "shaft1", "faststandstill", "recalibrate", "I_scale_analog", "dc_sync", "test_mode"}
TELLS_ONLY = {("GSTAT", "reset")}
ALL_SPEEDS, FAST = 0xFFFFF, 0x7FFF00
Digest = tuple[object, ...]
Change = tuple[str, str, int]
"""Register, field ("" is all of it), value."""


class Run:
    """A chip with its first axis set up, one of its fields changed in every write of its register."""

    def __init__(self, model: Tmc5xxxModel, change: Change | None) -> None:
        self.model, self.change = model, change
        self.dual = model in DUAL
        self.bench = Bench(model, rigid=False)
        self.seen: list[object] = []

    def put(self, **values: int) -> None:
        table = self.bench.table
        for name, value in values.items():
            row = table.get(name, 0) if any(r.name == name for r in table) else None
            if row is None:
                continue
            if self.change and self.change[0] == name:
                _, field, wanted = self.change
                part = row.field_named(field) if field else None
                if part is None:
                    value = wanted
                else:
                    mask = (1 << part.width) - 1
                    value = value & ~(mask << part.lsb) | (wanted & mask) << part.lsb
            self.bench.write(name, value)

    def look(self, seconds: float, every: float = 0.02) -> None:
        for _ in range(round(seconds / every)):
            self.bench.wait(every)
            axis = self.bench.state().axes[0]
            truth = axis.truth
            self.seen.append(
                (truth.current_a_a, truth.current_b_a, truth.rotor_rad, truth.current_scale, truth.bridges)
            )
            self.seen.append(self.bench.raw("DRV_STATUS"))

    def window(self, cool: int, high: int = 0) -> None:
        """Thresholds of CoolStep and of the high velocity [ramp units], as this chip counts them."""
        if self.dual:
            self.put(VCOOLTHRS=cool, VHIGH=high or FAST)
        else:
            self.put(TCOOLTHRS=2**24 // cool if cool else ALL_SPEEDS, THIGH=2**24 // high if high else 0)

    def switch_on(self, chopconf: int = CHOPPER_ON, hold: int = 8, run: int = 16) -> None:
        scaler = {"GLOBAL_SCALER": 200, "DRV_CONF": 1}
        self.put(GCONF=0, CHOPCONF=chopconf, IHOLD_IRUN=hold | run << 8 | 2 << 16, TPOWERDOWN=3, **RAMP, **scaler)

    def turn(self, turns: float, load_nm: float = 0.05) -> None:
        self.put(VMAX=round(turns * ONE_TURN_A_SECOND), RAMPMODE=FORWARD)
        self.bench.stage(load_torque_nm=load_nm)


def spreadcycle(run: Run) -> None:
    run.switch_on(CHOPPER_ON | 4 << 24)
    run.turn(1)
    run.look(0.3)
    run.put(VMAX=0)
    run.look(0.8)


def constant_off_time(run: Run) -> None:
    run.switch_on(3 | 1 << 4 | 5 << 7 | 1 << 14 | 1 << 15)
    run.put(AMAX=4000)
    run.turn(4)
    run.look(0.5)


def high_velocity(run: Run) -> None:
    run.switch_on(CHOPPER_ON)
    run.window(256, 3 * ONE_TURN_A_SECOND)
    run.put(AMAX=4000)
    run.turn(4)
    run.look(0.8)


def coolstep(run: Run) -> None:
    run.switch_on()
    run.window(ONE_TURN_A_SECOND // 2, 8 * ONE_TURN_A_SECOND)
    run.put(COOLCONF=2 | 2 << 13)
    run.turn(2, 0.0)
    run.look(0.8)
    run.bench.stage(load_torque_nm=0.12)
    run.bench.stage(load_torque_nm=0.05)
    run.look(0.3)


def stealthchop(run: Run) -> None:
    run.switch_on(CHOPPER_ON | 1 << 15, hold=16)
    if run.dual:
        run.window(3 * ONE_TURN_A_SECOND)
    run.put(PWMCONF=80 | 4 << 8 | 1 << 16 | 3 << 18 | 4 << 24, GCONF=4, TPWMTHRS=2**24 // (3 * ONE_TURN_A_SECOND))
    run.look(0.3)
    run.put(AMAX=4000)
    run.turn(2)
    run.look(0.6)
    run.turn(4)
    run.look(0.4)
    run.turn(2)
    run.look(0.4)
    run.put(VMAX=0)
    run.look(0.6)


def little_current(run: Run) -> None:
    """Less than the shortest pulse of StealthChop gives."""
    run.switch_on(hold=0, run=0)
    if run.dual:
        run.window(3 * ONE_TURN_A_SECOND)
    run.put(PWMCONF=40 | 4 << 8 | 3 << 18 | 4 << 24, GCONF=4)
    run.look(0.5)


def stealthchop_by_hand(run: Run) -> None:
    run.switch_on(hold=0)
    if run.dual:
        run.window(3 * ONE_TURN_A_SECOND)
    run.put(PWMCONF=120 | 8 << 8, GCONF=4)
    run.turn(1, 0.0)
    run.look(0.4)
    run.put(VMAX=0)
    run.bench.stage(load_torque_nm=0.02)
    run.look(0.8)


def dcstep(run: Run) -> None:
    run.switch_on(CHOPPER_ON | 1 << 19)
    run.put(AMAX=4000, SW_MODE=1 << 10, TCOOLTHRS=ALL_SPEEDS, VCOOLTHRS=256, VHIGH=FAST)
    dual = run.dual
    run.put(VDCMIN=3 * ONE_TURN_A_SECOND, DCCTRL=60 | 4 << (8 if dual else 16))
    run.turn(6)
    run.look(0.8)
    run.bench.stage(load_torque_nm=0.2 if run.model == "tmc5160" else 0.12)
    run.look(0.4)
    run.bench.stage(blocked=True)
    run.look(0.2)


def stallguard_4(run: Run) -> None:
    run.switch_on(hold=16)
    run.put(GCONF=4, SG4_THRS=20, SW_MODE=1 << 10, TCOOLTHRS=ALL_SPEEDS, PWMCONF=30 | 3 << 18 | 4 << 24)
    run.look(0.3)
    run.turn(2)
    run.look(0.8)


RUNS: tuple[Callable[[Run], None], ...] = (
    spreadcycle,
    constant_off_time,
    high_velocity,
    coolstep,
    stealthchop,
    stealthchop_by_hand,
    little_current,
    dcstep,
    stallguard_4,
)
FIRST = {"PWMCONF": stealthchop, "COOLCONF": coolstep, "DCCTRL": dcstep, "VDCMIN": dcstep, "SG4_THRS": stallguard_4}
"""Where a register is most likely to show: to have it soon."""


def digest(model: Tmc5xxxModel, how: Callable[[Run], None], change: Change | None) -> Digest:
    run = Run(model, change)
    how(run)
    return tuple(run.seen)


@cache
def usual(model: Tmc5xxxModel, how: Callable[[Run], None]) -> Digest:
    return digest(model, how, None)


def settings(model: Tmc5xxxModel) -> Iterator[tuple[Register, Field | None]]:
    """Every writable field of the driver that does not say that it changes nothing."""
    for row in TABLES[model]:
        if row.axis not in (0, None) or not row.access.writable or row.behaviour:
            continue
        if row.name == "GCONF":
            yield from ((row, part) for part in row.fields if part.name in GCONF and not part.behaviour)
        elif row.name in REGISTERS:
            if row.fields:
                yield from ((row, part) for part in row.fields if not part.behaviour)
            else:
                yield row, None


def acts(model: Tmc5xxxModel, row: Register, part: Field | None) -> bool:
    width = part.width if part else row.width
    top = (1 << width) - 1
    values = sorted({0, 1, 2, top // 8, top // 2, top, *((1 << n) for n in range(8, width, 3))} & set(range(top + 1)))
    first = FIRST.get(row.name, spreadcycle)
    for how in (first, *(run for run in RUNS if run is not first)):
        for value in values:
            if digest(model, how, (row.name, part.name if part else "", value)) != usual(model, how):
                return True
    return False


@pytest.mark.slow
@pytest.mark.parametrize("model", MODELS)
def test_each_setting_of_the_driver_changes_what_the_motor_does_or_says_that_it_does_not(model: Tmc5xxxModel) -> None:
    idle = [
        f"{row.name}.{part.name}" if part else row.name for row, part in settings(model) if not acts(model, row, part)
    ]
    assert idle == []
