"""An emulated TMC4361 with names for its registers, and time in the test's hands."""

from __future__ import annotations

from dataclasses import dataclass, fields

from app.clock import VirtualClock
from app.emulators.tmc4361 import EmulatedTmc4361, Tmc4361Options, Tmc4361Patch, Tmc4361State
from app.links.datagram40 import FETCH, Reply, read, write
from app.registers.tmc4361.bits import EVENTS
from app.registers.tmc4361.table import TMC4361

S_POSITION, S_VELOCITY = 6, 2
TRAPEZOID_POSITION, TRAPEZOID_VELOCITY = 5, 1
HOLD_POSITION, HOLD_VELOCITY = 4, 0
MODES = (HOLD_VELOCITY, TRAPEZOID_VELOCITY, S_VELOCITY, HOLD_POSITION, TRAPEZOID_POSITION, S_POSITION)
TICK_S = 64 / 16e6

_ADDRESSES = {row.name: row.address for row in TMC4361}


@dataclass(frozen=True)
class Ramp:
    """Ramp registers in pps, pps^2, pps^3."""

    vmax: float = 50_000.0
    amax: float = 200_000.0
    dmax: float = 200_000.0
    bow1: float = 2e6
    bow2: float = 2e6
    bow3: float = 2e6
    bow4: float = 2e6
    vstart: float = 0.0
    vstop: float = 0.0
    vbreak: float = 0.0
    astart: float = 0.0
    dfinal: float = 0.0
    dstop: float = 0.0

    def words(self) -> dict[str, int]:
        """The register words, cut to their formats: 1/256 pps, 1/4 pps^2, 1 pps^3."""
        scales = {"v": 256, "a": 4, "d": 4, "b": 1}
        return {field.name.upper(): round(getattr(self, field.name) * scales[field.name[0]]) for field in fields(self)}


class Rig:
    """`now_s` is the chip's time [s]; nothing happens but through these methods."""

    def __init__(self, options: Tmc4361Options | None = None) -> None:
        self.chip = EmulatedTmc4361(VirtualClock(), options)
        self.now_s = 0.0
        self.status = 0

    def send(self, frame: bytes) -> Reply:
        reply = Reply.decode(self.chip.exchange(frame, self.now_s))
        self.status = reply.status
        return reply

    def write(self, register: str | int, word: int) -> None:
        self.send(write(_address(register), word & 0xFFFFFFFF))

    def read(self, register: str | int) -> int:
        """The raw word: two datagrams."""
        self.send(read(_address(register)))
        return self.send(FETCH).data

    def signed(self, register: str | int) -> int:
        word = self.read(register)
        return word - (1 << 32) if word >> 31 else word

    def ramp(self, ramp: Ramp, mode: int) -> None:
        for name, word in ramp.words().items():
            self.write(name, word)
        self.write("RAMPMODE", mode)

    def events(self) -> set[str]:
        """Names of the events since the last look, which clears them."""
        word = self.read("EVENTS")
        return {name for bit, (name, _) in EVENTS.items() if word >> bit & 1}

    def flag(self, bit: int) -> bool:
        return bool(self.read("STATUS_FLAGS") >> bit & 1)

    def wait(self, seconds: float) -> None:
        self.now_s += seconds

    def state(self) -> Tmc4361State:
        return self.chip.state(self.now_s)

    def patch(self, **change: object) -> Tmc4361State:
        return self.chip.patch(Tmc4361Patch.model_validate(change), self.now_s)

    def wait_for_rest(self, at_most_s: float = 100.0, step_s: float = 0.01) -> None:
        """Until the ramp generator has nothing to do."""
        end_s = self.now_s + at_most_s
        while self.state().ramp.kind != "rest":
            assert self.now_s < end_s, f"still moving after {at_most_s} s: {self.state().ramp}"
            self.wait(step_s)

    @property
    def position(self) -> int:
        return self.signed("XACTUAL")


def _address(register: str | int) -> int:
    return register if isinstance(register, int) else _ADDRESSES[register]
