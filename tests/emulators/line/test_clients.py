"""Who hears what, with several clients on one line."""

from __future__ import annotations

import pytest

from app.links import tmcl
from app.registers.tmcl.commands import Opcode
from tests.emulators.line.harness import LineBench
from tests.emulators.line.modules import gap, sap

EVENTS = tmcl.Request(1, Opcode.REQUEST_EVENT, 1, 0, 1).encode()
NEXT_EVENT = tmcl.Request(1, Opcode.REQUEST_EVENT, 0, 0, 1).encode()
MOVE = tmcl.Request(1, Opcode.MVP, 0, 0, 1000).encode()


def test_everybody_gets_the_answers_to_his_own_questions() -> None:
    bench = LineBench()
    bench.say(sap(4, 1), "a")
    bench.say(sap(5, 2), "b")
    bench.say(gap(4), "a")
    bench.say(gap(5), "b")
    heard = {"a": list[int](), "b": list[int]()}
    for delivery in bench.wait(0.1):
        heard[str(delivery.client)].append(tmcl.Reply.decode(delivery.data).value)
    assert heard == {"a": [1, 1], "b": [2, 2]}


def test_two_clients_may_each_be_in_the_middle_of_a_frame() -> None:
    bench = LineBench()
    bench.say(gap(4)[:5], "a")
    bench.say(gap(5)[:3], "b")
    bench.say(gap(4)[5:], "a")
    bench.say(gap(5)[3:], "b")
    assert [delivery.client for delivery in bench.wait()] == ["a", "b"]


def test_on_a_shared_bus_everybody_hears_all_but_himself() -> None:
    bench = LineBench(shared_bus=True)
    bench.say(gap(), "a")
    arrived = bench.wait()
    reply = bench.module.receive(gap())
    assert b"".join(delivery.data for delivery in arrived if delivery.client == "a") == reply
    assert b"".join(delivery.data for delivery in arrived if delivery.client == "b") == gap() + (reply or b"")


def test_on_a_shared_bus_the_question_is_heard_before_the_answer() -> None:
    bench = LineBench(shared_bus=True, baud=115_200)
    bench.say(gap(), "a")
    heard = [delivery for delivery in bench.wait(1.0) if delivery.client == "b"]
    assert heard[0].data == gap()
    assert heard[1].due_s - heard[0].due_s == pytest.approx(90 / 115_200, abs=1e-9)


def test_on_a_shared_bus_two_who_talk_at_once_are_not_understood() -> None:
    bench = LineBench(shared_bus=True)
    bench.say(gap(4)[:5], "a")
    bench.say(gap(5)[:4], "b")
    bench.wait(0.1)
    assert bench.module.heard[0][1] == gap(4)[:5] + gap(5)[:4]
    assert tmcl.Reply.decode(bench.ask(gap())).ok, "and understood again after the gap"


def test_an_event_goes_to_who_asked_for_it() -> None:
    bench = LineBench()
    bench.ask(EVENTS, "b")
    bench.say(MOVE, "a")
    arrived = bench.wait(0.2)
    assert [(delivery.client, tmcl.is_event(delivery.data)) for delivery in arrived] == [("a", False), ("b", True)]


def test_on_a_shared_bus_an_event_goes_to_everybody() -> None:
    bench = LineBench(shared_bus=True)
    bench.ask(EVENTS, "b")
    bench.say(MOVE, "a")
    events = [delivery.client for delivery in bench.wait(0.2) if tmcl.is_event(delivery.data)]
    assert sorted(map(str, events)) == ["a", "b"]


def test_nobody_looks_for_events_that_nobody_wants() -> None:
    bench = LineBench()
    bench.ask(MOVE)
    assert bench.line.next_due_s() is None
    bench.wait(0.2)
    assert bench.ask(EVENTS, seconds=0.2)[2:4] == bytes((100, 138)), "its answer, and not the event of the past"


def test_one_event_is_one_event() -> None:
    bench = LineBench()
    bench.ask(NEXT_EVENT)
    bench.say(MOVE)
    assert sum(tmcl.is_event(delivery.data) for delivery in bench.wait(0.2)) == 1
    assert bench.line.next_due_s() is None


def test_what_was_for_somebody_who_has_left_is_lost() -> None:
    bench = LineBench(baud=9600)
    bench.ask(EVENTS, "a", seconds=1.0)
    bench.say(MOVE, "a")
    bench.say(gap(), "b")
    bench.line.leave("a")
    assert {delivery.client for delivery in bench.wait(1.0)} == {"b"}
    assert bench.line.next_due_s() is None
    bench.say(gap(), "a")
    assert bench.wait(1.0) == [], "who is not on the line is not heard"
