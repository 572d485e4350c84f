"""An emulated TMC5xxx on a bench whose time the test owns."""

from __future__ import annotations

from typing import Any

from app.clock import VirtualClock
from app.emulators.tmc5xxx import MODELS, EmulatedTmc5xxx, Tmc5xxxModel, Tmc5xxxOptions, Tmc5xxxPatch, Tmc5xxxState
from app.registers.tmc5xxx.table import AXES, TABLES

CLOCK_HZ = 16e6
TURN = 51_200
ONE_TURN_A_SECOND = 53_687
"""VMAX for 51,200 microsteps/s."""
CHOPPER_ON = 0x153
"""Driver on, 256 microsteps, no interpolation: toff 3, hysteresis as the sheets recommend."""
RAMP = {
    "VSTART": 0,
    "A1": 1000,
    "V1": 0,
    "AMAX": 2000,
    "VMAX": 2 * ONE_TURN_A_SECOND,
    "DMAX": 2000,
    "D1": 1000,
    "VSTOP": 10,
}
DUAL: tuple[Tmc5xxxModel, ...] = ("tmc5031", "tmc5062", "tmc5072")
SINGLE: tuple[Tmc5xxxModel, ...] = ("tmc5130", "tmc5160", "tmc5240")
WITH_ENCODER: tuple[Tmc5xxxModel, ...] = MODELS[1:]
PLACES = [(model, axis) for model in MODELS for axis in range(AXES[model])]
"""Every axis of every chip."""
POSITION, FORWARD, BACKWARD, HOLD = range(4)


class Bench:
    """A chip, and words by the names of its registers: signed where the row says so."""

    def __init__(self, model: Tmc5xxxModel, *, rigid: bool = True, **options: Any) -> None:
        motor = {"motor": "rigid"} if rigid else {}
        self.model = model
        self.table = TABLES[model]
        self.chip = EmulatedTmc5xxx(model, VirtualClock(), Tmc5xxxOptions(**({"clock_hz": CLOCK_HZ} | motor | options)))
        self.now_s = 0.0

    def wait(self, seconds: float) -> None:
        self.now_s += seconds

    def raw(self, name: str, axis: int = 0) -> int:
        return self.chip.read(self.table.get(name, axis).address, self.now_s)

    def read(self, name: str, axis: int = 0) -> int:
        return self.table.get(name, axis).decode(self.raw(name, axis))

    def field(self, name: str, field: str, axis: int = 0) -> int:
        return self.table.get(name, axis).unpack(self.raw(name, axis))[field]

    def write(self, name: str, value: int, axis: int = 0) -> None:
        self.chip.write(self.table.get(name, axis).address, value & 0xFFFFFFFF, self.now_s)

    def put(self, axis: int = 0, **values: int) -> None:
        for name, value in values.items():
            self.write(name, value, axis)

    def state(self) -> Tmc5xxxState:
        return self.chip.state(self.now_s)

    def patch(self, **change: Any) -> Tmc5xxxState:
        return self.chip.patch(Tmc5xxxPatch.model_validate(change), self.now_s)

    def stage(self, axis: int = 0, **change: Any) -> Tmc5xxxState:
        """Change the plant of one axis, and let the chip see it: that takes a tick."""
        self.patch(axes=[{"axis": axis} | change])
        self.wait(1e-3)
        return self.state()

    def flags(self, axis: int = 0) -> set[str]:
        """Names of RAMP_STAT's bits that are set; reading may clear them."""
        return {
            name
            for name, value in self.table.get("RAMP_STAT", axis).unpack(self.raw("RAMP_STAT", axis)).items()
            if value
        }

    def clear(self, axis: int = 0) -> None:
        """Let RAMP_STAT's flags go, as this chip does it."""
        self.write("RAMP_STAT", self.raw("RAMP_STAT", axis), axis)

    def counts(self, axis: int = 0) -> int:
        """Where the encoder really is."""
        encoder = self.state().axes[axis].encoder
        assert encoder is not None
        return encoder.counts

    @property
    def status(self) -> int:
        """The first byte of an SPI reply."""
        return self.chip.exchange(bytes((0x22, 0, 0, 0, 0)), self.now_s)[0]


def moving(model: Tmc5xxxModel, axis: int = 0, *, rigid: bool = True, current: int = 16, **options: Any) -> Bench:
    """A chip with its driver on and a ramp of two turns a second on `axis`."""
    bench = Bench(model, rigid=rigid, **options)
    bench.put(axis, CHOPCONF=CHOPPER_ON, IHOLD_IRUN=current | current << 8 | 1 << 16, **RAMP)
    bench.wait(0.2)
    return bench
