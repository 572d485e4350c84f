"""Programs stored over a line on which a frame in a hundred arrives broken, in either direction.

After each the module holds the program, or whoever stored it was told that it does not.
"""

from __future__ import annotations

import asyncio
import random
from collections.abc import Sequence

from app.calc.tmcl.binary import command_bytes
from app.calc.tmcl.instructions import Command
from app.devices.core.capabilities import ProgramMemory
from app.errors import BenchError
from tests.bench.table import Row
from tests.devices.tmcl.lossy import broken_line

DOWNLOADS = 200
COMMANDS = 60
BROKEN = 0.01


async def downloads(count: int, commands: int = COMMANDS) -> tuple[int, int, int]:
    """How many were stored intact, how many failed and were told of, and how many ended otherwise."""
    intact = told = wrong = 0
    for seed in range(count):
        rng = random.Random(seed)
        program = [Command(19, rng.randrange(10), 0, rng.randint(-(2**31), 2**31 - 1)) for _ in range(commands)]
        async with broken_line(seed, BROKEN) as b:
            running = asyncio.ensure_future(b.device.need(ProgramMemory).download(program))
            while not running.done():
                await b.clock.advance(0.01)
            held = b.module._firmware.eeprom.program
            same = [held.get(at) for at in range(commands)] == [command_bytes(each) for each in program]
            if isinstance(running.exception(), BenchError):
                told += 1
            elif running.exception() is None and same:
                intact += 1
            else:
                wrong += 1
    return intact, told, wrong


def measure(quick: bool) -> Sequence[Row]:
    """One row; quick: twenty downloads."""
    count = DOWNLOADS // 10 if quick else DOWNLOADS
    intact, told, wrong = asyncio.run(downloads(count))
    return [
        Row(
            what=f"{count} downloads of {COMMANDS} commands, 1 frame in 100 broken",
            measured=f"{intact} intact, {told} told",
            peer=f"{count}",
            ratio=(intact + told) / count,
            required="all",
            ok=not wrong,
        )
    ]
