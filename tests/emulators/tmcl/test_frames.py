"""Frames on the wire: layout, checksum, addresses, status codes, and that nothing can upset the module."""

from __future__ import annotations

import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.links.tmcl import Reply, Request, checksum, sound
from app.registers.tmcl.commands import BY_OPCODE, Opcode, Status
from tests.emulators.tmcl.harness import OK, Bench, frame

pytestmark = pytest.mark.sheet("FM-PD42-1241", "3")

ECHOED = "echoed"
EXAMPLES = {
    "GAP 1": ("01 06 01 00 00 00 00 00 08", None),
    "ROR": ("01 01 00 00 00 00 C8 00 CA", ECHOED),
    "ROL": ("01 02 00 00 00 00 C8 00 CB", ECHOED),
    "MST": ("01 03 00 00 00 00 00 00 04", ECHOED),
    "MVP ABS": ("01 04 00 00 00 01 5F 90 F5", ECHOED),
    "MVP REL": ("01 04 01 00 FF FF D8 F0 CC", ECHOED),
    "MVP COORD": ("01 04 02 00 00 00 00 08 0F", None),
    "SAP 4": ("01 05 04 00 00 00 C8 00 D2", "02 01 64 05 00 00 C8 00 34"),
    "SGP 66": ("01 09 42 00 00 00 00 03 4F", ECHOED),
    "GGP 66": ("01 0A 42 00 00 00 00 00 4D", "02 01 64 0A 00 00 00 01 72"),
    "STGP": ("01 0B 2A 02 00 00 00 00 38", ECHOED),
    "RSGP": ("01 0C 2A 02 00 00 00 00 39", ECHOED),
    "RFS START": ("01 0D 00 00 00 00 00 00 0E", ECHOED),
    "RFS STATUS": ("01 0D 02 00 00 00 00 00 10", None),
    "SIO": ("01 0E 00 02 00 00 00 01 12", ECHOED),
    "GIO": ("01 0F 00 01 00 00 00 00 11", "02 01 64 0F 00 00 01 2E A5"),
    "CALC MUL": ("01 13 02 00 FF FF EC 78 78", "02 01 64 13 FF FF EC 78 DC"),
    "SCO": ("01 1E 01 00 00 00 03 E8 0B", ECHOED),
    "CALCX MUL": ("01 21 02 00 00 00 00 00 24", ECHOED),
    "AGP": ("01 23 2A 02 00 00 00 00 50", ECHOED),
    "CLE ETO": ("01 24 01 00 00 00 00 00 26", ECHOED),
    "EI 255": ("01 19 FF 00 00 00 00 00 19", ECHOED),
    "stop application": ("01 80 00 00 00 00 00 00 81", ECHOED),
    "run from 1": ("01 81 01 00 00 00 00 01 84", ECHOED),
    "reset application": ("01 83 00 00 00 00 00 00 84", ECHOED),
    "enter download": ("01 84 00 00 00 00 00 00 85", ECHOED),
    "leave download": ("01 85 00 00 00 00 00 00 86", ECHOED),
    "version, binary": ("01 88 01 00 00 00 00 00 8A", "02 01 64 88 04 D9 01 2C F9"),
    "version, string": ("01 88 00 00 00 00 00 00 89", "02 31 32 34 31 56 31 34 34"),
    "event request": ("01 8A 01 00 00 00 00 01 8D", "02 01 64 8A 00 00 00 01 F2"),
    "unknown command 99": ("01 63 00 00 00 00 00 00 64", "02 01 02 63 00 00 00 00 68"),
    "wrong checksum": ("01 06 01 00 00 00 00 00 09", "02 01 01 00 00 00 00 00 04"),
}
"""Of the facts' frame.md, section 4: request, and the answer where it is printed there."""


@pytest.mark.sheet("FM-PD42-1241", "3.1")
@pytest.mark.sheet("FM-PD42-1241", "3.2")
@pytest.mark.parametrize("name", EXAMPLES)
def test_worked_examples(name: str) -> None:
    request, answer = (None if text is None else text for text in EXAMPLES[name])
    bench = Bench()
    bench.patch(inputs={"analog": 302})
    reply = bench.module.receive(frame(str(request)))
    assert reply is not None
    assert len(reply) == 9
    if answer is None:
        assert reply[:4] == bytes((2, 1, OK, frame(str(request))[1]))
        assert sound(reply)
    elif answer == ECHOED:
        sent = frame(str(request))
        body = bytes((2, 1, OK, sent[1])) + sent[4:8]
        assert reply == body + bytes((checksum(body),))
    else:
        assert reply == frame(answer)


@pytest.mark.sheet("FM-PD42-1241", "3.6.6")
def test_a_negative_position_as_printed() -> None:
    bench = Bench()
    bench.sap(1, -5000)
    assert bench.module.receive(frame("01 06 01 00 00 00 00 00 08")) == frame("02 01 64 06 FF FF EC 78 CF")


def test_a_stored_command_as_printed() -> None:
    bench = Bench()
    bench.do(Opcode.ENTER_DOWNLOAD)
    assert bench.module.receive(Request(1, 2, 0, 0, 500).encode()) == frame("02 01 65 02 00 00 01 F4 5F")


@pytest.mark.parametrize("opcode", [Opcode.FACTORY_DEFAULT, Opcode.RESET_MODULE])
def test_what_is_never_answered_as_printed(opcode: int) -> None:
    request = {137: "01 89 00 00 00 00 04 D2 60", 255: "01 FF 00 00 00 00 04 D2 D6"}[opcode]
    bench = Bench()
    assert bench.module.receive(frame(request)) is None
    with pytest.raises(TimeoutError):
        bench.module.exchange(frame(request))


@pytest.mark.sheet("FM-PD42-1241", "3.1.1")
@pytest.mark.parametrize("place", range(9))
def test_a_flipped_byte_is_noticed(place: int) -> None:
    bench = Bench()
    request = bytearray(Request(1, Opcode.SAP, 4, 0, 1000).encode())
    request[place] ^= 0x10
    reply = bench.module.receive(bytes(request))
    if place == 0:
        assert reply is None  # it is another module's
    else:
        assert reply is not None
        assert Reply.decode(reply).status == Status.WRONG_CHECKSUM
    assert bench.gap(4) == 51_200


def test_frames_of_other_modules_are_not_for_us() -> None:
    bench = Bench({"address": 5})
    assert bench.gap(8) == 1
    for address in {0, 1, 4, 6, 255}:
        assert bench.module.receive(Request(address, Opcode.GAP, 1).encode()) is None


@pytest.mark.sheet("FM-PD42-1241", "5.1")
def test_a_new_address_and_host_hold_from_the_next_command_on() -> None:
    # Open in all sources: which address the answer to the change itself bears. Here the one that was asked.
    bench = Bench()
    assert bench.ask(Opcode.SGP, 66, 0, 7).module == 1
    assert bench.module.receive(Request(1, Opcode.GAP, 1).encode()) is None
    bench.address = 7
    assert bench.ask(Opcode.SGP, 76, 0, 9).host == 2
    reply = bench.ask(Opcode.GAP, 1)
    assert (reply.host, reply.module) == (9, 7)


def test_a_frame_has_nine_bytes() -> None:
    bench = Bench()
    for length in (0, 8, 10):
        with pytest.raises(ValueError, match="9 bytes"):
            bench.module.receive(bytes(length))


@pytest.mark.sheet("FM-PD42-1241", "3.2.1")
def test_every_documented_status_can_be_had() -> None:
    bench = Bench()
    seen = {
        bench.ask(Opcode.GAP, 1).status,
        bench.ask(99).status,
        bench.ask(Opcode.GAP, 100).status,
        bench.ask(Opcode.SAP, 4, 0, -1).status,
        bench.ask(Opcode.JA).status,
    }
    bench.sgp(81, 2)
    seen.add(bench.ask(Opcode.ENTER_DOWNLOAD).status)
    wrong = bench.module.receive(bytes((1, 6, 1, 0, 0, 0, 0, 0, 0)))
    assert wrong is not None
    seen.add(wrong[2])
    bench.sgp(81, 0)
    bench.do(Opcode.ENTER_DOWNLOAD)
    seen.add(bench.ask(Opcode.JA).status)
    assert seen == {status for status in Status if status is not Status.EVENT}


@pytest.mark.sheet("FM-PD42-1241", "3.4")
@pytest.mark.parametrize("opcode", range(256))
def test_commands_that_there_are_not(opcode: int) -> None:
    bench = Bench()
    if opcode not in BY_OPCODE or BY_OPCODE[opcode].later:
        assert bench.ask(opcode).status == Status.INVALID_COMMAND


@pytest.mark.parametrize("opcode", range(64, 72))
def test_user_functions_are_not_in_this_firmware(opcode: int) -> None:
    assert Bench().ask(opcode, 1, 2, 3).status == Status.INVALID_COMMAND


FOR_PROGRAMS = [row for row in BY_OPCODE.values() if not row.direct and not row.later]


@pytest.mark.parametrize("opcode", [pytest.param(row.opcode, id=row.mnemonic) for row in FOR_PROGRAMS])
def test_commands_of_programs_are_not_available_in_direct_mode(opcode: int) -> None:
    # Open in all sources: what such a command is answered with. Here status 6, and nothing happens.
    bench = Bench()
    bench.do(Opcode.CALC, 9, 0, 42)
    assert bench.ask(opcode, 0, 0, 1).status == Status.NOT_AVAILABLE
    assert bench.do(Opcode.GET_STATUS, 2) == 42
    assert bench.ggp(130) == 0


OF_OTHERS = (Opcode.STAP, Opcode.RSAP)
"""Commands that modules know which keep axis parameters in their EEPROM."""


@pytest.mark.parametrize(
    ("opcode", "motor"),
    [
        (row.opcode, 1)
        for row in BY_OPCODE.values()
        if row.motor.startswith("motor, 0") and row.direct and row.opcode not in OF_OTHERS and not row.later
    ]
    + [(opcode, 1) for opcode in (Opcode.SGP, Opcode.GGP, Opcode.STGP, Opcode.RSGP, Opcode.AGP)]
    + [(Opcode.SIO, 1), (Opcode.GIO, 3)],
)
def test_a_motor_or_bank_that_there_is_not(opcode: int, motor: int) -> None:
    # Open: status 4 in one published firmware, 3 in another. Here 4, and nothing happens.
    bench = Bench()
    assert bench.ask(opcode, 0, motor, 1).status == Status.INVALID_VALUE
    assert bench.ask(opcode, 0, 200, 1).status == Status.INVALID_VALUE
    assert bench.gap(0) == bench.gap(2) == 0


@settings(max_examples=300, deadline=None)
@given(st.lists(st.binary(min_size=9, max_size=9), min_size=1, max_size=20))
def test_no_frame_can_upset_it(frames: list[bytes]) -> None:
    bench = _SHARED
    for raw in frames:
        _answers_properly(bench, raw)


@settings(max_examples=300, deadline=None)
@given(
    st.lists(
        st.tuples(
            st.sampled_from(sorted(BY_OPCODE)),
            st.integers(0, 255),
            st.sampled_from([0, 0, 0, 1, 2, 3, 255]),
            st.one_of(st.integers(-(2**31), 2**31 - 1), st.integers(0, 300), st.just(1234)),
        ),
        min_size=1,
        max_size=20,
    )
)
def test_no_command_can_upset_it(commands: list[tuple[int, int, int, int]]) -> None:
    bench = Bench()
    for command in commands:
        _answers_properly(bench, Request(1, *command).encode())
        bench.run(0.002)


_SHARED = Bench()


def _answers_properly(bench: Bench, raw: bytes) -> None:
    reply = bench.module.receive(raw)
    if reply is None:
        return
    assert len(reply) == 9
    if sound(reply):
        assert reply[2] in Status.__members__.values() or raw[1] in (134, 136)
        assert reply[3] in (raw[1], 0) or raw[1] in (134, 136)
    else:
        assert raw[1] in (134, 136)


def test_a_question_costs_little() -> None:
    # Eight channels are sampled at 1 kHz by asking so; the bound is loose, for machines that do other things too.
    bench = Bench()
    request = Request(1, Opcode.GAP, 1).encode()
    best_s = min(_timed(bench, request) for _ in range(5))
    assert best_s < 50e-6


def _timed(bench: Bench, request: bytes, times: int = 500) -> float:
    began_s = time.perf_counter()
    for _ in range(times):
        bench.module.exchange(request, 1.0)
    return (time.perf_counter() - began_s) / times
