"""The program side: memory, run state, accumulator and flags. What programs do: `test_programs`."""

from __future__ import annotations

import pytest

from app.links.tmcl import Request
from app.registers.tmcl.commands import PROGRAM_COMMANDS, Opcode, Status
from tests.emulators.tmcl.harness import Bench

ADD, SUB, MUL, DIV, MOD, AND, OR, XOR, NOT, LOAD, SWAP = range(11)
ACCUMULATOR, X = 2, 3


def _load(bench: Bench, value: int) -> None:
    bench.do(Opcode.CALC, LOAD, 0, value)


@pytest.mark.sheet("FM-PD42-1241", "3.6.14")
@pytest.mark.sheet("FM-PD42-1241", "3.5.5")
@pytest.mark.parametrize(
    ("operation", "operand", "result"),
    [(ADD, 5, 12), (SUB, 9, -2), (MUL, -5000, -35_000), (DIV, 2, 3), (MOD, 4, 3), (AND, 3, 3), (OR, 8, 15),
     (XOR, 2, 5), (NOT, 0, -8), (LOAD, 123, 123)],
)  # fmt: skip
def test_calculating_with_the_accumulator(operation: int, operand: int, result: int) -> None:
    bench = Bench()
    _load(bench, 7)
    assert bench.do(Opcode.CALC, operation, 0, operand) == operand
    assert bench.do(Opcode.GET_STATUS, ACCUMULATOR) == result


@pytest.mark.sheet("FM-PD42-1241", "3.6.26")
@pytest.mark.parametrize(
    ("operation", "accumulator", "x"),
    [(ADD, 10, 3), (SUB, 4, 3), (MUL, 21, 3), (DIV, 2, 3), (MOD, 1, 3), (AND, 3, 3), (OR, 7, 3), (XOR, 4, 3),
     (NOT, -4, 3), (LOAD, 7, 7), (SWAP, 3, 7)],
)  # fmt: skip
def test_calculating_with_x(operation: int, accumulator: int, x: int) -> None:
    # Open: where NOT puts its result. Results go to the accumulator, so it does there.
    bench = Bench()
    _load(bench, 3)
    bench.do(Opcode.CALCX, LOAD)
    _load(bench, 7)
    bench.do(Opcode.CALCX, operation)
    assert bench.do(Opcode.GET_STATUS, ACCUMULATOR) == accumulator
    assert bench.do(Opcode.GET_STATUS, X) == x


@pytest.mark.sheet("FM-PD42-1241", "3.6.14")
@pytest.mark.parametrize(
    ("start", "operation", "operand", "result"),
    [(2**31 - 1, ADD, 1, -(2**31)), (2**30, MUL, 4, 0), (-7, DIV, 2, -3), (-7, MOD, 2, -1), (7, MOD, -2, 1),
     (-(2**31), DIV, -1, -(2**31)), (-(2**31), NOT, 0, 2**31 - 1)],
)  # fmt: skip
def test_corners_of_32_bits(start: int, operation: int, operand: int, result: int) -> None:
    # Open: overflow and the sign of a remainder. Here both are as in most processors.
    bench = Bench()
    _load(bench, start)
    bench.do(Opcode.CALC, operation, 0, operand)
    assert bench.do(Opcode.GET_STATUS, ACCUMULATOR) == result


@pytest.mark.parametrize("operation", [DIV, MOD])
def test_division_by_zero_is_refused(operation: int) -> None:
    # Open in all sources; here status 4, and the accumulator stays.
    bench = Bench()
    _load(bench, 7)
    assert bench.ask(Opcode.CALC, operation).status == Status.INVALID_VALUE
    assert bench.ask(Opcode.CALCX, operation).status == Status.INVALID_VALUE
    assert bench.do(Opcode.GET_STATUS, ACCUMULATOR) == 7


def test_operations_that_there_are_not() -> None:
    bench = Bench()
    assert bench.ask(Opcode.CALC, 10).status == Status.WRONG_TYPE  # SWAP is CALCX's
    assert bench.ask(Opcode.CALCX, 11).status == Status.WRONG_TYPE


@pytest.mark.sheet("FM-PD42-1241", "3.5.5")
@pytest.mark.sheet("FM-PD42-1241", "3.6.6")
@pytest.mark.sheet("FM-PD42-1241", "3.6.13")
@pytest.mark.sheet("FM-PD42-1241", "3.6.23")
def test_reading_in_direct_mode_leaves_the_accumulator_alone() -> None:
    bench = Bench()
    _load(bench, 7)
    bench.gap(4)
    bench.ggp(66)
    bench.do(Opcode.GIO, 0, 0)
    bench.do(Opcode.GCO, 0)
    assert bench.do(Opcode.GET_STATUS, ACCUMULATOR) == 7


@pytest.mark.sheet("FM-PD42-1241", "3.6.27")
def test_the_accumulator_to_an_axis_parameter() -> None:
    bench = Bench()
    _load(bench, 4000)
    bench.do(Opcode.AAP, 4)
    assert bench.gap(4) == 4000
    bench.do(Opcode.AAP, 0)
    bench.arrive()
    assert bench.gap(1) == 4000
    _load(bench, -1)
    assert bench.ask(Opcode.AAP, 4).status == Status.INVALID_VALUE


@pytest.mark.sheet("FM-PD42-1241", "3.6.28")
def test_the_accumulator_to_a_global_parameter() -> None:
    bench = Bench()
    _load(bench, 4000)
    bench.do(Opcode.AGP, 42, 2)
    assert bench.ggp(42, 2) == 4000
    assert bench.ask(Opcode.AGP, 77, 0).status == Status.INVALID_VALUE


def test_clearing_flags() -> None:
    bench = Bench()
    for flag in range(5):
        bench.do(Opcode.CLE, flag)
    assert bench.ask(Opcode.CLE, 5).status == Status.WRONG_TYPE


def test_switching_interrupts() -> None:
    bench = Bench()
    for opcode in (Opcode.EI, Opcode.DI):
        for number in (0, 1, 2, 3, 15, 21, 27, 28, 39, 40, 41, 42, 255):
            bench.do(opcode, number)
        for number in (4, 9, 43, 254):
            assert bench.ask(opcode, number).status == Status.WRONG_TYPE


# --- memory ---------------------------------------------------------------------------------------


def _download(bench: Bench, at: int, commands: list[Request]) -> None:
    bench.do(Opcode.ENTER_DOWNLOAD, 0, 0, at)
    for command in commands:
        assert bench.ask(command.opcode, command.type, command.motor, command.value).status == Status.STORED
    bench.do(Opcode.EXIT_DOWNLOAD)


PROGRAM = [
    Request(1, Opcode.ROL, 0, 0, 51_200),
    Request(1, Opcode.WAIT, 0, 0, 500),
    Request(1, 99, 1, 2, -3),  # nobody looks at a command before it runs
    Request(1, Opcode.STOP),
]


def test_a_program_is_stored_and_not_run() -> None:
    bench = Bench()
    _download(bench, 0, PROGRAM)
    _download(bench, 100, PROGRAM[:1])
    for at, command in [*enumerate(PROGRAM), (100, PROGRAM[0])]:
        seven = command.encode()[1:8]
        reply = bench.module.exchange(Request(1, Opcode.READ_MEMORY, 0, 0, at).encode())
        # Open: what fills the answer besides the command. Here its sum, as in the assembler's files.
        assert reply == bytes((2,)) + seven + bytes((sum(seven) & 0xFF,))
    assert bench.module.exchange(Request(1, Opcode.READ_MEMORY, 0, 0, 50).encode()) == bytes((2,)) + bytes(8)
    bench.run(1.0)
    assert (bench.gap(1), bench.gap(2)) == (0, 0)
    assert bench.state.application.commands == 5


def test_download_mode_and_its_end() -> None:
    bench = Bench()
    bench.do(Opcode.ENTER_DOWNLOAD)
    assert bench.state.application.downloading
    assert bench.ask(Opcode.GAP, 1).status == Status.STORED
    assert bench.do(Opcode.GET_STATUS, 0) == 1  # control commands work on; the pointer has moved
    assert bench.do(Opcode.GET_VERSION, 1) == 0x04D9012C
    bench.do(Opcode.EXIT_DOWNLOAD)
    bench.do(Opcode.EXIT_DOWNLOAD)
    assert bench.ggp(129) == 0
    assert bench.gap(1) == 0


def test_memory_ends() -> None:
    # Open: length, and what is answered beyond. Here 2048 commands, and status 4.
    bench = Bench()
    for opcode in (Opcode.ENTER_DOWNLOAD, Opcode.READ_MEMORY):
        for at in (PROGRAM_COMMANDS, -1):
            assert bench.ask(opcode, 0, 0, at).status == Status.INVALID_VALUE
    assert bench.ask(Opcode.RUN_APPLICATION, 1, 0, PROGRAM_COMMANDS).status == Status.INVALID_VALUE
    bench.do(Opcode.ENTER_DOWNLOAD, 0, 0, PROGRAM_COMMANDS - 1)
    assert bench.ask(Opcode.STOP).status == Status.STORED
    assert bench.ask(Opcode.STOP).status == Status.INVALID_VALUE


@pytest.mark.sheet("FM-PD42-1241", "5.1")
def test_protected_memory() -> None:
    # Open: how the module says no. Here "configuration EEPROM locked", and an unlocked program is gone.
    bench = Bench()
    _download(bench, 0, PROGRAM)
    bench.sgp(81, 3)
    assert bench.ask(Opcode.READ_MEMORY).status == Status.EEPROM_LOCKED
    assert bench.ask(Opcode.ENTER_DOWNLOAD).status == Status.EEPROM_LOCKED
    bench.sgp(81, 1)
    assert bench.state.application.commands == 4
    bench.do(Opcode.ENTER_DOWNLOAD)
    bench.do(Opcode.EXIT_DOWNLOAD)
    bench.sgp(81, 0)
    assert bench.state.application.commands == 0


# --- run state ------------------------------------------------------------------------------------


def test_run_stop_and_reset_show_in_the_status() -> None:
    bench = Bench()
    _download(bench, 0, PROGRAM)
    bench.do(Opcode.RUN_APPLICATION, 1, 0, 1)
    assert (bench.ggp(128), bench.ggp(130), bench.state.application.status) == (1, 1, "runs")
    bench.run(1.0)
    assert bench.do(Opcode.GET_STATUS, 1) == 1 << 24 | 1 << 16 | 1  # it waits
    bench.do(Opcode.STOP_APPLICATION)
    assert (bench.ggp(128), bench.ggp(130)) == (0, 1)
    bench.do(Opcode.RUN_APPLICATION)
    assert (bench.ggp(128), bench.ggp(130)) == (1, 1)
    _load(bench, 5)
    bench.do(Opcode.CALCX, LOAD)
    bench.do(Opcode.RESET_APPLICATION)
    assert (bench.ggp(128), bench.ggp(130)) == (0, 0)
    assert [bench.do(Opcode.GET_STATUS, what) for what in range(4)] == [4, 0, 0, 0]
    assert bench.ask(Opcode.RUN_APPLICATION, 2).status == Status.WRONG_TYPE
    assert bench.ask(Opcode.GET_STATUS, 4).status == Status.WRONG_TYPE
    assert bench.ggp(131) == 0


def test_versions() -> None:
    bench = Bench()
    assert bench.module.exchange(Request(1, 136).encode())[1:] == b"1241V144"
    assert bench.do(Opcode.GET_VERSION, 1) == 1241 << 16 | 1 << 8 | 44
    assert bench.ask(Opcode.GET_VERSION, 2).status == Status.WRONG_TYPE
