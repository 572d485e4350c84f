"""Chips on an emulated single wire, byte by byte on a virtual clock: times, echo, finding the beginning again, faults.

Sections are of the TMC5160A data sheet, rev. 1.14.
"""

from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.clock import VirtualClock
from app.emulators.line.faults import LineFaults, LinePatch
from app.emulators.line.framing import BAUD_UNSAID, IDLE_BITS, PAUSE_BITS
from app.emulators.line.line import Delivery, Line
from app.emulators.line.uart import uart_line
from app.emulators.tmc5xxx import EmulatedTmc5xxx, Tmc5xxxModel, Tmc5xxxPatch
from app.links.datagram_uart import IFCNT, UartForm

NODECONF, XACTUAL, XTARGET = 0x03, 0x21, 0x2D
NODE = UartForm(0)
BAUD = 10_000
BIT_S, BYTE_S = 1 / BAUD, 10 / BAUD


class Wire:
    """Chips of `models` at `nodes`, and a client."""

    def __init__(
        self,
        *models: Tmc5xxxModel,
        nodes: tuple[int, ...] = (0,),
        baud: int | None = BAUD,
        echo: bool = False,
        shared_bus: bool = False,
    ) -> None:
        self.clock = VirtualClock()
        self.chips = [EmulatedTmc5xxx(model, self.clock) for model in models or ("tmc5160",)]
        for chip, node in zip(self.chips, nodes, strict=True):
            if node:
                chip.write(NODECONF, node)
        self.line: Line = uart_line(
            self.chips, self.clock, nodes=nodes, baud=baud, echo=echo, shared_bus=shared_bus, seed=1
        )
        self.line.join("host")

    def say(self, data: bytes, after_s: float = 0.0, client: str = "host") -> None:
        """Put `data` on the wire, `after_s` [s] later than now."""
        self.clock.set(self.clock.now() + after_s)
        self.line.feed(client, data, self.clock.now())

    def hear(self, within_s: float = 1.0) -> list[Delivery]:
        self.clock.set(self.clock.now() + within_s)
        return self.line.collect(self.clock.now())

    def ask(self, data: bytes, after_s: float = 0.0) -> bytes:
        self.say(data, after_s)
        return b"".join(delivery.data for delivery in self.hear())


# --- datagrams ------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("model", "form"),
    [("tmc5160", NODE), ("tmc5130", NODE), ("tmc5072", NODE), ("tmc5062", UartForm(None))],
)
def test_what_is_written_is_read_and_counted(model: Tmc5xxxModel, form: UartForm) -> None:
    """5.1: a write has no answer, and counts."""
    wire = Wire(model)
    assert wire.ask(form.write(XACTUAL, 0xFFFF_FE0C)) == b""
    assert wire.ask(form.read(XACTUAL)) == form.reply(XACTUAL, 0xFFFF_FE0C)
    assert wire.ask(form.read(IFCNT)) == form.reply(IFCNT, 1)


def test_bytes_may_come_one_by_one_and_many_datagrams_at_once() -> None:
    wire = Wire(baud=None)
    for byte in NODE.write(XACTUAL, 5)[:-1]:
        wire.say(bytes((byte,)), after_s=PAUSE_BITS / BAUD_UNSAID * 0.9)
    wire.say(NODE.write(XACTUAL, 5)[-1:] + NODE.write(XTARGET, 6) + NODE.read(XACTUAL))
    assert b"".join(delivery.data for delivery in wire.hear()) == NODE.reply(XACTUAL, 5)
    assert wire.ask(NODE.read(IFCNT)) == NODE.reply(IFCNT, 2)


@pytest.mark.parametrize(("code", "bits"), [(0, 8), (1, 8), (2, 24), (7, 56), (15, 120)])
def test_an_answer_comes_after_senddelay_and_takes_its_time(code: int, bits: int) -> None:
    """5.1.2: the delay is a multiple of eight bit times."""
    wire = Wire()
    wire.ask(NODE.write(NODECONF, code << 8))
    asked_s = wire.clock.now()
    wire.say(NODE.read(XACTUAL))
    (answer,) = wire.hear()
    assert answer.due_s - asked_s == pytest.approx(4 * BYTE_S + bits * BIT_S + 8 * BYTE_S)


def test_chips_are_told_apart_by_their_node() -> None:
    wire = Wire("tmc5160", "tmc5130", nodes=(1, 2))
    one, two = UartForm(1), UartForm(2)
    wire.ask(one.write(XACTUAL, 11))
    wire.ask(two.write(XACTUAL, 22))
    assert wire.ask(one.read(XACTUAL)) == NODE.reply(XACTUAL, 11)
    assert wire.ask(two.read(XACTUAL)) == NODE.reply(XACTUAL, 22)
    assert wire.ask(UartForm(3).read(XACTUAL)) == b""
    wire.ask(one.write(NODECONF, 9))
    assert wire.ask(one.read(XACTUAL)) == b""
    assert wire.ask(UartForm(9).read(XACTUAL)) == NODE.reply(XACTUAL, 11)


# --- finding the beginning again --------------------------------------------------------------------


@pytest.mark.parametrize("spoilt", [NODE.read(XACTUAL)[:-1] + b"\0", b"\xff" + NODE.read(XACTUAL), b"\x50"])
def test_what_is_wrong_is_ignored_until_the_line_was_silent(spoilt: bytes) -> None:
    """5.1.1: after an error the line has to be idle for 12 bit times."""
    wire = Wire()
    wire.say(spoilt + NODE.read(XACTUAL))
    assert wire.hear(0.1) == [], "what follows without a pause is lost too"
    assert wire.ask(NODE.read(XACTUAL)) == NODE.reply(XACTUAL, 0)
    for silence_bits, answers in ((IDLE_BITS - 1, []), (IDLE_BITS + 1, [NODE.reply(XACTUAL, 0)])):
        wire.say(spoilt)  # on the wire until its last byte; from there on the silence counts
        wire.say(NODE.read(XACTUAL), after_s=len(spoilt) * BYTE_S + silence_bits * BIT_S)
        assert [delivery.data for delivery in wire.hear()] == answers


@pytest.mark.parametrize("length", [1, 2, 3, 5, 7])
def test_half_a_datagram_is_forgotten_after_a_pause(length: int) -> None:
    """5.1.1: 63 bit times between two start bits."""
    wire = Wire()
    half = NODE.write(XTARGET, 99)[:length]
    wire.say(half)
    wire.say(NODE.read(XACTUAL), after_s=len(half) * BYTE_S + (PAUSE_BITS + 1) * BIT_S)
    assert [delivery.data for delivery in wire.hear()] == [NODE.reply(XACTUAL, 0)]
    assert wire.chips[0].read(XTARGET) == 0


@settings(max_examples=50, deadline=None)
@given(st.binary(max_size=40), st.integers(0, 2**32 - 1))
def test_after_any_garbage_and_silence_all_is_well(garbage: bytes, word: int) -> None:
    wire = Wire()
    wire.say(garbage)
    wire.hear()
    wire.ask(NODE.write(XTARGET, word))
    assert wire.ask(NODE.read(XTARGET)) == NODE.reply(XTARGET, word)


# --- one wire -------------------------------------------------------------------------------------


def test_an_echo_is_heard_as_it_is_said_and_before_the_answer() -> None:
    wire = Wire(echo=True)
    wire.say(NODE.read(XACTUAL))
    heard = wire.hear()
    assert b"".join(delivery.data for delivery in heard) == NODE.read(XACTUAL) + NODE.reply(XACTUAL, 0)
    assert heard[0].due_s == pytest.approx(4 * BYTE_S)
    assert wire.ask(NODE.write(XTARGET, 1)) == NODE.write(XTARGET, 1)


def test_who_speaks_into_an_answer_spoils_both() -> None:
    """The wire is one: pipelining is not possible, and is found out here."""
    wire = Wire()
    wire.say(NODE.read(XACTUAL))
    answer_s = 4 * BYTE_S + 8 * BIT_S
    wire.say(NODE.read(XTARGET), after_s=answer_s + 4 * BYTE_S)
    (heard,) = wire.hear()
    assert heard.data == bytes(8)
    assert wire.ask(NODE.read(XTARGET)) == NODE.reply(XTARGET, 0)
    wire.say(NODE.read(XACTUAL))
    wire.say(NODE.read(XTARGET), after_s=answer_s + 8 * BYTE_S)
    assert [delivery.data for delivery in wire.hear()] == [NODE.reply(XACTUAL, 0), NODE.reply(XTARGET, 0)]


def test_on_a_shared_wire_everybody_hears_everything() -> None:
    wire = Wire(shared_bus=True, echo=True)
    wire.line.join("other")
    wire.say(NODE.read(XACTUAL))
    heard: dict[object, bytes] = {}
    for delivery in wire.hear():
        heard[delivery.client] = heard.get(delivery.client, b"") + delivery.data
    assert heard == dict.fromkeys(("host", "other"), NODE.read(XACTUAL) + NODE.reply(XACTUAL, 0))


# --- faults -----------------------------------------------------------------------------------------


def test_a_silent_chip_obeys_and_an_unplugged_one_does_not() -> None:
    wire = Wire()
    for fault, obeyed in (("silence", 5), ("unplugged", 0)):
        wire.ask(NODE.write(XTARGET, 0))
        wire.chips[0].patch(Tmc5xxxPatch.model_validate({"faults": {fault: True}}))
        assert wire.ask(NODE.read(XTARGET)) == b""
        wire.ask(NODE.write(XTARGET, 5))
        wire.chips[0].patch(Tmc5xxxPatch.model_validate({"faults": {fault: False}}))
        assert wire.ask(NODE.read(XTARGET)) == NODE.reply(XTARGET, obeyed)


def test_a_cable_that_is_out() -> None:
    wire = Wire()
    wire.line.patch(LinePatch.model_validate({"faults": {"unplugged": True}}))
    assert not wire.line.plugged
    wire.line.unplug()
    assert wire.ask(NODE.read(XACTUAL)) == b""
    wire.line.patch(LinePatch.model_validate({"faults": {"unplugged": False}}))
    assert wire.ask(NODE.read(XACTUAL)) == NODE.reply(XACTUAL, 0)


def test_bits_flip_in_questions_and_answers_and_no_flipped_write_is_obeyed() -> None:
    """5.1: the CRC finds every single flipped bit, and nearly all that are more."""
    wire = Wire(baud=None)
    wire.line.faults = LineFaults(bit_error_rate=0.01)
    good = lost = bad = 0
    for number in range(300):
        wire.ask(NODE.write(XTARGET, number))
        assert wire.chips[0].read(XTARGET) <= number
        heard = wire.ask(NODE.read(XTARGET))
        if not heard:
            lost += 1
        else:
            try:
                NODE.data_of(XTARGET, heard)
                good += 1
            except ValueError:
                bad += 1
    assert good > 50
    assert lost > 20
    assert bad > 20


def test_answers_break_off() -> None:
    wire = Wire(baud=None)
    wire.line.faults = LineFaults(half_frame_rate=1.0)
    lengths = {len(wire.ask(NODE.read(XACTUAL))) for _ in range(100)}
    assert lengths == set(range(1, 8))


def test_the_same_seed_gives_the_same_noise() -> None:
    def noisy() -> list[bytes]:
        wire = Wire(baud=None)
        wire.line.faults = LineFaults(bit_error_rate=0.02, half_frame_rate=0.3)
        return [wire.ask(NODE.read(XACTUAL)) for _ in range(30)]

    assert noisy() == noisy()
    assert len(set(noisy())) > 5
