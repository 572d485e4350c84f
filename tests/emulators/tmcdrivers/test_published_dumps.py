"""Registers of real drivers, as their owners published them, against the emulated ones that are set alike."""

from __future__ import annotations

from dataclasses import dataclass

import pytest

from app.emulators.tmcdrivers import DriverModel
from tests.emulators.tmcdrivers.bench import Bench

STEPS_HZ = 1000
FINEST = ~(0x2F << 24)
"""CHOPCONF for 256 microsteps at one edge of STEP, by which each place is reached."""


@dataclass(frozen=True)
class Dump:
    """What a real driver told at rest."""

    model: DriverModel
    written: dict[str, int]
    mscnt: int
    mscuract: int
    drv_status: int | None = None
    """None: of a part whose other registers differ from the model's."""


DUMPS = {
    # DUMP-2208: a TMC2208, whose microstep table the TMC2209 has (inferred)
    "tmc2208 at 68": Dump("tmc2209", {"GCONF": 0x1C4, "CHOPCONF": 0x13030053}, 68, 0x00E10064),
    "tmc2208 at 1000": Dump("tmc2209", {"GCONF": 0x1C0, "CHOPCONF": 0x04030053}, 1000, 0x00F401DC),
    "tmc2209 at 16": Dump(  # DUMP-2209
        "tmc2209", {"GCONF": 0xE0, "CHOPCONF": 0x15030053, "IHOLD_IRUN": 0}, 16, 0x00F60018, 0xC0000000
    ),
    # DUMP-2240
    "tmc2240 at 648": Dump(
        "tmc2240",
        {
            "GCONF": 0x8,
            "DRV_CONF": 1,
            "GLOBAL_SCALER": 0x7F,
            "IHOLD_IRUN": 0x04061F08,
            "TPOWERDOWN": 0xA,
            "CHOPCONF": 0x34410153,
            "PWMCONF": 0xC40C001D,
        },
        648,
        0x015A0148,
        0x81080032,
    ),
    # DUMP-2130
    "tmc2130 at 584": Dump("tmc2130", {"CHOPCONF": 0x14028384, "IHOLD_IRUN": 0x61F19}, 584, 0x01200195),
}
STANDS_WITH = 1 << 31 | 0x1F << 16
"""DRV_STATUS: stst and CS_ACTUAL, which the setting alone decides."""


def apart(told: int, real: int) -> int:
    """How far two coil currents, nine bits signed, are from each other."""
    return abs((told - real + 256) % 512 - 256)


@pytest.mark.parametrize("name", DUMPS)
def test_sine_and_current_scale_are_those_of_the_real_part(name: str) -> None:
    dump = DUMPS[name]
    bench = Bench(dump.model, motor="rigid")
    chopper, common = dump.written["CHOPCONF"], 0x80 if dump.model == "tmc2209" else 0
    for register, word in dump.written.items():
        bench.write(register, {"CHOPCONF": chopper & FINEST, "GCONF": word | common}.get(register, word))
    bench.wait(0.01)
    bench.step(STEPS_HZ)
    bench.wait(((dump.mscnt - bench.read("MSCNT")) % 1024 + 0.5) / STEPS_HZ)
    bench.step(0)
    bench.write("CHOPCONF", chopper)
    bench.wait(5.0)  # down to the hold current
    assert bench.read("MSCNT") == dump.mscnt
    told = bench.read("MSCURACT")
    assert apart(told & 0x1FF, dump.mscuract & 0x1FF) <= 1
    assert apart(told >> 16 & 0x1FF, dump.mscuract >> 16 & 0x1FF) <= 1
    if dump.drv_status is not None:
        assert bench.read("DRV_STATUS") & STANDS_WITH == dump.drv_status & STANDS_WITH
