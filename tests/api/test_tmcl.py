"""TMCL from a script: commands by field and by line, what comes back, and what is no command."""

from __future__ import annotations

import contextlib

import httpx
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from app.api.console.schemas import TmclFields
from app.api.console.tmcl_text import command_of
from app.clock import VirtualClock
from app.devices.core.tmcl_frames import spelled
from app.errors import UsageError
from app.links.tmcl import Request, check_reply
from app.links.tmcl_text import parse_line
from app.registers.tmcl.commands import COMMANDS


@pytest.mark.sheet("FM-PD42-1241", "3.6.4")
async def test_a_command_by_fields_or_by_line_is_the_same_nine_bytes(
    client: httpx.AsyncClient, motor: str, clock: VirtualClock
) -> None:
    bodies: list[dict[str, object]] = [
        {"line": "MVP ABS, 0, 51200"},
        {"command": "MVP", "type": "ABS", "motor": 0, "value": 51200},
        {"command": 4, "value": 51200},
        {"line": "mvp abs,0,$C800 ; one turn"},
        {"line": "4 0, 0, 0xc800"},
    ]
    answers = [(await client.post(f"{motor}/tmcl", json=body)).json() for body in bodies]
    for answer in answers:
        assert answer["request"] == Request(1, 4, 0, 0, 51200).encode().hex()
        reply = check_reply("", bytes.fromhex(answer["request"]), bytes.fromhex(answer["reply"]))
        assert (answer["status"], answer["status_text"], answer["value"]) == (100, "done", reply.value)
        assert answer["text"].startswith("MVP ABS, 0, 51200 -> ")
        assert answer["took_ms"] >= 0
    await clock.advance(5)
    assert (await client.get(f"{motor}/axes/0")).json()["position"] == 51200


async def test_an_error_status_is_an_answer(client: httpx.AsyncClient, motor: str) -> None:
    answer = await client.post(f"{motor}/tmcl", json={"line": "SAP 4, 0, -5"})
    assert answer.status_code == 200
    assert (answer.json()["status"], answer.json()["status_text"]) == (4, "invalid value")
    unknown = (await client.post(f"{motor}/tmcl", json={"command": 99})).json()
    assert (unknown["status"], unknown["status_text"]) == (2, "invalid command")


async def test_the_version_as_text(client: httpx.AsyncClient, motor: str) -> None:
    answer = (await client.post(f"{motor}/tmcl", json={"line": "get_version string"})).json()
    assert answer["text"].endswith("1241V144")
    assert answer["status"] is None
    binary = (await client.post(f"{motor}/tmcl", json={"line": "136 1, 0, 0"})).json()
    assert binary["value"] >> 16 == 1241


async def test_a_command_without_an_answer_has_none(client: httpx.AsyncClient, motor: str) -> None:
    answer = (await client.post(f"{motor}/tmcl", json={"line": "RESET_MODULE 1234"})).json()
    assert (answer["reply"], answer["status"], answer["value"]) == (None, None, None)


@pytest.mark.parametrize(
    ("body", "status", "words"),
    [
        ({"line": "MVP UP, 0, 1"}, 404, ["MVP", "'UP'", "ABS, REL, COORD"]),
        ({"line": "JUMP 5"}, 404, ["'JUMP'", "MVP"]),
        ({"line": "MVP ABS"}, 422, ["MVP ABS|REL|COORD", "position"]),
        ({"line": "MVP ABS, 0, far"}, 422, ["'far'", "hexadecimal"]),
        ({"line": "GAP 1,, 0"}, 422, ["GAP (axis parameter), (motor, 0)"]),
        ({"line": "RSUB 1, 2, 3, 4"}, 422, ["RSUB, without operands"]),
        ({"line": "GAP 256, 0"}, 422, ["type", "255"]),
        ({"line": "SAP 4, 0, 4294967296"}, 422, ["value", "32 bits"]),
        ({"line": " ; only a remark"}, 422, ["empty"]),
        ({"command": "MVP", "type": "SIDEWAYS"}, 404, ["SIDEWAYS", "REL"]),
        ({"command": 256}, 422, ["command"]),
        ({"command": "MVP", "value": 1 << 32}, 422, ["value"]),
        ({"command": "MVP", "motor": True}, 422, ["motor"]),
        ({"command": "MVP", "line": "MVP ABS, 0, 0"}, 422, ["line.command"]),
        ({}, 422, ["command"]),
        ({"line": ""}, 422, ["line"]),
    ],
)
async def test_what_is_no_command_is_told_with_what_would_be(
    client: httpx.AsyncClient, motor: str, body: dict[str, object], status: int, words: list[str]
) -> None:
    before = (await client.get(f"{motor}/link")).json()["counts"]
    answer = await client.post(f"{motor}/tmcl", json=body)
    assert answer.status_code == status, answer.text
    for word in words:
        assert word in answer.json()["detail"]
    assert (await client.get(f"{motor}/link")).json()["counts"] == before  # nothing went out


async def test_a_chip_speaks_no_tmcl(client: httpx.AsyncClient) -> None:
    answer = await client.post("devices/bench/tmcl", json={"line": "GAP 1, 0"})
    assert answer.status_code == 409
    assert "exchange" in answer.json()["way_out"]


# --- the text -----------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("line", "command"),
    [
        ("ROR 0, 5000", (1, 0, 0, 5000)),
        ("MST 0", (3, 0, 0, 0)),
        ("MVP COORD, 0, 7", (4, 2, 0, 7)),
        ("SAP 4, 0, -1", (5, 4, 0, -1)),
        ("SAP 4, 0, 0xFFFFFFFF", (5, 4, 0, -1)),
        ("GGP 66, 0", (10, 66, 0, 0)),
        ("RFS START, 0", (13, 0, 0, 0)),
        ("CALC ADD, 7", (19, 0, 0, 7)),
        ("EI 255", (25, 255, 0, 0)),
        ("RSUB", (24, 0, 0, 0)),
        ("STOP_APPLICATION", (128, 0, 0, 0)),
        ("stop application", (128, 0, 0, 0)),
        ("RUN_APPLICATION ADDRESS, 10", (129, 1, 0, 10)),
        ("SAP 4, 0, 1000 // pps; fast", (5, 4, 0, 1000)),
        ("200 1, 2, 3", (200, 1, 2, 3)),
    ],
)
def test_lines_as_in_a_program(line: str, command: tuple[int, int, int, int]) -> None:
    assert parse_line(line) == command


@settings(deadline=None)
@given(
    opcode=st.one_of(st.sampled_from([row.opcode for row in COMMANDS]), st.integers(0, 255)),
    type_=st.integers(0, 255) | st.just(0),
    motor=st.integers(0, 255) | st.just(0),
    value=st.integers(-(1 << 31), (1 << 31) - 1) | st.just(0),
)
def test_what_the_log_prints_can_be_sent_again(opcode: int, type_: int, motor: int, value: int) -> None:
    assert parse_line(spelled(Request(1, opcode, type_, motor, value))) == (opcode, type_, motor, value)


@settings(deadline=None)
@given(line=st.text(max_size=120) | st.from_regex(r"\A(MVP|SAP|ROR|GAP)[ ,]*[-A-Z0-9, $x]{0,30}\Z"))
def test_any_line_is_a_command_or_an_error_of_ours(line: str) -> None:
    with contextlib.suppress(UsageError):  # UnknownThing and OutOfRange are among them
        Request(1, *parse_line(line)).encode()


def test_values_beyond_the_sign_are_taken_for_their_bits() -> None:
    assert command_of(TmclFields(command="SAP", type=0, value=0xFFFF_FFFE)) == (5, 0, 0, -2)
