"""The emulated PD42-1241 itself on a line: nothing that arrives may crash it, hang it, or make it lie."""

from __future__ import annotations

import random

import pytest

from app.calc.tmcl.assembler import assemble
from app.clock import VirtualClock
from app.emulators.line.framing import GAP_S
from app.emulators.line.line import Line
from app.emulators.tmcl.module import EmulatedModule
from app.emulators.tmcl.options import TmclOptions, TmclPatch
from app.links import tmcl
from app.links.tmcl_language import INSTRUCTIONS
from app.registers.tmcl.commands import Opcode, Status


class Bench:
    """Modules on a line without wire time, and one client."""

    def __init__(self, addresses: tuple[int, ...] = (1,), *, baud: int | None = None) -> None:
        self.clock = VirtualClock(5.0)
        self.modules = [EmulatedModule("pd42-1241", self.clock, TmclOptions(address=address)) for address in addresses]
        self.line = Line(self.modules, self.clock, baud=baud, addresses=addresses)
        self.line.join("client")

    def wait(self, seconds: float) -> bytes:
        """Let time pass; what was heard meanwhile."""
        heard, until_s = b"", self.clock.now() + seconds
        while (due_s := self.line.next_due_s()) is not None and due_s <= until_s:
            self.clock.set(max(due_s, self.clock.now()))
            heard += b"".join(delivery.data for delivery in self.line.collect(self.clock.now()))
        self.clock.set(until_s)
        return heard + b"".join(delivery.data for delivery in self.line.collect(until_s))

    def say(self, data: bytes, seconds: float = GAP_S * 1.1) -> bytes:
        self.line.feed("client", data, self.clock.now())
        return self.wait(seconds)

    def ask(self, opcode: int, type_: int = 0, motor: int = 0, value: int = 0, address: int = 1) -> tmcl.Reply:
        request = tmcl.Request(address, opcode, type_, motor, value).encode()
        return tmcl.check_reply("line", request, self.say(request, 0.003))

    def fault(self, **change: object) -> None:
        for module in self.modules:
            module.patch(TmclPatch.model_validate({"faults": change}))


def test_a_thousand_corrupt_inputs_during_a_move_change_nothing_they_should_not() -> None:
    bench, noise = Bench(), random.Random(1241)
    bench.ask(Opcode.SAP, 4, value=20_000)
    bench.ask(Opcode.MVP, 0, value=10_000_000)
    before = bench.ask(Opcode.GAP, 4).value, bench.ask(Opcode.GAP, 0).value
    for _ in range(1000):
        good = tmcl.Request(1, Opcode.GAP, noise.randrange(256), noise.randrange(4), noise.randrange(2**31)).encode()
        frame = bytearray(good)
        match noise.randrange(3):
            case 0:  # one wrong bit never passes for right
                frame[noise.randrange(1, 9)] ^= 1 << noise.randrange(8)
                heard = bench.say(bytes(frame))
                assert heard[2] == Status.WRONG_CHECKSUM
            case 1:
                assert bench.say(bytes(frame[: noise.randrange(1, 9)])) == b""
            case _:
                # Addressed to nobody here, so that whatever it happens to mean is not for us.
                rubbish = bytes(byte | 0x80 for byte in noise.randbytes(noise.randrange(1, 60)))
                assert len(bench.say(rubbish)) % 9 == 0
        reply = bench.ask(Opcode.GAP, 1)
        assert reply.status == Status.OK
    assert (bench.ask(Opcode.GAP, 4).value, bench.ask(Opcode.GAP, 0).value) == before
    assert bench.ask(Opcode.GAP, 1).value > 0, "and it moves on"


def test_a_thousand_random_commands_never_crash_a_module() -> None:
    bench, noise = Bench((1, 2)), random.Random(3)
    for _ in range(1000):
        request = tmcl.Request(
            noise.choice((1, 2)),
            noise.choice((noise.randrange(256), Opcode.SAP, Opcode.SGP, Opcode.MVP, Opcode.RFS)),
            noise.randrange(256),
            noise.choice((0, 0, 0, noise.randrange(256))),
            noise.choice((0, 1, -1, noise.randrange(-(2**31), 2**31))),
        ).encode()
        assert len(bench.say(request, 0.001)) % 9 == 0
    for module in bench.modules:
        module.patch(TmclPatch(factory_default=True))
    assert bench.ask(Opcode.GET_VERSION, 1).status == Status.OK


@pytest.mark.parametrize(
    "change",
    [
        {"silence": True},
        {"late_reply_s": 0.05},
        {"bit_error_rate": 0.05},
        {"half_frame_rate": 0.5},
        {"unplugged": True},
        {"undervoltage": True},
    ],
    ids=lambda change: str(next(iter(change))),
)
def test_after_a_fault_during_a_move_the_line_is_as_good_as_new(change: dict[str, object]) -> None:
    bench = Bench(baud=115_200)
    bench.ask(Opcode.MVP, 0, value=500_000)
    bench.fault(**change)
    for _ in range(100):
        bench.say(tmcl.Request(1, Opcode.GAP, 1).encode(), 0.005)
        if not bench.line.plugged:
            bench.line.unplug()
    bench.fault(**dict.fromkeys(change, 0.0 if isinstance(next(iter(change.values())), float) else False))
    bench.wait(0.2)
    first, second = bench.ask(Opcode.GAP, 209), bench.ask(Opcode.GAP, 209)
    assert first.status == second.status == Status.OK
    rotor_microsteps = bench.modules[0].state().truth.rotor_fullsteps * 256
    assert second.value == pytest.approx(rotor_microsteps, abs=1000), "a true value, not one from before"


def test_two_modules_are_two_modules() -> None:
    bench = Bench((1, 2))
    bench.ask(Opcode.MVP, 0, value=51_200, address=1)
    bench.ask(Opcode.MVP, 0, value=-51_200, address=2)
    bench.wait(10.0)
    assert [bench.ask(Opcode.GAP, 1, address=address).value for address in (1, 2)] == [51_200, -51_200]
    bench.modules[0].patch(TmclPatch.model_validate({"blocked": True, "faults": {"silence": True}}))
    assert bench.ask(Opcode.GAP, 1, address=2).value == -51_200


COUNTING = "Loop: CALC ADD, 1\nAGP 0, 2\nAGP 1, 2\nJA Loop\n"
"""Variables 0 and 1 are the same, or 0 is one ahead."""
COUNTING_AND_ENDING = "Loop: CALC ADD, 1\nAGP 0, 2\nCOMP 500\nJC LT, Loop\nSTOP\n"


def _stored(bench: Bench, text: str) -> None:
    bench.ask(Opcode.ENTER_DOWNLOAD)
    for command in assemble(text, INSTRUCTIONS).commands:
        assert bench.ask(*command).status == Status.STORED
    bench.ask(Opcode.EXIT_DOWNLOAD)


def _in_flight(bench: Bench, *commands: tuple[int, int, int, int]) -> list[tmcl.Reply]:
    """Say all of them at once, as a client that waits for no answer; every answer, in order."""
    frames = [tmcl.Request(1, *command).encode() for command in commands]
    heard = bench.say(b"".join(frames), 3.0)
    assert len(heard) == 9 * len(frames)
    replies = [tmcl.Reply.decode(heard[at : at + 9]) for at in range(0, len(heard), 9)]
    assert [reply.opcode for reply in replies] == [command[0] for command in commands]
    return replies


@pytest.mark.sheet("FM-PD42-1241", "3.6.36")
@pytest.mark.parametrize("end", [Opcode.STOP_APPLICATION, Opcode.RESET_APPLICATION])
def test_commands_in_flight_when_a_program_is_stopped(end: Opcode) -> None:
    """Each is done and answered once, in its order; behind the answer to the stop no command of the program is done."""
    bench = Bench(baud=115_200)
    _stored(bench, COUNTING)
    count, other, status = (Opcode.GGP, 0, 2, 0), (Opcode.GGP, 1, 2, 0), (Opcode.GGP, 128, 0, 0)
    replies = _in_flight(
        bench,
        (Opcode.RUN_APPLICATION, 1, 0, 0),
        *[status, count, (Opcode.SGP, 10, 2, 111), (end, 0, 0, 0), (Opcode.SGP, 11, 2, 222)],
        *[count, other, (Opcode.GGP, 10, 2, 0), (Opcode.GGP, 11, 2, 0), status, count],
        *[(Opcode.RUN_APPLICATION, 1, 0, 0), status, count],
    )
    assert {reply.status for reply in replies} == {Status.OK}
    values = [reply.value for reply in replies]
    assert (values[1], values[8], values[9]) == (1, 111, 222)
    assert values[2] > 0, "it ran"
    stopped = values[6]
    assert stopped > values[2], "it ran on until the stop"
    assert values[7] in (stopped, stopped - 1)
    assert values[11] == stopped
    assert values[10] in (0, 3), "stopped, or reset"
    assert values[13] == 1, "and it runs again"
    assert values[14] > (0 if end is Opcode.RESET_APPLICATION else stopped)


def test_commands_in_flight_when_a_program_ends_by_itself() -> None:
    """It ends between two of them, and none is lost, done twice or answered out of turn."""
    bench = Bench(baud=115_200)
    _stored(bench, COUNTING_AND_ENDING)
    asked = [(Opcode.GGP, 128, 0, 0), (Opcode.GGP, 0, 2, 0)]
    written = [(Opcode.SGP, 20 + index, 2, index * index) for index in range(100)]
    mixed = [command for write in written for command in (*asked, write)]
    replies = _in_flight(bench, (Opcode.RUN_APPLICATION, 1, 0, 0), *mixed)
    assert {reply.status for reply in replies} == {Status.OK}
    states, counts = ([reply.value for reply in replies[first::3]] for first in (1, 2))
    ended = states.index(0)
    assert 0 < ended < len(states) - 1, "in the middle of them"
    assert states == [1] * ended + [0] * (len(states) - ended)
    assert counts == sorted(counts)
    assert set(counts[ended:]) == {500}
    kept = [bench.ask(Opcode.GGP, 20 + index, 2).value for index in range(100)]
    assert kept == [index * index for index in range(100)]


def test_the_telegram_pause_is_kept() -> None:
    bench = Bench(baud=115_200)
    bench.say(tmcl.Request(1, Opcode.SGP, 75, 0, 20).encode(), 0.1)
    started_s = bench.clock.now()
    bench.line.feed("client", tmcl.Request(1, Opcode.GAP, 1).encode(), started_s)
    due_s = bench.line.next_due_s()
    assert due_s is not None
    assert due_s - started_s == pytest.approx(180 / 115_200 + 0.020, abs=1e-9)
