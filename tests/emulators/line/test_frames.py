"""What the module makes of bytes: frames, parts of frames, garbage."""

from __future__ import annotations

import random
import time

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.emulators.line.framing import GAP_S
from app.links import tmcl
from app.registers.tmcl.commands import Opcode, Status
from tests.emulators.line.harness import LineBench
from tests.emulators.line.modules import gap, sap


@given(st.lists(st.integers(1, 17), min_size=1, max_size=20))
def test_a_frame_may_come_in_any_pieces(sizes: list[int]) -> None:
    bench = LineBench()
    stream = b"".join(sap(5, value) for value in range(20))
    heard = b""
    for size in [*sizes, len(stream)]:
        piece, stream = stream[:size], stream[size:]
        heard += bench.ask(piece, seconds=GAP_S / 2)
    replies = [tmcl.Reply.decode(heard[at : at + 9]) for at in range(0, len(heard), 9)]
    assert [reply.value for reply in replies] == list(range(20))


@pytest.mark.parametrize("length", range(1, 9))
def test_a_part_of_a_frame_is_forgotten_after_the_gap(length: int) -> None:
    bench = LineBench()
    assert bench.ask(gap()[:length], seconds=GAP_S * 1.01) == b""
    assert tmcl.Reply.decode(bench.ask(gap())).ok


def test_a_part_of_a_frame_is_kept_until_the_gap() -> None:
    bench = LineBench()
    bench.ask(gap()[:4], seconds=GAP_S * 0.99)
    assert tmcl.Reply.decode(bench.ask(gap()[4:])).ok


@pytest.mark.sheet("FM-PD42-1241", "3.1.1")
def test_a_wrong_checksum_is_answered_with_status_1() -> None:
    bench = LineBench()
    reply = tmcl.Reply.decode(bench.ask(gap()[:8] + b"\x00"))
    assert reply.status == Status.WRONG_CHECKSUM


def test_garbage_before_a_frame_spoils_that_frame_and_no_later_one() -> None:
    bench = LineBench()
    bench.ask(b"\x01\x02\x03" + gap())
    assert tmcl.Reply.decode(bench.ask(gap())).ok


def test_a_thousand_corrupt_inputs_neither_crash_nor_hang_nor_stay() -> None:
    bench = LineBench((1, 2), seed=7)
    noise = random.Random(1000)
    started_s = time.monotonic()
    for _ in range(1000):
        frame = bytearray(sap(noise.randrange(256), noise.randrange(-(2**31), 2**31), noise.choice((1, 2))))
        match noise.randrange(4):
            case 0:
                frame[noise.randrange(9)] ^= 1 << noise.randrange(8)
            case 1:
                del frame[noise.randrange(1, 9) :]
            case 2:
                frame[noise.randrange(9) : 0] = noise.randbytes(noise.randrange(1, 30))
            case _:
                frame = bytearray(noise.randbytes(noise.randrange(1, 60)))
        heard = bench.ask(bytes(frame), seconds=GAP_S * 1.1)
        assert len(heard) % 9 == 0
        # One pause later the line is as good as new.
        assert tmcl.Reply.decode(bench.ask(gap(7), seconds=GAP_S * 1.1)).opcode == Opcode.GAP
    assert time.monotonic() - started_s < 10


@pytest.mark.sheet("FM-PD42-1241", "3")
def test_each_module_answers_for_its_address_alone() -> None:
    bench = LineBench((1, 2, 7))
    for value, address in ((10, 1), (20, 2), (70, 7)):
        bench.ask(sap(4, value, address))
    for value, address in ((10, 1), (20, 2), (70, 7)):
        reply = tmcl.Reply.decode(bench.ask(gap(4, address)))
        assert (reply.module, reply.value) == (address, value)
    assert bench.ask(gap(4, 3)) == b""


def test_two_modules_of_one_address_spoil_each_others_answers() -> None:
    bench = LineBench((1, 1))
    bench.modules[0].receive(sap(4, 0b0011))
    bench.modules[1].receive(sap(4, 0b0101))
    heard = bench.ask(gap(4))
    assert len(heard) == 9
    assert not tmcl.sound(heard)
