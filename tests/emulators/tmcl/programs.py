"""Programs on a bench: assembled, downloaded by frames, run."""

from __future__ import annotations

from app.calc.tmcl.assembler import assemble
from app.calc.tmcl.instructions import Command
from app.links.tmcl_language import INSTRUCTIONS, standard_include
from app.registers.tmcl.commands import Opcode, Status
from app.registers.tmcl.modules import MODULES
from tests.emulators.tmcl.harness import Bench

COMMAND_S = 1e-4
"""What a command takes by default [s]."""


def commands_of(text: str) -> list[Command]:
    made = assemble(text, INSTRUCTIONS, resolve=lambda name: standard_include(MODULES["pd42-1241"], name))
    assert not made.problems, [str(problem) for problem in made.problems]
    return made.commands


def download(bench: Bench, commands: list[Command], at: int = 0) -> None:
    bench.do(Opcode.ENTER_DOWNLOAD, 0, 0, at)
    for command in commands:
        assert bench.ask(*command).status == Status.STORED
    bench.do(Opcode.EXIT_DOWNLOAD)


def started(text: str, bench: Bench | None = None) -> Bench:
    """A bench whose module has just been told to run the program from its start."""
    bench = bench or Bench()
    download(bench, commands_of(text))
    bench.do(Opcode.RUN_APPLICATION, 1, 0, 0)
    return bench


def ended(text: str, limit_s: float = 60.0, bench: Bench | None = None) -> Bench:
    """The same, after the program has stopped."""
    bench = started(text, bench)
    bench.until(lambda: bench.ggp(128) == 0, limit_s)
    return bench


def accumulator(bench: Bench) -> int:
    return bench.do(Opcode.GET_STATUS, 2)
