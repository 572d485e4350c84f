"""When bytes arrive: ten bits each, one transaction after the other."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.links import tmcl
from app.registers.tmcl.commands import Opcode
from tests.emulators.line.harness import LineBench
from tests.emulators.line.modules import gap, sap

BAUD = 115_200
FRAME_S = 90 / BAUD


def test_without_a_baud_rate_the_answer_is_there_at_once() -> None:
    bench = LineBench()
    bench.say(sap(4, 51_200) + gap(4))
    replies = [tmcl.Reply.decode(delivery.data) for delivery in bench.wait()]
    assert [reply.value for reply in replies] == [51_200, 51_200]
    assert bench.line.next_due_s() is None


@given(baud=st.sampled_from([9600, 19_200, 57_600, 115_200, 1_000_000]), pause_ms=st.integers(0, 255))
def test_an_answer_takes_its_question_the_pause_and_itself(baud: int, pause_ms: int) -> None:
    bench = LineBench(baud=baud)
    bench.module.reply_pause_s = pause_ms / 1000
    bench.say(gap())
    due_s = 2 * 90 / baud + pause_ms / 1000
    assert bench.wait(due_s - 1e-9) == []
    (delivery,) = bench.wait(2e-9)
    assert delivery.due_s - bench.start_s == pytest.approx(due_s, abs=1e-12)


def test_the_module_hears_a_frame_when_its_last_byte_has_arrived() -> None:
    bench = LineBench(baud=BAUD)
    bench.say(gap())
    assert bench.module.heard[0][0] == pytest.approx(FRAME_S, abs=1e-12)  # the module was switched on at the start


def test_a_module_whose_time_runs_faster_hangs_on_the_same_wire() -> None:
    bench = LineBench(baud=BAUD, scale=10.0)
    bench.say(gap())
    (delivery,) = bench.wait(1.0)
    assert delivery.due_s - bench.start_s == pytest.approx(2 * FRAME_S, abs=1e-12)
    assert bench.module.heard[0][0] == pytest.approx(10 * FRAME_S, abs=1e-12)


@pytest.mark.parametrize("clients", ["aaa", "aba"], ids=["one client", "two clients"])
def test_transactions_come_one_after_the_other(clients: str) -> None:
    bench = LineBench(baud=BAUD)
    for client in clients:
        bench.say(gap(), client)
    arrived = bench.wait(1.0)
    assert [delivery.client for delivery in arrived] == list(clients)
    expected = [2 * FRAME_S * (count + 1) for count in range(3)]
    assert [delivery.due_s - bench.start_s for delivery in arrived] == pytest.approx(expected, abs=1e-12)


def test_a_client_cannot_have_more_answers_than_the_wire_carries() -> None:
    bench = LineBench(baud=BAUD)
    answers = 0
    while bench.elapsed_s < 1.0:
        bench.say(gap())
        due_s = bench.line.next_due_s()
        assert due_s is not None
        bench.clock.set(due_s)
        answers += len(bench.line.collect(due_s))
    assert answers == 640


def test_a_question_for_nobody_takes_its_time_all_the_same() -> None:
    bench = LineBench(baud=BAUD)
    bench.say(gap(address=9) + gap())
    (delivery,) = bench.wait(1.0)
    assert delivery.due_s - bench.start_s == pytest.approx(3 * FRAME_S, abs=1e-12)


def test_an_event_takes_its_time_from_when_it_came_up() -> None:
    bench = LineBench(baud=BAUD, move_s=0.05)
    bench.ask(tmcl.Request(1, Opcode.REQUEST_EVENT, 1, 0, 1).encode())
    bench.say(tmcl.Request(1, Opcode.MVP, 0, 0, 1000).encode())
    moved_s = bench.clock.now() + FRAME_S
    _, event = bench.wait(1.0)
    assert tmcl.is_event(event.data)
    assert event.due_s == pytest.approx(moved_s + 0.05 + FRAME_S, abs=1e-9)


def test_a_silence_inside_a_frame_counts_in_bytes_that_are_on_the_wire() -> None:
    """At 300 baud a byte takes 33 ms, three times the gap: a whole frame of them still is one frame."""
    bench = LineBench(baud=300)
    assert len(bench.ask(gap(), seconds=10.0)) == 9
