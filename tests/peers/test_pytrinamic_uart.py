"""PyTrinamic's UART interface and its classes of chips, unmodified, and emulated chips on a single wire.

PyTrinamic sends and receives the bytes that it is given: it knows neither nodes nor CRC nor an echo, and its classes of
these chips have no UART access of their own (its TMC4671 and TMC7300 have, without CRC). So what stands between here,
`OverUart`, is what every user of it has to write; the CRC in it is not ours.
"""

from __future__ import annotations

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from pytrinamic.connections import ConnectionManager, UartIcInterface
from pytrinamic.evalboards import TMC5062_eval, TMC5072_eval, TMC5130_eval, TMC5160_eval
from pytrinamic.helpers import to_signed_32
from pytrinamic.ic import TMC5160, TMC7300, Access, Field, Register, RegisterApiDevice, RegisterGroup

from app.clock import WallClock
from app.emulators.line.framing import Fixed
from app.emulators.line.line import Line
from app.emulators.line.raw import RawChip
from app.emulators.line.uart import uart_line
from app.emulators.tmc5xxx import EmulatedTmc5xxx, Tmc5xxxModel
from app.registers.tmc5xxx.table import TABLES
from tests.links.test_datagram_uart import bitwise_crc
from tests.peers.emulator_process import emulator
from tests.peers.served_line import served
from tests.peers.test_pytrinamic import wait_for

PATIENCE_S = 20.0
EVALUATIONS = {"tmc5062": TMC5062_eval, "tmc5072": TMC5072_eval, "tmc5130": TMC5130_eval, "tmc5160": TMC5160_eval}
UART_MODELS: tuple[Tmc5xxxModel, ...] = ("tmc5062", "tmc5072", "tmc5130", "tmc5160")
GCONF, IFCNT, NODECONF, IOIN, XACTUAL = 0x00, 0x02, 0x03, 0x04, 0x21


class OverUart:
    """`write_mc` and `read_mc`, which PyTrinamic's evaluation board classes ask for, over its UART interface."""

    def __init__(self, interface: Any, node: int | None = 0, *, echo: bool = False) -> None:
        self._interface = interface
        self._head = bytes((0x05,)) if node is None else bytes((0x05, node))
        self._reply_bytes = 7 if node is None else 8
        self._echo = echo

    def read_mc(self, address: int, module_id: int = 1, signed: bool = False) -> int:
        reply = self.say(self._head + bytes((address,)), self._reply_bytes)
        assert len(reply) == self._reply_bytes, "no answer"
        assert bitwise_crc(reply[:-1]) == reply[-1]
        assert reply[-6] == address
        value = int.from_bytes(reply[-5:-1], "big")
        return int(to_signed_32(value)) if signed else value

    def write_mc(self, address: int, value: int, module_id: int = 1) -> None:
        self.say(self._head + bytes((address | 0x80,)) + (value & 0xFFFF_FFFF).to_bytes(4, "big"), 0)

    def say(self, body: bytes, reply_bytes: int) -> bytes:
        datagram = body + bytes((bitwise_crc(body),))
        echo = len(datagram) if self._echo else 0
        answer: bytes = self._interface.send_datagram(datagram, echo + reply_bytes)
        assert answer[:echo] == datagram[:echo]
        return answer[echo:]


def chips(*models: Tmc5xxxModel, nodes: tuple[int, ...] = (0,), echo: bool = False) -> Line:
    made = [EmulatedTmc5xxx(model, WallClock()) for model in models]
    for chip, node in zip(made, nodes, strict=True):
        if node:
            chip.write(NODECONF, node)
    return uart_line(made, WallClock(), nodes=nodes, echo=echo)


@pytest.fixture(params=[(model, echo) for model in UART_MODELS for echo in (False, True)],
                ids=lambda param: f"{param[0]}{' with echo' if param[1] else ''}")  # fmt: skip
def evaluation(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Any]:
    """PyTrinamic's class of the chip's board, over the UART of an emulated chip."""
    model, echo = request.param
    with served(chips(model, echo=echo), tmp_path / "uart"):
        arguments = f"--interface uart_ic --port {tmp_path / 'uart'} --data-rate 115200 --timeout 20"
        with ConnectionManager(arguments).connect() as interface:
            connection = OverUart(interface, None if model == "tmc5062" else 0, echo=echo)
            made = EVALUATIONS[model](connection)
            made.model = model
            yield made


def test_every_register_that_it_knows_can_be_read(evaluation: Any) -> None:
    table = TABLES[evaluation.model]
    known = [address for name, address in vars(evaluation.ics[0].REG).items() if not name.startswith("_")]
    addresses = {one for address in known for one in (address if isinstance(address, (tuple, list)) else (address,))}
    assert len(addresses) > 40
    for address in addresses:
        word = evaluation.read_register(address)
        row = table.at(address)
        if row is not None and row.access.readable:
            assert word & ~row.mask == 0, row.name


def test_it_is_the_right_chip(evaluation: Any) -> None:
    versions = {"tmc5062": 0x01, "tmc5072": 0x10, "tmc5130": 0x11, "tmc5160": 0x30}
    assert evaluation.read_register(IOIN) >> 24 == versions[evaluation.model]


def test_words_survive_both_ways_and_are_counted(evaluation: Any) -> None:
    before = evaluation.read_register(IFCNT)
    for value in (0, 1, -1, 0x1234_5678, -(2**31), 2**31 - 1):
        evaluation.write_register(XACTUAL, value)
        assert evaluation.read_register(XACTUAL, signed=True) == value
    assert evaluation.read_register(IFCNT) == before + 6


def test_it_moves_to_a_position(evaluation: Any) -> None:
    """By registers, as PyTrinamic's class of the chip does it where there is one (TMC5072, TMC5130)."""
    for address, value in ((0x26, 50_000), (0x28, 50_000), (0x2A, 50_000), (0x2B, 10), (0x27, 500_000)):
        evaluation.write_register(address, value)
    if evaluation.model in ("tmc5072", "tmc5130"):
        evaluation.ics[0].motors[0].move_to(3000, 500_000)
    else:
        evaluation.write_register(0x20, 0)
        evaluation.write_register(0x2D, 3000)
    wait_for(lambda: evaluation.read_register(XACTUAL, signed=True) == 3000)


def test_a_field_is_changed_alone(evaluation: Any) -> None:
    chip = evaluation.ics[0]
    toff = chip.FIELD_M1.TOFF if evaluation.model == "tmc5062" else chip.FIELD.TOFF
    toff = toff[0] if isinstance(toff, list) else toff
    before = evaluation.read_register(toff[0])
    evaluation.write_register_field(toff, 7)
    assert evaluation.read_register(toff[0]) == before & ~0xF | 7


def test_the_register_api_of_newer_classes(tmp_path: Path) -> None:
    """`RegisterApiDevice`, which PyTrinamic's newer classes of chips are, with a register of the TMC5160."""

    class Chip(RegisterApiDevice):  # type: ignore[misc]  # PyTrinamic has no types
        def __init__(self, connection: OverUart) -> None:
            self._connection = connection

        def read_register(self, register_address: int, block: int, signed: bool = False) -> int:
            return self._connection.read_mc(register_address, signed=signed)

        def write_register(self, register_address: int, block: int, value: int) -> None:
            self._connection.write_mc(register_address, value)

    group = RegisterGroup("ramp", 0, 0, 32)
    xactual = Register("XACTUAL", group, Access.RW, TMC5160.REG.XACTUAL, signed=True)
    chopconf = Register("CHOPCONF", group, Access.RW, TMC5160.REG.CHOPCONF)
    toff = Field("TOFF", chopconf, Access.RW, *TMC5160.FIELD.TOFF[1:])
    with served(chips("tmc5160"), tmp_path / "uart"), UartIcInterface(str(tmp_path / "uart"), 115_200, 20) as port:
        chip = Chip(OverUart(port))
        chip.write(xactual, -4321)
        assert chip.read(xactual) == -4321
        before = chip.read(chopconf)
        chip.write(toff, 9)
        assert (chip.read(toff), chip.read(chopconf)) == (9, before & ~0xF | 9)


def test_two_chips_on_one_wire_are_told_apart_by_their_node(tmp_path: Path) -> None:
    line = chips("tmc5160", "tmc5130", nodes=(0, 5), echo=True)
    with served(line, tmp_path / "uart"), UartIcInterface(str(tmp_path / "uart"), 115_200, 20) as port:
        one, other = (OverUart(port, node, echo=True) for node in (0, 5))
        one.write_mc(XACTUAL, 111)
        other.write_mc(XACTUAL, 555)
        assert (one.read_mc(XACTUAL), other.read_mc(XACTUAL)) == (111, 555)
        assert (one.read_mc(IOIN) >> 24, other.read_mc(IOIN) >> 24) == (0x30, 0x11)


def test_what_pytrinamic_says_by_itself_is_no_datagram_for_these_chips(tmp_path: Path) -> None:
    """`UartIcInterface.send`, five bytes without sync, node and CRC: nobody answers, and after a pause all is well."""
    with served(chips("tmc5160"), tmp_path / "uart"), UartIcInterface(str(tmp_path / "uart"), 115_200, 0.1) as port:
        with pytest.raises(struct.error):
            port.send(XACTUAL, 0)
        port.serial.timeout = PATIENCE_S
        chip = OverUart(port)
        chip.write_mc(XACTUAL, 7)
        assert chip.read_mc(XACTUAL) == 7


def test_a_wrong_crc_is_neither_obeyed_nor_answered(tmp_path: Path) -> None:
    with served(chips("tmc5160"), tmp_path / "uart"), UartIcInterface(str(tmp_path / "uart"), 115_200, 0.1) as port:
        assert port.send_datagram(bytes.fromhex("05 00 a1 00 00 00 05 00"), 0) == b""
        assert port.send_datagram(bytes.fromhex("05 00 21 00"), 8) == b""
        port.serial.timeout = PATIENCE_S
        assert (OverUart(port).read_mc(XACTUAL), OverUart(port).read_mc(IFCNT)) == (0, 0)


def test_its_classes_that_have_datagrams_of_their_own_reach_a_tmc5031_by_raw_frames(tmp_path: Path) -> None:
    """TMC7300 (and TMC4671) of PyTrinamic send five bytes and get five: those of the SPI, pipelined, at a raw pty."""
    chip = EmulatedTmc5xxx("tmc5031", WallClock())
    line = Line([RawChip(chip)], WallClock(), framing=Fixed(5))
    with served(line, tmp_path / "raw"), UartIcInterface(str(tmp_path / "raw"), 115_200, 20) as port:
        ic = TMC7300(port)
        ic.write_register(XACTUAL, -99)
        ic.read_register(XACTUAL)
        assert ic.read_register(GCONF, signed=True) == -99, "the answer to the datagram before"


def test_as_a_user_starts_it(tmp_path: Path) -> None:
    flags = ("--node", "2", "--echo", "--baud", "115200")
    with (
        emulator(*flags, pty=tmp_path / "uart", model="tmc5160"),
        UartIcInterface(str(tmp_path / "uart"), 115_200, 20) as port,
    ):
        chip = OverUart(port, 2, echo=True)
        chip.write_mc(XACTUAL, 12)
        assert (chip.read_mc(XACTUAL), chip.read_mc(IFCNT)) == (12, 1)
