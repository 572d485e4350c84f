"""The pins of an emulated chip that can be wired to others: step/direction outputs of a TMC429 or TMC4210, and the
inputs of the left switches."""

from __future__ import annotations

from collections.abc import Callable

from ..core.pins import REFERENCES, STEPS, Cells, WiredChip
from . import kernel as k
from . import stage
from .chip import Chip
from .step_dir import StepDirChip

TICK_CLOCKS = 32


class Wires(WiredChip):
    """`WiredChip` of one of them. `brought_to_s` tells how far it is [s]."""

    tick_clocks = TICK_CLOCKS

    def __init__(self, chip: Chip, clock_hz: float, brought_to_s: Callable[[], float]) -> None:
        self._chip = chip
        self._brought_to_s = brought_to_s
        self.clock_hz = clock_hz
        self.outputs = STEPS[: chip.model.axes] if isinstance(chip, StepDirChip) else ()
        self.senses = REFERENCES[: chip.model.axes]
        self.held: dict[int, bool] = {}
        """Levels that wires put on the input of an axis's left switch, by axis."""

    @property
    def clock(self) -> int:
        return int(self._brought_to_s() * self.clock_hz + 0.5)

    @property
    def quiet(self) -> bool:
        return self._chip.quiet

    def advance(self, clock: int) -> int:
        self._chip.advance(clock)
        return clock

    def receive(self, pin: str, high: bool | None) -> None:
        axis = REFERENCES.index(pin)
        self.held = {n: level for n, level in self.held.items() if n != axis} | ({} if high is None else {axis: high})
        stage.wire(self._chip.axes[axis], high)
        self._chip.refresh()

    def sent(self, pin: str) -> int:
        return int(self._chip.axes[STEPS.index(pin), k.NET])

    def record(self, clocks: Cells) -> tuple[int, dict[str, Cells]]:
        sent = self._chip.record(clocks)
        return int(clocks[-1]), {pin: sent[:, axis] for axis, pin in enumerate(self.outputs)}
