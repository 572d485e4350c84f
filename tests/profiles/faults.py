"""Faults on the wire at every step of applying a profile, and whether what is told afterwards is the truth."""

from __future__ import annotations

import random
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal

from app.devices.tmc4361 import roles as tmc4361
from app.devices.tmc4361.events import Events
from app.devices.tmcl import units
from app.devices.tmcl.state import ModuleState
from app.links import datagram32, datagram40, tmcl
from app.profiles.apply import Transaction
from app.profiles.capture import as_configured, capture
from app.profiles.document import ProfileDocument
from app.profiles.errors import Change, ProfileLeft, ProfileTakenBack
from app.profiles.items import Item, Key, items_of
from app.profiles.program import ProgramStep
from app.profiles.steps import Step
from app.registers.model import Space, to_raw
from app.registers.tmcl.commands import Opcode
from app.registers.tmcl.modules import MODULES
from tests.profiles.harness import Bench, TappedWire, bench, change

Fault = Literal[
    "lost question",
    "lost answer",
    "bit error",
    "silent",
    "deaf",
    "unplugged",
    "refused write",
    "stuck register",
    "refused, then unplugged",
]
FAULTS: tuple[Fault, ...] = (
    "lost question",
    "lost answer",
    "bit error",
    "silent",
    "deaf",
    "unplugged",
    "refused write",
    "stuck register",
    "refused, then unplugged",
)
"""Once: a frame that does not arrive, one whose answer is lost, one bit of an answer. For good: a device that obeys
and says nothing, one that hears nothing, no device; a register that keeps what it held, one with a bit that is stuck;
and a refused write whose rollback ends in the middle."""
NEEDS_READING: tuple[Fault, ...] = ("refused write", "stuck register", "refused, then unplugged")
"""What nobody can see in a register that cannot be read: the link shows that the write arrived, and that is all."""

_WRITES = {Opcode.SAP: Space.AXIS, Opcode.SGP: Space.GLOBAL_0, Opcode.SCO: Space.COORDINATE}
_BANKS = {0: Space.GLOBAL_0, 2: Space.GLOBAL_2, 3: Space.GLOBAL_3}


def written_to(model: str, frame: bytes) -> tuple[Key, int] | None:
    """Which register a frame writes, and with what; None for any other frame."""
    if model in MODULES:
        request = tmcl.Request.decode(frame)
        if request.opcode not in _WRITES:
            return None
        space = _BANKS[request.motor] if request.opcode == Opcode.SGP else _WRITES[Opcode(request.opcode)]
        return (space, request.type, 0), to_raw(request.value, 32)
    if len(frame) == datagram40.FRAME_BYTES:
        write = frame[0] & datagram40.WRITE_BIT
        return ((Space.REGISTER, frame[0] & 0x7F, 0), int.from_bytes(frame[1:], "big")) if write else None
    asked = datagram32.Request.decode(frame)
    return None if asked.read else ((Space.REGISTER, asked.address, 0), asked.data)


def rewritten(model: str, frame: bytes, word: int) -> bytes:
    """The same write with another word."""
    if model in MODULES:
        request = tmcl.Request.decode(frame)
        value = word - (1 << 32) if word >> 31 else word
        return tmcl.Request(request.address, request.opcode, request.type, request.motor, value).encode()
    if len(frame) == datagram40.FRAME_BYTES:
        return frame[:1] + word.to_bytes(4, "big")
    return datagram32.write(datagram32.Request.decode(frame).address, word)


@dataclass
class Injector:
    """Makes one fault happen at step `at`, at its frame number `frame` (0 is the write itself)."""

    bench: Bench
    fault: Fault
    at: int
    frame: int = 0
    rng: random.Random = field(default_factory=lambda: random.Random(7))
    steps: Sequence[Step] = ()
    happened: bool = False
    _armed: bool = False
    _seen: int = -1
    _before: dict[Key, int] = field(default_factory=dict)
    _bit: int = 0
    _writes: int = 0

    # --- as a journal: hears of every step --------------------------------------------------------

    async def begin(self, steps: Sequence[Step], program: ProgramStep | None = None) -> None:
        self.steps = steps
        self._before = self.bench.truth()
        self.bench.wire.spoil = self._spoil

    def reached(self, index: int) -> None:
        self._armed = self._armed or index == self.at

    async def end(self, left: Sequence[Change]) -> None:
        del left

    # --- as a hand on the wire --------------------------------------------------------------------

    def _spoil(self, frame: bytes, answer: Callable[[bytes], bytes]) -> bytes:
        if not self._armed:
            return answer(frame)
        key = self.steps[self.at].item.key
        write = written_to(self.bench.device.model, frame)
        if self.fault in NEEDS_READING:
            return self._stubborn(frame, answer, key, write)
        if write is not None and write[0] == key and self._seen < 0:
            self._seen = 0
        elif self._seen >= 0:
            self._seen += 1
        if self._seen < self.frame:
            return answer(frame)
        return self._faulty(frame, answer)

    def _faulty(self, frame: bytes, answer: Callable[[bytes], bytes]) -> bytes:
        first = not self.happened
        self.happened = True
        match self.fault:
            case "lost question" if first:
                raise TimeoutError
            case "lost answer" if first:
                answer(frame)
                raise TimeoutError
            case "bit error" if first:
                reply = bytearray(answer(frame))
                place = self.rng.randrange(len(reply) * 8)
                reply[place // 8] ^= 1 << place % 8
                return bytes(reply)
            case "silent":
                answer(frame)
                raise TimeoutError
            case "deaf":
                raise TimeoutError
            case "unplugged":
                raise ConnectionError("unplugged")
        return answer(frame)

    def _stubborn(
        self, frame: bytes, answer: Callable[[bytes], bytes], key: Key, write: tuple[Key, int] | None
    ) -> bytes:
        """A register that keeps what it held, or whose lowest bit that matters is stuck."""
        step = self.steps[self.at]
        if write is None:
            return answer(frame)
        if write[0] != key:
            # Behind the failed step only the rollback writes: its second write finds no device.
            self._writes += self.happened
            if self.fault == "refused, then unplugged" and self._writes > 1:
                raise ConnectionError("unplugged")
            return answer(frame)
        self.happened = True
        if self.fault != "stuck register":
            return answer(rewritten(self.bench.device.model, frame, self._whole(step.item, write[1])))
        bit = step.mask & -step.mask
        stuck = (write[1] & ~bit) | (~step.word & bit)
        return answer(rewritten(self.bench.device.model, frame, stuck))

    def _whole(self, item: Item, sent: int) -> int:
        """What it held, in the bits of the item; the others as they were sent."""
        return (sent & ~item.mask) | (self._before[item.key] & item.mask)


@dataclass(frozen=True)
class Report:
    """What came of one injected fault."""

    model: str
    fault: Fault
    at: int
    of: int
    outcome: Literal["applied", "taken back", "left", "wrong"]
    left: int
    detail: str = ""


async def target_of(model: str, seed: int, share: float) -> ProfileDocument:
    """A profile that differs from a device that was just set up in `share` of its registers."""
    async with bench(model) as scratch:
        await change(scratch.device, random.Random(seed), share)
        return await capture(scratch.device, "target", unix_s=1.0)


async def try_fault(document: ProfileDocument, fault: Fault, at: int, frame: int = 0, seed: int = 7) -> Report | None:
    """Apply `document` to a fresh device with that fault at step `at`; None where there is no such step to spoil."""
    async with bench(document.model) as b:
        before = b.truth()
        injector = Injector(b, fault, at, frame, random.Random(seed))
        transaction = Transaction(b.device, document, journal=injector)
        left: list[dict[str, object]] = []
        outcome: Literal["applied", "taken back", "left", "wrong"] = "applied"
        try:
            await transaction.run()
        except ProfileLeft as error:
            outcome, left = "left", error.left
        except ProfileTakenBack:
            outcome = "taken back"
        finally:
            b.wire.spoil = None
        if at >= len(injector.steps) or not injector.happened:
            return None
        wrong = _what_is_wrong(b, before, outcome, left, injector)
        return Report(
            document.model, fault, at, len(injector.steps), "wrong" if wrong else outcome, len(left), "; ".join(wrong)
        )


def _what_is_wrong(
    b: Bench, before: dict[Key, int], outcome: str, left: list[dict[str, object]], injector: Injector
) -> list[str]:
    """Where what was told is not so."""
    shown = b.truth()
    after = _in_the_units_of(b, before, shown)
    told = {(str(entry["name"]), entry["axis"]): entry for entry in left}
    wanted = {step.item.key: step.word for step in injector.steps}
    found = []
    for item in items_of(b.device.model):
        entry = told.pop((item.row.name, item.row.axis), None)
        if outcome == "applied":
            expected = wanted.get(item.key)
            if expected is not None and not same(b, item, as_configured(b.device, item, shown[item.key]), expected):
                found.append(f"{item.place} is {shown[item.key]:#x}, told as applied")
        elif entry is None:
            if not same(b, item, after[item.key], before[item.key]) and not _owed(b, item):
                found.append(f"{item.place} was {before[item.key]:#x} and is {after[item.key]:#x}, and nobody tells")
        else:
            now, is_ = entry["now"], item.row.decode(as_configured(b.device, item, shown[item.key]))
            if now is not None and now != is_:
                found.append(f"{item.place} is {is_} and was told as {now}")
            if now is not None and after[item.key] == before[item.key]:
                found.append(f"{item.place} is as it was, and was told as left")
    found += [f"{name} is told and does not exist" for name in told]
    return found


def _in_the_units_of(b: Bench, before: dict[Key, int], after: dict[Key, int]) -> dict[Key, int]:
    """What is held, as it reads in the units of before: a unit mode that is left shows every speed as another."""
    mode = (Space.AXIS, 255, 0)
    if b.device.model not in MODULES or before.get(mode) == after.get(mode):
        return after
    emulator = b.wire.emulator
    emulator.exchange(tmcl.Request(1, Opcode.SAP, 255, 0, before[mode]).encode())
    again = b.truth()
    emulator.exchange(tmcl.Request(1, Opcode.SAP, 255, 0, after[mode]).encode())
    return again | {mode: after[mode]}


def same(b: Bench, item: Item, one: int, other: int) -> bool:
    """A module keeps whole units of its driver chip: a number may come back one of them off."""
    module = b.device.part(ModuleState)
    if module is None:
        return not (one ^ other) & item.mask
    value = item.row.decode(other)
    unit = item.row.unit
    tolerance = units.read_back_tolerance(unit, value, b.device.clock_hz, module.microsteps)
    return abs(item.row.decode(one) - value) <= tolerance


def _owed(b: Bench, item: Item) -> bool:
    """A TMC4361's driver writes over EVENT_CLEAR_CONF for each look, and puts it back when the link is there again."""
    events = b.device.part(Events)
    return events is not None and item.row is tmc4361.EVENT_CLEAR_CONF and events._owed is not None


__all__ = ["FAULTS", "NEEDS_READING", "Fault", "Injector", "Report", "TappedWire", "same", "target_of", "try_fault"]
