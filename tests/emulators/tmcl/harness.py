"""A module for tests: commands by mnemonic, time by hand."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from app.clock import VirtualClock
from app.emulators.tmcl.family import FAMILY
from app.emulators.tmcl.options import TmclOptions, TmclPatch
from app.emulators.tmcl.state import TmclState
from app.links.tmcl import Reply, Request
from app.registers.tmcl.commands import Opcode, Status

OK = Status.OK
FULLSTEP = 256
"""Microsteps of a full step, at the default resolution."""


class Bench:
    """One module, obeyed at once, and a clock that only the test moves."""

    def __init__(
        self, options: dict[str, object] | None = None, eeprom: Path | None = None, model: str = "pd42-1241"
    ) -> None:
        self.clock = VirtualClock()
        self.module = FAMILY.make(model, self.clock, TmclOptions.model_validate(options or {}), eeprom)
        self.address = self.module.options.address

    def ask(self, opcode: int, type_: int = 0, motor: int = 0, value: int = 0) -> Reply:
        """One command and its answer, of whatever status."""
        return Reply.decode(self.module.exchange(Request(self.address, opcode, type_, motor, value).encode()))

    def do(self, opcode: int, type_: int = 0, motor: int = 0, value: int = 0) -> int:
        """One command that has to go well; the answer's value."""
        reply = self.ask(opcode, type_, motor, value)
        assert reply.status == OK, f"{Opcode(opcode).name} {type_}, {motor}, {value}: {reply.status_text}"
        return reply.value

    def gap(self, number: int) -> int:
        return self.do(Opcode.GAP, number)

    def sap(self, number: int, value: int) -> None:
        self.do(Opcode.SAP, number, 0, value)

    def ggp(self, number: int, bank: int = 0) -> int:
        return self.do(Opcode.GGP, number, bank)

    def sgp(self, number: int, value: int, bank: int = 0) -> None:
        self.do(Opcode.SGP, number, bank, value)

    def move(self, position: int) -> None:
        self.do(Opcode.MVP, 0, 0, position)

    def run(self, seconds: float) -> None:
        self.clock.set(self.clock.now() + seconds)

    def until(self, met: Callable[[], bool], limit_s: float = 60.0, step_s: float = 0.01) -> float:
        """Let time pass until `met`; how long that took [s]. Fails after `limit_s`."""
        began_s = self.clock.now()
        while not met():
            assert self.clock.now() - began_s < limit_s, "it did not happen in time"
            self.run(step_s)
        return self.clock.now() - began_s

    def arrive(self, limit_s: float = 60.0) -> float:
        """Until the position reached flag is set; how long that took [s]."""
        return self.until(lambda: self.gap(8) == 1, limit_s)

    def stand(self, limit_s: float = 60.0) -> float:
        return self.until(lambda: self.gap(3) == 0, limit_s)

    def events(self) -> list[tuple[float, bytes]]:
        return self.module.unsolicited()

    def patch(self, **change: object) -> TmclState:
        return self.module.patch(TmclPatch.model_validate(change))

    @property
    def state(self) -> TmclState:
        return self.module.state()

    def power_cycle(self) -> None:
        self.patch(power_cycle=True)


def frame(text: str) -> bytes:
    return bytes.fromhex(text)
