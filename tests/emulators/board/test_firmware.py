"""The emulated board against what its published firmware does, frame by frame, and what of it reaches the chip."""

from __future__ import annotations

import random
from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.clock import VirtualClock
from app.emulators.board.board import EmulatedBoard
from app.emulators.board.build import build_board
from app.emulators.board.options import BoardPatch
from app.emulators.board.registers import ChipRegisters
from app.emulators.tmc4361 import EmulatedTmc4361
from app.errors import UnknownThing
from app.links.datagram40 import Request as Datagram
from app.links.tmcl import Reply, Request, sound
from app.registers.evaluation_board import BoardOpcode
from app.registers.tmc4361.table import TMC4361
from app.registers.tmcl.commands import Opcode, Status

X_ACTUAL, V_MAX, RAMP_MODE, POS_COMP, EVENTS = 0x21, 0x24, 0x20, 0x32, 0x0E


class WatchedChip(EmulatedTmc4361):
    """The emulated chip itself, with a look at its bus."""

    def __init__(self, clock: VirtualClock) -> None:
        super().__init__(clock)
        self.heard: list[Datagram] = []

    def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
        self.heard.append(Datagram.decode(frame))
        return super().exchange(frame, at_s)


class Bench:
    def __init__(self) -> None:
        self.clock = VirtualClock()
        self.chip = WatchedChip(self.clock)
        self.board = EmulatedBoard(self.chip)

    def ask(self, opcode: int, type_: int = 0, motor: int = 0, value: int = 0) -> Reply:
        frame = self.board.receive(Request(1, opcode, type_, motor, value).encode())
        assert frame is not None
        assert sound(frame)
        reply = Reply.decode(frame)
        assert (reply.host, reply.module, reply.opcode) == (2, 1, opcode)
        return reply

    def status(self, opcode: int, type_: int = 0, motor: int = 0, value: int = 0) -> int:
        return self.ask(opcode, type_, motor, value).status

    def read(self, address: int) -> int:
        return self.ask(BoardOpcode.READ_MC, address).value

    def datagrams(self, act: Callable[[], object]) -> list[tuple[int, bool, int]]:
        """What goes over the chip's bus while `act` is done: (address, write, data)."""
        self.chip.heard.clear()
        act()
        return [(datagram.address, datagram.write, datagram.data) for datagram in self.chip.heard]


@pytest.fixture
def bench() -> Bench:
    return Bench()


# --- frames ---------------------------------------------------------------------------------------


def test_other_modules_are_not_answered(bench: Bench) -> None:
    for module in (0, 2, 255):
        assert bench.board.receive(Request(module, Opcode.GET_VERSION, 1).encode()) is None


def test_a_wrong_checksum_is_answered_with_the_command_before(bench: Bench) -> None:
    wrong = bytearray(Request(1, Opcode.MVP, 0, 0, 1000).encode())
    wrong[8] ^= 1
    assert bench.board.receive(bytes(wrong)) == Reply(2, 0, Status.WRONG_CHECKSUM, 0).encode()
    bench.read(X_ACTUAL)
    assert bench.board.receive(bytes(wrong)) == Reply(2, 1, Status.WRONG_CHECKSUM, BoardOpcode.READ_MC).encode()
    assert bench.read(0x37) == 0, "and not obeyed"


@pytest.mark.parametrize("length", [0, 8, 10])
def test_frames_of_another_length_do_not_reach_it(bench: Bench, length: int) -> None:
    with pytest.raises(ValueError, match="9 bytes"):
        bench.board.receive(bytes(length))


def test_any_thousand_frames_are_answered_or_not_for_it() -> None:
    chance = random.Random(12)
    bench = Bench()
    for number in range(1000):
        frame = bytearray(chance.randbytes(9))
        if number % 2:
            frame[0] = 1
            frame[8] = sum(frame[:8]) & 0xFF
        if frame[1] == Opcode.RESET_MODULE:
            continue
        bench.clock.set(bench.clock.now() + 0.001)
        reply = bench.board.receive(bytes(frame))
        assert reply is None or len(reply) == 9
    bench.board.patch(BoardPatch(power_cycle=True))
    assert bench.read(0x28) == 320_000


# --- registers ------------------------------------------------------------------------------------


def test_reading_is_the_same_datagram_twice(bench: Bench) -> None:
    assert bench.datagrams(lambda: bench.read(X_ACTUAL)) == [(X_ACTUAL, False, 0)] * 2


def test_reading_events_clears_them_twice(bench: Bench) -> None:
    """What comes up between the two datagrams is lost: a driver must not rely on them over a board."""
    assert bench.datagrams(lambda: bench.read(EVENTS)) == [(EVENTS, False, 0)] * 2
    assert bench.read(EVENTS) == 0


def test_writing_is_one_datagram_and_the_answer_bears_the_value(bench: Bench) -> None:
    assert bench.datagrams(lambda: bench.ask(BoardOpcode.WRITE_MC, POS_COMP, 0, -2)) == [(POS_COMP, True, 0xFFFF_FFFE)]
    assert bench.ask(BoardOpcode.WRITE_MC, POS_COMP, 0, 77).value == 77


@given(st.sampled_from(sorted({row.address for row in TMC4361})), st.integers(0, 2**32 - 1))
def test_what_cannot_be_read_is_remembered(address: int, word: int) -> None:
    heard: list[bytes] = []

    class Chip:
        model = "tmc4361"
        clock = EmulatedTmc4361(VirtualClock()).clock

        def exchange(self, frame: bytes, at_s: float | None = None) -> bytes:
            heard.append(frame)
            return bytes(5)

    registers = ChipRegisters(Chip(), TMC4361)
    readable = any(row.access.readable for row in TMC4361.meanings(address))
    registers.write(address, word)
    assert registers.read(address) == (0 if readable else word)
    assert len(heard) == (3 if readable else 1)


@pytest.mark.parametrize("motor", [0, 15])
def test_old_names_of_register_access_still_work(bench: Bench, motor: int) -> None:
    bench.ask(69, POS_COMP, motor, 5)
    assert bench.ask(70, POS_COMP, motor).value == bench.read(POS_COMP) == 5


def test_a_chip_that_does_not_answer_reads_as_zeros(bench: Bench) -> None:
    bench.board.patch(BoardPatch.model_validate({"chip": {"faults": {"unplugged": True}}}))
    assert bench.read(0x28) == 0
    assert bench.status(Opcode.GAP, 1) == Status.OK


# --- the board ------------------------------------------------------------------------------------


def test_who_it_is(bench: Bench) -> None:
    assert bench.board.receive(Request(1, Opcode.GET_VERSION, 0).encode()) == b"\x020012V310"
    assert bench.ask(Opcode.GET_VERSION, 1).value == 0x000C_030A
    assert bench.ask(Opcode.GET_VERSION, 6).value == 1, "motors"
    assert bench.ask(Opcode.GGP, 4).value == 0x0201_020B
    assert bench.ask(BoardOpcode.GET_INFO, 0).value == 12
    assert bench.ask(BoardOpcode.GET_INFO, 201).value == 11 << 16 | 1
    assert bench.ask(BoardOpcode.BOARD_ERROR, 0).value == 0


def test_what_it_refuses(bench: Bench) -> None:
    for opcode in (0, 7, 11, 134, 142, 160, 242):
        assert bench.status(opcode) == Status.INVALID_COMMAND, opcode
    for opcode, type_ in (
        (Opcode.GGP, 99), (Opcode.SGP, 5), (BoardOpcode.GET_INFO, 99), (BoardOpcode.GET_IDS, 6), (Opcode.GIO, 8),
        (BoardOpcode.BOARD_RESET, 3), (BoardOpcode.BOARD_ERROR, 2), (BoardOpcode.USER_FUNCTION_MC, 9), (Opcode.MVP, 3),
        (BoardOpcode.USER_FUNCTION_DRV, 3), (BoardOpcode.MEASURED_SPEED, 2),
    ):  # fmt: skip
        assert bench.status(opcode, type_) == Status.WRONG_TYPE, (opcode, type_)
    assert bench.status(Opcode.SGP, 9, 0, 4) == Status.INVALID_VALUE, "SPI modes are 0..3"
    assert bench.status(Opcode.ROR, 0, 1, 5) == Status.WRONG_TYPE, "one motor"


@pytest.mark.parametrize(("opcode", "type_"), [(BoardOpcode.BOARD_RESET, 0), (BoardOpcode.GET_IDS, 0)])
def test_a_reset_writes_zero_or_the_presets_and_leaves_what_comes_up_otherwise(
    bench: Bench, opcode: int, type_: int
) -> None:
    written = {address: data for address, write, data in bench.datagrams(lambda: bench.ask(opcode, type_)) if write}
    assert (written[0x10], written[RAMP_MODE], written[0x28], written[0x2D], written[0x54]) == (
        0x0004_0001, 1, 320_000, 1000, 40_000,
    )  # fmt: skip
    assert (written[X_ACTUAL], written[V_MAX], written[POS_COMP]) == (0, 0, 0)
    assert (written[0x00], written[0x04], written[0x05]) == (0x6000, 0x4440_004B, 3)
    assert not {0x0A, 0x0B, 0x12, 0x31, 0x53, 0x70, 0x78, 0x7E} & written.keys(), "they come up as something"


def test_asking_who_is_in_the_slots_resets_nothing(bench: Bench) -> None:
    assert bench.datagrams(lambda: (bench.ask(Opcode.GGP, 4), bench.ask(BoardOpcode.GET_IDS, 4))) == []


def test_the_restart_wants_its_magic(bench: Bench) -> None:
    bench.ask(BoardOpcode.WRITE_MC, POS_COMP, 0, 5)
    bench.ask(Opcode.RESET_MODULE, 0, 0, 1)
    assert bench.read(POS_COMP) == 5
    bench.ask(Opcode.RESET_MODULE, 0, 0, 1234)
    assert bench.read(POS_COMP) == 0


def test_only_chips_that_have_boards() -> None:
    with pytest.raises(UnknownThing, match="tmc4361"):
        build_board("tmc428", VirtualClock(), {})


# --- motion by TMCL -------------------------------------------------------------------------------


def test_commands_become_writes_of_registers(bench: Bench) -> None:
    def writes(act: Callable[[], object]) -> list[tuple[int, int]]:
        return [(address, data) for address, write, data in bench.datagrams(act) if write]

    assert writes(lambda: bench.ask(Opcode.ROR, 0, 0, 1000)) == [(RAMP_MODE, 1), (V_MAX, 1000 << 8)]
    assert writes(lambda: bench.ask(Opcode.ROL, 0, 0, 1000)) == [(RAMP_MODE, 1), (V_MAX, -1000 << 8 & 0xFFFF_FFFF)]
    assert writes(lambda: bench.ask(Opcode.MST)) == [(RAMP_MODE, 1), (V_MAX, 0)]
    assert writes(lambda: bench.ask(Opcode.MVP, 0, 0, -5)) == [
        (RAMP_MODE, 5), (V_MAX, 51_200 << 8), (0x37, 0xFFFF_FFFB),
    ]  # fmt: skip
    assert writes(lambda: bench.ask(Opcode.ROR, 0, 0, 9_000_000))[-1] == (V_MAX, 8_000_000 << 8), "its limit"


def test_a_relative_move_answers_with_its_target(bench: Bench) -> None:
    bench.ask(Opcode.SAP, 1, 0, 100)
    assert bench.ask(Opcode.MVP, 1, 0, 50).value == 150
    assert bench.read(0x37) == 150


def test_it_gets_there(bench: Bench) -> None:
    bench.ask(Opcode.MVP, 0, 0, 2000)
    assert bench.ask(Opcode.GAP, 8).value == 0
    bench.clock.set(2.0)
    assert (bench.ask(Opcode.GAP, 8).value, bench.ask(Opcode.GAP, 1).value) == (1, 2000)


@pytest.mark.parametrize(
    ("number", "value", "address", "word"),
    [
        (0, -7, 0x37, 0xFFFF_FFF9),
        (1, 7, X_ACTUAL, 7),
        (2, -100, V_MAX, -100 << 8 & 0xFFFF_FFFF),
        (5, 1000, 0x28, 4000),
        (17, 1000, 0x29, 4000),
        (16, 3, 0x2A, 12),
        (19, 3, 0x2B, 12),
        (22, 9, 0x2D, 9),
        (25, 9, 0x30, 9),
        (26, -1, 0x33, 0xFFFF_FFFF),
        (27, 1, 0x34, 1),
        (15, 512, 0x25, 2),
        (21, 8, 0x2C, 2),
    ],
)
def test_axis_parameters_are_registers(bench: Bench, number: int, value: int, address: int, word: int) -> None:
    assert bench.status(Opcode.SAP, number, 0, value) == Status.OK
    assert bench.read(address) & 0xFFFF_FFFF == word
    assert bench.ask(Opcode.GAP, number).value == value


def test_the_ramp_type_and_the_velocity_of_positioning(bench: Bench) -> None:
    bench.ask(Opcode.SAP, 14, 0, 1)
    assert (bench.read(RAMP_MODE), bench.ask(Opcode.GAP, 14).value) == (2, 1)
    bench.ask(Opcode.SAP, 4, 0, 700)
    assert bench.read(V_MAX) == 0, "counts from the next positioning on"
    bench.ask(Opcode.MVP, 0, 0, 10**6)
    assert bench.read(V_MAX) == 700 << 8
    bench.ask(Opcode.SAP, 4, 0, 900)
    assert bench.read(V_MAX) == 900 << 8, "and at once while it positions"


def test_parameters_that_there_are_not_and_values_that_cannot_be(bench: Bench) -> None:
    assert bench.status(Opcode.GAP, 200) == Status.WRONG_TYPE
    assert bench.status(Opcode.SAP, 3, 0, 1) == Status.WRONG_TYPE
    assert bench.status(Opcode.SAP, 5, 0, 1 << 22) == Status.INVALID_VALUE
    assert bench.status(Opcode.SAP, 21, 0, -1) == Status.INVALID_VALUE


# --- identity -------------------------------------------------------------------------------------


def bytes_of(bench: Bench, slot: int, length: int = 24) -> bytes:
    words = [bench.ask(Opcode.UF1, slot, 0, address).value for address in range(0, length, 4)]
    return b"".join(word.to_bytes(4, "little", signed=True) for word in words)


def test_both_boards_say_what_they_are(bench: Bench) -> None:
    """Name, number, hardware version, magic number, as the firmware lays them out."""
    assert bytes_of(bench, 1, 22)[:22] == b"TMC4361A".ljust(16, b"\0") + b"\x0b\0" + b"\x01\0" + b"\x12\x34"
    assert bytes_of(bench, 2, 22)[:22] == b"TMC2660".ljust(16, b"\0") + b"\x01\0" + b"\x01\0" + b"\x12\x34"
    assert bench.ask(BoardOpcode.GET_INFO, 202).value == 0x0100_0100
    assert bench.ask(Opcode.UF1, 1, 0, 1).value == int.from_bytes(b"MC43", "little"), "any address"
    for slot in (0, 3):
        assert bench.status(Opcode.UF1, slot) == bench.status(Opcode.UF2, slot) == Status.WRONG_TYPE


def test_what_is_written_there_stays(bench: Bench) -> None:
    for at, byte in enumerate(b"mine"):
        assert bench.status(Opcode.UF2, 1, byte, 0x3FFE + at) == Status.OK
    bench.board.patch(BoardPatch(power_cycle=True))
    assert bytes_of(bench, 1, 4) == b"neC4"
    assert bench.ask(Opcode.UF1, 1, 0, 0x3FFE).value == int.from_bytes(b"mine", "little"), "reading goes on at 0"
    assert bytes_of(bench, 2, 4) == b"TMC2"


def test_an_empty_slot_reads_ones_and_cannot_be_written() -> None:
    board = build_board("tmc5130", VirtualClock(), {})
    answer = board.receive(Request(1, Opcode.UF1, 2, 0, 20).encode())
    assert answer is not None
    assert Reply.decode(answer).value == -1
    answer = board.receive(Request(1, Opcode.UF2, 2, 0x55, 20).encode())
    assert answer is not None
    assert Reply.decode(answer).status == Status.EEPROM_LOCKED


def _empty(opcode: int, type_: int = 0, motor: int = 0, value: int = 0) -> tuple[int, int]:
    """Status and value of an answer of a board with nothing in its second slot."""
    answer = build_board("tmc5130", VirtualClock(), {}).receive(Request(1, opcode, type_, motor, value).encode())
    assert answer is not None
    reply = Reply.decode(answer)
    return reply.status, reply.value


# --- the driver's board ---------------------------------------------------------------------------


def test_velocities_are_measured_by_the_board_that_does() -> None:
    """The TMC4361's board does not, the driver's does, of its own step generator, which rests. Command 150 answers
    with the error code of the firmware as status: 0 for none, 2 for a board that measures nothing, 8 for the motor."""
    bench = Bench()
    bench.ask(Opcode.ROR, 0, 0, 1000)
    answers = [bench.ask(BoardOpcode.MEASURED_SPEED, slot, motor, 7) for slot, motor in ((0, 0), (1, 0), (1, 1))]
    assert [(answer.status, answer.value) for answer in answers] == [(2, 7), (0, 0), (8, 7)]
    assert (bench.ask(Opcode.UF4, 0, 0, 7).value, bench.status(Opcode.UF4)) == (0, Status.OK)
    assert bench.status(Opcode.UF4, 0, 1) == Status.WRONG_TYPE
    assert [_empty(BoardOpcode.MEASURED_SPEED, *place, 7) for place in ((0, 0), (0, 1), (1, 0))] == [
        (0, 0), (8, 7), (2, 7),
    ]  # fmt: skip


def test_an_empty_slot_takes_every_register_and_has_no_function() -> None:
    assert _empty(BoardOpcode.WRITE_DRV, 8, 0, 77) == _empty(BoardOpcode.READ_DRV, 8, 0, 77) == (Status.OK, 77)
    assert _empty(BoardOpcode.USER_FUNCTION_DRV) == (Status.INVALID_COMMAND, 0)


@pytest.mark.parametrize("by", [(BoardOpcode.BOARD_RESET, 0), (BoardOpcode.BOARD_RESET, 1), (BoardOpcode.GET_IDS, 0)])
def test_a_reset_sets_up_the_driver_by_cover_datagrams(bench: Bench, by: tuple[int, int]) -> None:
    bench.ask(BoardOpcode.WRITE_DRV, 0xE, 0, 0x1F)
    assert bench.ask(BoardOpcode.READ_DRV, 0xE).value == 0xC_001F
    covers = [data for address, write, data in bench.datagrams(lambda: bench.ask(*by)) if write and address == 0x6C]
    assert covers[-5:] == [0xE_F040, 0, 0x9_1935, 0xA_0000, 0xD_0505]
    assert [bench.ask(BoardOpcode.READ_DRV, address).value for address in (0xF, 8, 0xC, 0xD, 0xE)] == covers[-5:]


def test_registers_of_the_driver_are_cover_datagrams(bench: Bench) -> None:
    assert bench.datagrams(lambda: bench.ask(BoardOpcode.WRITE_DRV, 0xC, 0, 0x1234))[0] == (
        0x6C,
        True,
        4 << 17 | 0x1234,
    )
    assert bench.ask(BoardOpcode.READ_DRV, 0xC).value == 4 << 17 | 0x1234
    assert bench.datagrams(lambda: bench.ask(BoardOpcode.WRITE_DRV, 4, 0, 5)) == [], "an answer cannot be written"
    asked = bench.datagrams(lambda: bench.ask(BoardOpcode.READ_DRV, 1))
    assert [data for address, write, data in asked if write] == [0xE_F050] * 2, "RDSEL says what is shown"
    assert bench.ask(BoardOpcode.READ_DRV, 1).value == bench.ask(BoardOpcode.READ_DRV, 3).value


@pytest.mark.parametrize(
    ("number", "value", "address", "shift", "bits"),
    [
        (160, 1, 8, 9, 1), (161, 1, 8, 8, 1), (162, 3, 12, 15, 3), (163, 1, 12, 14, 1), (164, 2, 12, 11, 3),
        (165, 9, 12, 7, 15), (166, 6, 12, 4, 7), (167, 4, 12, 0, 15), (168, 1, 13, 15, 1), (169, 2, 13, 13, 3),
        (170, 7, 13, 8, 15), (171, 3, 13, 5, 3), (172, 5, 13, 0, 15), (173, 1, 14, 16, 1), (174, -5, 14, 8, 127),
        (175, 1, 15, 14, 3), (176, 2, 15, 12, 3), (177, 1, 15, 10, 1), (178, 3, 15, 8, 3), (179, 0, 15, 6, 1),
        (183, 1, 15, 7, 1), (184, 1, 12, 13, 1), (185, 1, 15, 16, 1),
    ],
)  # fmt: skip
def test_parameters_that_the_first_board_has_not_are_the_drivers(
    bench: Bench, number: int, value: int, address: int, shift: int, bits: int
) -> None:
    before = bench.ask(BoardOpcode.READ_DRV, address).value
    assert bench.status(Opcode.SAP, number, 0, value) == Status.OK
    assert bench.ask(Opcode.GAP, number).value == value
    after = bench.ask(BoardOpcode.READ_DRV, address).value
    assert after == before & ~(bits << shift) | (value & bits) << shift
    assert bench.status(Opcode.GAP, number, 1) == Status.WRONG_TYPE


def test_parameters_of_the_driver_of_their_own_kind(bench: Bench) -> None:
    assert [bench.ask(Opcode.GAP, number).value for number in (6, 7, 29, 50, 51, 181, 182)] == [
        5,
        5,
        0,
        0,
        131_072,
        0,
        0,
    ]
    bench.ask(Opcode.SAP, 6, 0, 20)
    assert bench.ask(BoardOpcode.READ_DRV, 0xE).value & 0x1F == bench.ask(Opcode.GAP, 7).value == 20
    bench.ask(Opcode.SAP, 7, 0, 3)
    assert bench.ask(BoardOpcode.READ_DRV, 0xE).value & 0x1F == 20, "known, and not sent"
    assert bench.ask(Opcode.GAP, 6).value == 3
    for microsteps, power in ((1, 0), (16, 4), (256, 8)):
        assert bench.status(Opcode.SAP, 140, 0, microsteps) == Status.OK
        assert bench.ask(Opcode.GAP, 140).value == power, "written as a number, read as its power of two"
    assert bench.status(Opcode.SAP, 140, 0, 3) == Status.INVALID_VALUE
    for number in (29, 180, 206, 208):
        assert bench.status(Opcode.GAP, number) == Status.OK
        assert bench.status(Opcode.SAP, number, 0, 1) == Status.WRONG_TYPE


def test_the_driver_answers_with_what_rdsel_chooses(bench: Bench) -> None:
    bench.ask(Opcode.SAP, 4, 0, 500)
    bench.ask(Opcode.MVP, 0, 0, 300)
    bench.clock.set(2.0)
    assert bench.ask(BoardOpcode.READ_DRV, 0).value >> 10 == 300, "the microstep"
    assert bench.ask(Opcode.GAP, 208).value == bench.ask(BoardOpcode.READ_DRV, 3).value & 0xFF

    def chosen() -> set[int]:
        """RDSEL of the datagrams with which the load is asked."""
        asked = bench.datagrams(lambda: bench.ask(Opcode.GAP, 206))
        return {data >> 4 & 3 for address, write, data in asked if write and address == 0x6C}

    assert chosen() == {2}, "by its upper bits"
    assert bench.status(BoardOpcode.USER_FUNCTION_DRV, 1, 0, 1) == Status.OK
    assert chosen() == {1}, "whole"
    assert bench.ask(BoardOpcode.USER_FUNCTION_DRV, 2).value == 0x10, "its step generator is where it shall be"
