"""An emulated driver by its registers, whatever bus they came over."""

from __future__ import annotations

from app.clock import VirtualClock
from app.emulators.tmcdrivers import DriverModel, EmulatedDriver, TmcDriverOptions, TmcDriverPatch
from app.registers.catalog import MODELS


class Bench:
    """One driver; its time is the test's."""

    def __init__(self, model: DriverModel, **options: object) -> None:
        self.table = MODELS[model].table
        self.chip = EmulatedDriver(model, VirtualClock(), TmcDriverOptions.model_validate(options))
        self.clock_hz = self.chip.options.clock_hz
        self.time_s = 0.0

    def read(self, name: str) -> int:
        return self.chip.read(self.table.get(name, 0).address, self.time_s)

    def fields(self, name: str) -> dict[str, int]:
        return self.table.get(name, 0).unpack(self.read(name))

    def write(self, name: str, word: int) -> None:
        self.chip.write(self.table.get(name, 0).address, word & 0xFFFF_FFFF, self.time_s)

    def wait(self, seconds: float) -> None:
        self.time_s += seconds

    def patch(self, **change: object) -> None:
        self.chip.patch(TmcDriverPatch.model_validate(change), self.time_s)

    def step(self, hz: float) -> None:
        """Steps come in from now on."""
        self.patch(pins={"step_hz": float(hz)})

    @property
    def turned_fullsteps(self) -> float:
        return self.chip.ground_truth(0, self.time_s).shaft_fullsteps

    @property
    def peak_a(self) -> float:
        """Amplitude of the coil currents now [A]."""
        truth = self.chip.state(self.time_s).truth
        return float((truth.current_a_a**2 + truth.current_b_a**2) ** 0.5)
