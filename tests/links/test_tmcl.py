"""TMCL frames against worked examples of the manuals, and what must never be taken for an answer."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.errors import BadReply
from app.links import tmcl
from app.links.tmcl import Reply, Request
from app.registers.tmcl.commands import BY_OPCODE, COMMANDS, STATUS_TEXTS, Opcode, reference_modes

BYTE = st.integers(0, 0xFF)
VALUE = st.integers(tmcl.VALUE_MIN, tmcl.VALUE_MAX)
REQUESTS = st.builds(Request, BYTE, BYTE, BYTE, BYTE, VALUE)

# What, as fields, as bytes. Computed by hand from the layout; PD42-1240, TMCM-1276 and TMCM-1290 print several of them.
REQUEST_EXAMPLES = [
    ("GAP 1, 0", Request(1, Opcode.GAP, 1), "01 06 01 00 00 00 00 00 08"),
    ("ROR 0, 51200", Request(1, Opcode.ROR, value=51200), "01 01 00 00 00 00 C8 00 CA"),
    ("ROL 0, 51200", Request(1, Opcode.ROL, value=51200), "01 02 00 00 00 00 C8 00 CB"),
    ("MST 0", Request(1, Opcode.MST), "01 03 00 00 00 00 00 00 04"),
    ("MVP ABS, 0, 90000", Request(1, Opcode.MVP, value=90000), "01 04 00 00 00 01 5F 90 F5"),
    ("MVP REL, 0, -10000", Request(1, Opcode.MVP, 1, value=-10000), "01 04 01 00 FF FF D8 F0 CC"),
    ("SGP 66, 0, 3", Request(1, Opcode.SGP, 66, value=3), "01 09 42 00 00 00 00 03 4F"),
    ("STGP 42, 2", Request(1, Opcode.STGP, 42, 2), "01 0B 2A 02 00 00 00 00 38"),
    ("SIO 0, 2, 1", Request(1, Opcode.SIO, 0, 2, 1), "01 0E 00 02 00 00 00 01 12"),
    ("CALC MUL, -5000", Request(1, Opcode.CALC, 2, value=-5000), "01 13 02 00 FF FF EC 78 78"),
    ("SCO 1, 0, 1000", Request(1, Opcode.SCO, 1, value=1000), "01 1E 01 00 00 00 03 E8 0B"),
    ("factory settings", Request(1, Opcode.FACTORY_DEFAULT, value=1234), "01 89 00 00 00 00 04 D2 60"),
]


@pytest.mark.sheet("FM-PD42-1241", "3.1")
@pytest.mark.sheet("FM-PD42-1241", "3.1.1")
@pytest.mark.parametrize(("what", "request_", "wire"), REQUEST_EXAMPLES, ids=[row[0] for row in REQUEST_EXAMPLES])
def test_requests_as_the_manuals_print_them(what: str, request_: Request, wire: str) -> None:
    assert request_.encode() == bytes.fromhex(wire), what
    assert Request.decode(bytes.fromhex(wire)) == request_
    assert tmcl.sound(bytes.fromhex(wire))


@pytest.mark.sheet("FM-PD42-1241", "3.2")
def test_a_reply_as_the_manuals_print_it() -> None:
    wire = bytes.fromhex("02 01 64 06 FF FF EC 78 CF")
    assert Reply.decode(wire) == Reply(2, 1, 100, Opcode.GAP, -5000)
    assert Reply(2, 1, 100, Opcode.GAP, -5000).encode() == wire
    assert tmcl.check_reply("line", Request(1, Opcode.GAP, 1).encode(), wire).value == -5000


@pytest.mark.sheet("FM-PD42-1241", "3.2.1")
def test_every_status_has_its_text() -> None:
    assert {code: Reply(2, 1, code, 6).ok for code in STATUS_TEXTS} == {
        1: False, 2: False, 3: False, 4: False, 5: False, 6: False, 100: True, 101: True, 128: False,
    }  # fmt: skip
    assert Reply(2, 1, 77, 6).status_text == "unknown status 77"


@pytest.mark.sheet("FM-PD42-1241", "3.6.35")
def test_the_position_reached_event_is_no_answer() -> None:
    event = bytes.fromhex("02 01 80 8A 00 00 00 01 0E")
    assert tmcl.is_event(event)
    assert not tmcl.is_event(bytes.fromhex("02 01 64 8A 00 00 00 01 F2")), "that is the answer to the request"
    assert not tmcl.is_event(event[:-1] + b"\x0f"), "a wrong checksum"
    with pytest.raises(BadReply, match="command 138 instead of 6"):
        tmcl.check_reply("line", Request(1, Opcode.GAP, 1).encode(), event)


def test_versions_of_both_forms() -> None:
    asked = Request(1, Opcode.GET_VERSION, 0).encode()
    string = bytes.fromhex("02 31 32 34 31 56 31 34 34")
    assert not tmcl.has_plain_reply(asked)
    assert tmcl.check_reply("line", asked, string).ok
    assert tmcl.version_string(string) == "1241V144"
    binary = tmcl.check_reply("line", Request(1, 136, 1).encode(), bytes.fromhex("02 01 64 88 04 D9 01 2C F9"))
    assert tmcl.module_version(binary.value) == (1241, "1.44")


@given(REQUESTS)
def test_requests_survive_the_wire(request_: Request) -> None:
    frame = request_.encode()
    assert tmcl.sound(frame)
    assert Request.decode(frame) == request_


@given(REQUESTS, st.integers(0, 8), st.integers(1, 0xFF))
def test_a_changed_byte_of_an_answer_is_never_taken_for_right(request_: Request, place: int, flip: int) -> None:
    asked = request_.encode()
    if not tmcl.has_plain_reply(asked):
        return
    good = Reply(2, request_.address, 100, request_.opcode, 4711).encode()
    assert tmcl.check_reply("line", asked, good).value == 4711
    bad = bytearray(good)
    bad[place] ^= flip
    with pytest.raises(BadReply, match="checksum"):
        tmcl.check_reply("line", asked, bytes(bad))


@pytest.mark.parametrize(
    ("answer", "why"),
    [
        (Reply(2, 2, 100, 6, 0).encode(), "module 2 answered instead of 1"),
        (Reply(2, 1, 100, 10, 0).encode(), "command 10 instead of 6"),
        (b"", "0 bytes"),
        (Reply(2, 1, 100, 6, 0).encode()[:5], "5 bytes"),
        (Reply(2, 1, 100, 6, 0).encode() * 2, "18 bytes"),
    ],
)
def test_an_answer_to_something_else_is_refused(answer: bytes, why: str) -> None:
    with pytest.raises(BadReply, match=why):
        tmcl.check_reply("line", Request(1, Opcode.GAP, 1).encode(), answer)


def test_a_module_that_could_not_read_the_command_need_not_name_it() -> None:
    answer = tmcl.check_reply("line", Request(1, 6, 1).encode(), bytes.fromhex("02 01 01 00 00 00 00 00 04"))
    assert answer.status_text == "wrong checksum"


def test_only_what_reads_and_changes_nothing_may_be_asked_twice() -> None:
    def retriable(opcode: int, type_: int = 0, motor: int = 0) -> bool:
        return tmcl.is_retriable(Request(1, opcode, type_, motor).encode())

    assert retriable(Opcode.GAP, 1)
    assert not retriable(Opcode.GAP, 207), "reading clears it"
    assert retriable(Opcode.RFS, 2)
    assert not retriable(Opcode.RFS, 0)
    assert retriable(Opcode.GCO, 1, 0)
    assert not retriable(Opcode.GCO, 1, 255), "restores from EEPROM"
    for row in COMMANDS:
        if row.moves and row.opcode != Opcode.RFS:
            assert not retriable(row.opcode), row.name
        assert retriable(row.opcode, 2) <= (row.reads or row.opcode == Opcode.RFS)


@pytest.mark.parametrize("field", ["address", "opcode", "type", "motor"])
@pytest.mark.parametrize("number", [-1, 256])
def test_what_does_not_fit_its_byte_is_refused(field: str, number: int) -> None:
    with pytest.raises(ValueError, match="one byte"):
        Request(**{"address": 1, "opcode": 1, field: number}).encode()


@pytest.mark.parametrize(("number", "value"), [(0xFFFF_FFFF, -1), (1 << 31, -(1 << 31)), (5, 5)])
def test_unsigned_numbers_become_the_same_bits(number: int, value: int) -> None:
    assert tmcl.as_value(number) == value


@pytest.mark.parametrize("number", [1 << 32, -(1 << 31) - 1])
def test_a_value_beyond_32_bits_is_refused(number: int) -> None:
    with pytest.raises(ValueError, match="32 bits"):
        Request(1, 5, 0, 0, number).encode()


@pytest.mark.parametrize("length", [0, 8, 10])
def test_a_frame_of_another_length_is_refused(length: int) -> None:
    with pytest.raises(ValueError, match="9 bytes"):
        Reply.decode(bytes(length))


@pytest.mark.sheet("FM-PD42-1241", "3.4")
def test_every_command_stands_once_in_the_list() -> None:
    assert len(BY_OPCODE) == len(COMMANDS)
    manual = (
        "ROR ROL MST MVP SAP GAP SGP GGP STGP RSGP RFS SIO GIO CALC COMP JC JA CSUB RSUB WAIT STOP SCO GCO CCO ACO "
        "CALCX AAP AGP CLE EI DI VECT RETI"
    )
    of_other_modules = {"STAP", "RSAP"}  # FM-TMCM-1161: they keep axis parameters in its EEPROM
    assert {row.mnemonic for row in COMMANDS if row.opcode < 64 and not row.later} == set(
        manual.split()
    ) | of_other_modules
    assert {opcode.value for opcode in Opcode} - {Opcode.BOOT} == set(BY_OPCODE)


@pytest.mark.sheet("FM-PD42-1241", "7.1")
def test_sixteen_reference_modes() -> None:
    assert reference_modes() == (1, 2, 3, 4, 5, 6, 7, 8, 65, 66, 67, 68, 133, 134, 135, 136)
