"""What can be wrong with a module's answers, and with the cable."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from app.emulators.line.faults import LineFaults, LinePatch
from app.links import tmcl
from app.registers.tmcl.commands import Opcode
from tests.emulators.line.harness import LineBench
from tests.emulators.line.modules import gap, sap


def test_a_silent_module_obeys() -> None:
    bench = LineBench((1, 2))
    bench.module.faults.silence = True
    assert bench.ask(sap(4, 77)) == b""
    assert tmcl.Reply.decode(bench.ask(gap(4, 2))).ok, "the other one speaks"
    bench.module.faults.silence = False
    assert tmcl.Reply.decode(bench.ask(gap(4))).value == 77


def test_a_silent_cable_silences_all() -> None:
    bench = LineBench((1, 2), faults=LineFaults(silence=True))
    assert bench.ask(sap(4, 77)) == bench.ask(gap(4, 2)) == b""
    assert bench.line.patch(LinePatch.model_validate({"faults": {"silence": False}})).faults.silence is False
    assert tmcl.Reply.decode(bench.ask(gap(4))).value == 77


@pytest.mark.parametrize("baud", [None, 115_200])
def test_a_late_answer_comes_so_much_later_and_meets_the_next_one(baud: int | None) -> None:
    bench = LineBench((1, 2), baud=baud)
    bench.module.faults.late_reply_s = 0.25
    bench.say(gap(4, 1))
    bench.wait(0.1)
    bench.say(gap(5, 2))
    second, first = bench.wait(1.0)
    assert tmcl.Reply.decode(second.data).module == 2
    assert tmcl.Reply.decode(first.data).module == 1
    wire_s = 180 / baud if baud else 0.0
    assert first.due_s - bench.start_s == pytest.approx(0.25 + wire_s, abs=1e-9)
    assert second.due_s - bench.start_s == pytest.approx(0.1 + wire_s, abs=1e-9)


def test_a_module_that_is_late_no_more_still_answers_in_order() -> None:
    bench = LineBench((1, 2))
    bench.module.faults.late_reply_s = 0.25
    bench.say(gap(4))
    bench.wait(0.1)
    bench.module.faults.late_reply_s = 0.0
    bench.say(gap(5))
    bench.say(gap(6, 2))
    other, first, second = bench.wait(1.0)
    assert [tmcl.Reply.decode(each.data).module for each in (other, first, second)] == [2, 1, 1]
    assert first.due_s == second.due_s == pytest.approx(bench.start_s + 0.25)


def test_a_late_cable_adds_to_a_late_module() -> None:
    bench = LineBench(faults=LineFaults(late_reply_s=0.5))
    bench.module.faults.late_reply_s = 0.25
    bench.say(gap())
    (delivery,) = bench.wait(1.0)
    assert delivery.due_s - bench.start_s == pytest.approx(0.75)


def test_bits_of_answers_flip_as_often_as_asked_and_never_those_of_questions() -> None:
    bench = LineBench(seed=3)
    bench.module.faults.bit_error_rate = 0.01
    right = tmcl.Reply(2, 1, 100, Opcode.GAP, 0).encode()
    flipped = 0
    for _ in range(1000):
        heard = bench.ask(gap(), seconds=0)
        assert len(heard) == 9
        flipped += (int.from_bytes(heard, "big") ^ int.from_bytes(right, "big")).bit_count()
    assert flipped == pytest.approx(720, rel=0.15)
    assert all(frame == gap() for _, frame in bench.module.heard)


def test_on_a_bad_cable_questions_suffer_too() -> None:
    bench = LineBench(faults=LineFaults(bit_error_rate=0.01))
    for _ in range(300):
        bench.ask(gap(), seconds=0)
    spoilt = sum(frame != gap() for _, frame in bench.module.heard)
    assert spoilt == pytest.approx(300 * (1 - 0.99**72), rel=0.2)


@pytest.mark.parametrize("whose", ["module", "line"])
def test_answers_break_off_as_often_as_asked(whose: str) -> None:
    bench = LineBench(faults=LineFaults(half_frame_rate=0.25 if whose == "line" else 0.0))
    bench.module.faults.half_frame_rate = 0.25 if whose == "module" else 0.0
    lengths = [len(bench.ask(gap(), seconds=0)) for _ in range(1000)]
    assert min(lengths) == 1
    assert sum(length < 9 for length in lengths) == pytest.approx(250, rel=0.2)


def test_an_unplugged_module_neither_hears_nor_speaks_while_the_others_do() -> None:
    bench = LineBench((1, 2))
    bench.module.faults.unplugged = True
    assert bench.line.plugged
    assert bench.ask(sap(4, 5)) == b""
    assert bench.module.heard == []
    assert tmcl.Reply.decode(bench.ask(gap(4, 2))).ok


def test_a_line_with_nothing_left_on_it_is_gone() -> None:
    bench = LineBench((1, 2), baud=9600)
    bench.say(gap())
    for module in bench.modules:
        module.faults.unplugged = True
    assert not bench.line.plugged
    bench.line.unplug()
    assert bench.wait(1.0) == [], "what was on the wire is lost"
    bench.module.faults.unplugged = False
    assert tmcl.Reply.decode(bench.ask(gap(), seconds=1.0)).ok


def test_a_plug_pulled_in_the_middle_of_a_frame_leaves_nothing_behind() -> None:
    bench = LineBench()
    bench.say(gap()[:5])
    bench.line.patch(LinePatch.model_validate({"faults": {"unplugged": True}}))
    bench.line.unplug()
    bench.say(gap())
    bench.line.patch(LinePatch.model_validate({"faults": {"unplugged": False}}))
    assert tmcl.Reply.decode(bench.ask(gap())).ok
    assert len(bench.module.heard) == 1


def test_a_patch_changes_what_it_names() -> None:
    bench = LineBench((3, 4), baud=9600)
    state = bench.line.patch(LinePatch.model_validate({"faults": {"bit_error_rate": 0.5}}))
    assert (state.baud, state.addresses, state.faults.bit_error_rate, state.faults.silence) == (
        9600,
        [3, 4],
        0.5,
        False,
    )
    assert bench.line.patch(LinePatch.model_validate({"baud": 19_200})).baud == 19_200
    assert bench.line.state().faults.bit_error_rate == 0.5


@pytest.mark.parametrize(
    "change",
    [{"bit_error_rate": 1.5}, {"late_reply_s": -1}, {"silence": "yes"}, {"noise": 1}, {"half_frame_rate": "nan"}],
)
def test_what_cannot_be_a_fault_is_refused(change: dict[str, object]) -> None:
    with pytest.raises(ValidationError):
        LinePatch.model_validate({"faults": change})
