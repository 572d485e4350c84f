"""Random programs on the emulated module: beside the oracle, and of random bytes."""

from __future__ import annotations

import random

from app.calc.tmcl.instructions import Command
from app.emulators.tmcl.eeprom import COMMAND_BYTES
from app.registers.tmcl.commands import PROGRAM_COMMANDS, Opcode
from tests.emulators.tmcl.harness import Bench
from tests.emulators.tmcl.interpreter_oracle import Oracle, Row
from tests.emulators.tmcl.programs import COMMAND_S, download

LATER: dict[str, object] = {"later_commands": True}
"""Options of a module whose firmware knows the commands of later ones."""
_WHERE = (0, 1, 2, 3, 5, 8, 12, 20, 39, 2047, 2048, -1)


def _random_program(rng: random.Random, later: bool) -> list[Row]:
    length = rng.randint(3, 40)

    def address() -> int:
        return rng.choice(_WHERE) if rng.random() < 0.1 else rng.randrange(length)

    def number() -> int:
        return rng.choice((0, 1, -1, 2, 7, -5000, 2**31 - 1, -(2**31), rng.randint(-(2**31), 2**31 - 1)))

    def variable() -> int:
        return rng.choice((0, 1, 2, 3, 7, 255))

    def later_command() -> Row:
        return rng.choice((
            (40, rng.randrange(13), variable(), rng.choice((0, 1, 2, 3, 255, 256, -1))),
            (rng.choice((41, 42, 43, 44)), rng.randrange(13), variable(), 0),
            (45, rng.randrange(13), variable(), number()), (48, 0, 0, address()), (49, variable(), 0, address()),
            (55, 0, 0, number()), (56, 0, 0, 0), (57, 0, 0, 0), (80, rng.randrange(13), 0, address()),
        ))  # fmt: skip

    def command() -> Row:
        if later and rng.random() < 0.3:
            return later_command()
        return rng.choice((
            (19, rng.randrange(11), 0, number()), (33, rng.randrange(12), 0, 0), (20, 0, 0, number()),
            (21, rng.randrange(13), 0, address()), (22, 0, 0, address()), (23, 0, 0, address()), (24, 0, 0, 0),
            (36, rng.randrange(6), 0, 0), (9, rng.randrange(4), 2, number()), (10, rng.randrange(4), 2, 0),
            (35, rng.randrange(4), 2, 0), (9, rng.randrange(3), 3, rng.randrange(6)),
            (14, rng.randrange(3), 2, rng.randrange(3)),
            (15, rng.randrange(3), 2, 0), (30, rng.randrange(23), 0, number()), (31, rng.randrange(23), 0, 0),
            (39, rng.randrange(4), 0, 0), (25, rng.choice((0, 1, 2, 9, 255)), 0, 0), (25, 255, 0, 0),
            (26, rng.choice((0, 1, 2, 255)), 0, 0), (37, rng.randrange(4), 0, address()), (38, 0, 0, 0),
            (27, 0, 0, rng.choice((0, 1, 2, -1))), (27, rng.choice((1, 4, 5)), rng.randrange(2), 1),
        ))  # fmt: skip

    rows = [command() for _ in range(length)]
    if rng.random() < 0.7:  # so that interrupts come often
        for at, row in enumerate([(37, 0, 0, length // 2), (37, 1, 0, address()), (9, 0, 3, 1), (9, 1, 3, 2),
                                  (25, 0, 0, 0), (25, 1, 0, 0), (25, 255, 0, 0)][:length]):  # fmt: skip
            rows[at] = row
    if rng.random() < 0.3:
        rows[-1] = (rng.choice((28, 99)), 0, 0, 0)
    return rows


def agree(seed: int, bench: Bench) -> None:
    """Run the random program number `seed` on the module of `bench` and on the oracle; both have to be the same."""
    rng = random.Random(seed)
    later = bench.module.options.later_commands
    rows = _random_program(rng, later)
    bench.power_cycle()
    application = bench.module._firmware.application
    application.erase()
    download(bench, [Command(*row) for row in rows])
    bench.do(Opcode.RUN_APPLICATION, 1, 0, 0)
    oracle = Oracle(rows, later)
    for slots in (rng.randint(1, 60), rng.randint(1, 300), rng.randint(1, 300)):
        oracle.run(slots)
        bench.run(slots * COMMAND_S)
        state = bench.state.application
        told = (
            state.counter, state.accumulator, state.x, set(state.flags), state.stack, state.status == "runs",
            state.error, state.interrupted, application.variables.tolist(), bench.state.inputs.outputs,
        )  # fmt: skip
        assert told == (
            oracle.pc, oracle.accumulator, oracle.x, oracle.flags, oracle.stack, oracle.running, oracle.error,
            oracle.saved is not None, [oracle.variables.get(number, 0) for number in range(256)], oracle.outputs,
        ), f"seed {seed}: {rows}"  # fmt: skip


def any_bytes(seed: int, bench: Bench) -> None:
    """Run a memory of random bytes: it runs on, or stops with a reason."""
    rng = random.Random(seed)
    memory = bench.module._firmware.eeprom
    bench.patch(factory_default=True)
    opcodes = bytes(rng.randrange(256) if rng.random() < 0.2 else rng.randrange(1, 58) for _ in range(64))
    for at, opcode in enumerate(opcodes):
        memory.program[at] = (
            bytes((opcode,)) + rng.randbytes(2) + rng.choice((rng.randbytes(4), bytes((0, 0, 0, rng.randrange(64)))))
        )
    assert all(len(command) == COMMAND_BYTES for command in memory.program.values())
    bench.patch(power_cycle=True)
    bench.do(Opcode.RUN_APPLICATION)
    for _ in range(3):
        bench.run(0.05)
        state = bench.state.application
        assert state.status in ("runs", "stopped")
        assert 0 <= state.counter <= PROGRAM_COMMANDS
        assert state.status == "runs" or state.error or opcodes[state.counter] == Opcode.STOP
