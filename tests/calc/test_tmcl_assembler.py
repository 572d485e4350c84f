"""TMCL programs: text to commands and back, binary files, and what is told of mistakes."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from app.calc.tmcl.assembler import INCLUDE_DEPTH, PROBLEMS_MAX, Assembly, Resolver, assemble
from app.calc.tmcl.binary import command_of, from_binary, to_binary
from app.calc.tmcl.disassembler import disassemble, listing
from app.calc.tmcl.instructions import Command
from app.errors import UsageError
from app.links.tmcl_language import INSTRUCTIONS, parameter_names, standard_include
from app.registers.tmcl.commands import PROGRAM_COMMANDS, Opcode
from app.registers.tmcl.modules import MODULES
from tests.calc.tmcl_programs import BYTES, FIRST, HELLO, HELLO_BINARY, PY_TEST, PY_TEST_BINARY

PD42 = MODULES["pd42-1241"]


def _nothing(_: str) -> str | None:
    return None


def _assemble(text: str, resolve: Resolver = lambda name: standard_include(PD42, name)) -> Assembly:
    return assemble(text, INSTRUCTIONS, resolve=resolve)


def _commands(text: str) -> list[Command]:
    made = _assemble(text)
    assert not made.problems, [str(problem) for problem in made.problems]
    return made.commands


def _problems(text: str, resolve: Resolver = _nothing) -> list[str]:
    return [str(problem) for problem in _assemble(text, resolve).problems]


# --- what is right --------------------------------------------------------------------------------


@pytest.mark.sheet("FM-PD42-1241", "8.3")
@pytest.mark.parametrize("section", BYTES)
def test_examples_of_the_manual(section: str) -> None:
    text, binary = BYTES[section]
    assert to_binary(_commands(text)) == bytes.fromhex(binary)


@pytest.mark.parametrize(("text", "binary"), [(PY_TEST, PY_TEST_BINARY), (HELLO, HELLO_BINARY)])
def test_programs_that_others_published(text: str, binary: bytes) -> None:
    assert to_binary(_commands(text)) == binary
    assert to_binary(_commands(disassemble(from_binary(binary), INSTRUCTIONS))) == binary


@pytest.mark.parametrize(
    ("line", "command"),
    [
        ("MVP REL, 0, -10000", (4, 1, 0, -10000)), ("mvp coord,0,8", (4, 2, 0, 8)), ("SGP 66, 0, 3", (9, 66, 0, 3)),
        ("GGP 66, 0", (10, 66, 0, 0)), ("STGP 42, 2", (11, 42, 2, 0)), ("RSGP 42, 2", (12, 42, 2, 0)),
        ("RFS START, 0", (13, 0, 0, 0)), ("CALC MUL, -5000", (19, 2, 0, -5000)), ("COMP 1000", (20, 0, 0, 1000)),
        ("SCO 1, 0, 1000", (30, 1, 0, 1000)), ("GCO 1, 0", (31, 1, 0, 0)), ("CCO 3, 0", (32, 3, 0, 0)),
        ("ACO 1, 0", (39, 1, 0, 0)), ("CALCX MUL", (33, 2, 0, 0)), ("AGP 42, 2", (35, 42, 2, 0)),
        ("CLE ETO", (36, 1, 0, 0)), ("EI 255", (25, 255, 0, 0)), ("DI 255", (26, 255, 0, 0)), ("RETI", (38, 0, 0, 0)),
        ("RSUB", (24, 0, 0, 0)), ("WAIT Ticks, 0, -1", (27, 0, 0, -1)), ("CALC LOAD, $ff", (19, 9, 0, 255)),
        ("CALC LOAD, 0xFFFFFFFF", (19, 9, 0, -1)), ("CALC LOAD, %101", (19, 9, 0, 5)), ("JC 3, 7", (21, 3, 0, 7)),
        ("CALC LOAD, 2147483648", (19, 9, 0, -(2**31))), (".command 99, 1, 2, -3", (99, 1, 2, -3)),
        ("GIO 0,1;a remark", (15, 0, 1, 0)), ("UF3 1, 2, 3", (67, 1, 2, 3)),
    ],
)  # fmt: skip
def test_single_commands(line: str, command: tuple[int, int, int, int]) -> None:
    assert _commands(line) == [command]


def test_labels_and_constants() -> None:
    text = "A: B:\n  GoOn: SAP limit, 0, -Size\nLimit = 4\nSIZE = 50\nSize = $32\nJA b\nVECT 3, End\nEnd:"
    made = _assemble(text)
    assert not made.problems
    assert made.commands == [(5, 4, 0, -50), (22, 0, 0, 0), (37, 3, 0, 3)]
    assert made.labels == {"A": 0, "B": 0, "GoOn": 0, "End": 3}
    assert made.constants == {"Limit": 4, "SIZE": 50}
    assert [place.line for place in made.places] == [2, 6, 7]


def test_names_of_interrupts_and_parameters() -> None:
    text = "#include Interrupts.inc\n#include <TMCLParam.tmc>\nEI TI_TIMER0\nEI TI_GLOBAL\nGAP APActualPosition, Motor0"
    assert _commands(text) == [(25, 0, 0, 0), (25, 255, 0, 0), (6, 1, 0, 0)]
    for module in MODULES.values():
        names = parameter_names(module)
        assert len({name.upper() for name in names}) == len(names)


def test_includes_take_each_file_once() -> None:
    files = {"a.tmc": '#include "b.tmc"\nX = 1', "b.tmc": "Y = 2\nSub: RSUB"}
    made = _assemble("#include b.tmc\n#include a.tmc\nCALC X, Y\nCSUB Sub", files.get)
    assert not made.problems
    assert made.commands == [(24, 0, 0, 0), (19, 1, 0, 2), (23, 0, 0, 0)]
    assert [tuple(place) for place in made.places] == [("b.tmc", 2), ("program", 3), ("program", 4)]


def test_listing() -> None:
    text = listing(_assemble("Start: ROR 0, 500\nJA Start"), INSTRUCTIONS)
    assert text.splitlines() == [
        "    0  01 00 00 00 00 01 F4  program:1  Start: ROR 0, 500",
        "    1  16 00 00 00 00 00 00  program:2  JA Start",
        "",
        "labels",
        "    0  Start",
    ]


# --- what is wrong --------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "column", "expected"),
    [
        ("ROR 0", 1, "ROR has 2 operands, not 1: expected ROR motor, value"),
        ("  RSUB 1", 3, "RSUB has no operands, not 1: expected RSUB"),
        ("ROX 0, 1", 1, "no command is called ROX: expected ROR, or another mnemonic"),
        ("MVP ABC, 0, 1", 5, "nothing is called ABC: expected ABS or REL or COORD"),
        ("X: A: MVP ABS,  256, 1", 17, "256 is out of range, allowed is 0..255"),
        ("MVP ABS, 0, 4294967296", 13, "allowed is -2147483648..4294967295"),
        ("COMP -2147483649", 6, "allowed is -2147483648..4294967295"),
        ("JA Nowhere", 4, "nothing is called Nowhere: expected a label or an address"),
        ("JA 2048", 4, "2048 is out of range, allowed is 0..2047"),
        ("JC GE, -1", 8, "-1 is out of range"),
        ("SAP 4, 0, 12x", 11, "expected a number, found '12x': decimal, hexadecimal behind 0x or $, binary behind %"),
        ("SAP 4,, 12", 7, "expected a number, found nothing"),
        ("Loop : STOP", 1, "a label has its colon right behind its name: write Loop:"),
        ("Loop: STOP\nLoop: STOP", 1, "Loop is defined already, in program:1: expected another name"),
        ("x = 1\nX = 2", 1, "X is defined already"),
        ("Speed = fast", 9, "nothing is called fast: expected a number"),
        ("Speed =", 8, "expected a number, found nothing"),
        ("Größe: STOP", 3, "'ö' means nothing in TMCL"),
        ("!!", 1, "expected a label (Name:), a command, Name = number or #include File"),
        ("#include Nowhere.tmc", 1, "there is no file Nowhere.tmc to include"),
        (".command 1, 2, 3", 1, "expected .command opcode, type, motor, value"),
        (".command 256, 0, 0, 0", 10, "256 is out of range"),
        ("COMP " + "9" * 30, 6, "is out of range, allowed is"),
    ],
)
def test_mistakes(text: str, column: int, expected: str) -> None:
    problems = _assemble(text, _nothing).problems
    assert len(problems) == 1, problems
    assert (problems[0].line, problems[0].column) == (len(text.splitlines()), column)
    assert expected in problems[0].message


def test_everything_wrong_is_told_at_once_and_addresses_stay_right() -> None:
    made = _assemble("JA Here\nFOO 1\nMVP ABS\nHere: JA There\nWAIT X, Y, Z", _nothing)
    assert [(problem.line, problem.column) for problem in made.problems] == [
        (2, 1),
        (3, 1),
        (4, 10),
        (5, 6),
        (5, 9),
        (5, 12),
    ]
    assert made.labels == {"Here": 3}
    assert made.commands[0] == (Opcode.JA, 0, 0, 3)


def test_problems_in_included_files_come_after_those_of_the_program() -> None:
    assert _problems("#include a\nFOO", {"a": "BAR\nRSUB 1"}.get) == [
        "program:2:1: no command is called FOO: expected a mnemonic",
        "a:1:1: no command is called BAR: expected a mnemonic",
        "a:2:1: RSUB has no operands, not 1: expected RSUB",
    ]


def test_includes_that_never_end() -> None:
    assert _problems("#include a", {"a": "#include b", "b": "#include a"}.get) == [
        "b:1:1: a includes itself: program > a > b > a"
    ]
    assert "nested more than" in _problems("#include f0", lambda name: f"#include f{int(name[1:]) + 1}")[0]
    assert (
        _problems("#include f1", lambda name: f"#include f{int(name[1:]) + 1}" if name != f"f{INCLUDE_DEPTH}" else "")
        == []
    )


def test_what_is_too_long_is_refused_and_told_in_few_words() -> None:
    assert not _assemble("STOP\n" * PROGRAM_COMMANDS).problems
    problems = _assemble("STOP\n" * (PROGRAM_COMMANDS + 7)).problems
    assert [problem.line for problem in problems] == [PROGRAM_COMMANDS + 1]
    assert "has 2055 commands, the module holds 2048" in problems[0].message
    assert len(_assemble("FOO\n" * 60_000).problems) == PROBLEMS_MAX


# --- properties -----------------------------------------------------------------------------------

COMMANDS = st.builds(
    Command, st.integers(0, 255), st.integers(0, 255), st.integers(0, 3), st.integers(-(2**31), 2**31 - 1)
)
WRITTEN = st.sampled_from(list(INSTRUCTIONS.by_mnemonic.values())).flatmap(
    lambda one: st.builds(
        Command,
        st.just(one.opcode),
        st.integers(0, 255) if "type" in one.operands else st.just(0),
        st.integers(0, 255) if "motor" in one.operands else st.just(0),
        st.integers(0, 20)
        if one.jumps
        else st.integers(-(2**31), 2**31 - 1)
        if "value" in one.operands
        else st.just(0),
    )
)


@given(st.lists(st.one_of(COMMANDS, WRITTEN), max_size=30), st.integers(0, 2000))
def test_any_commands_survive_being_written_out_and_assembled(commands: list[Command], first: int) -> None:
    text = disassemble(commands, INSTRUCTIONS)
    assert _commands(text) == commands
    assert _commands(disassemble(commands, INSTRUCTIONS, first=first)) == commands, "wherever they are in the memory"
    assert from_binary(to_binary(commands)) == commands


@given(st.lists(WRITTEN, min_size=1, max_size=30))
def test_what_programs_may_say_is_written_with_mnemonics(commands: list[Command]) -> None:
    assert ".command" not in disassemble(commands, INSTRUCTIONS)


@given(st.text(alphabet=st.sampled_from("ABLO01 ,:;=#$%-./_\n\tähMVPJ\x00"), max_size=200))
def test_no_text_breaks_the_assembler(text: str) -> None:
    made = _assemble(text, _nothing)
    assert len(made.commands) == len(made.places)
    for problem in made.problems:
        assert 1 <= problem.line <= len(text.splitlines())
        assert 1 <= problem.column <= len(text.splitlines()[problem.line - 1]) + 1
    if not made.problems:
        assert _commands(disassemble(made.commands, INSTRUCTIONS, made.labels)) == made.commands


@given(st.binary(max_size=80))
def test_bytes_that_are_no_program_are_refused(content: bytes) -> None:
    whole = len(content) % 8 == 0
    if whole and all(sum(content[at : at + 7]) & 0xFF == content[at + 7] for at in range(0, len(content), 8)):
        assert to_binary(from_binary(content)) == content
    else:
        with pytest.raises(UsageError, match="TMCL binary"):
            from_binary(content)


@pytest.mark.parametrize(
    ("spoil", "told"),
    [(lambda whole: whole[:-1], "no multiple"), (lambda whole: whole[:8] + b"\x01" + whole[9:], "command 1 of")],
)
def test_a_damaged_file_is_told(spoil: Callable[[bytes], bytes], told: str) -> None:
    with pytest.raises(UsageError, match=told):
        from_binary(spoil(to_binary(_commands(FIRST))))
    with pytest.raises(UsageError, match="7 bytes"):
        command_of(b"123")
