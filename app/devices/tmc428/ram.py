"""The RAM of a TMC428: its driver chain and its microstep table."""

from __future__ import annotations

from collections.abc import Sequence

from ...calc.microsteps.datagrams import table_ram_words, values_from_ram_words
from ...errors import OutOfRange, UsageError, WriteRefused
from ...registers.tmc428.tmc428 import RAM_CHAIN, RAM_TABLE
from ..core.capabilities import DriverChainRam, MicrostepRam
from ..core.changes import register_changed
from ..core.register_file import RegisterFile
from ..core.register_io import read_once_more
from ..core.register_link import RegisterLink
from ..core.results import ChainContents
from .axis_roles import field_of

RAM_WORDS = 32
RAM_MASK = 0x3F3F
"""Two cells of six bits; the other bits of a RAM word mean nothing."""


class Ram(MicrostepRam, DriverChainRam):
    """Both halves of the RAM, written word by word and read back."""

    def __init__(self, link: RegisterLink, registers: RegisterFile) -> None:
        self._link = link
        self._session = link.session
        self._registers = registers
        self._global = link.table.get("stepper_motor_global_parameter_register")
        self._lsmd = field_of(self._global, "LSMD")

    async def read_microstep_table(self) -> list[int]:
        self._session.require_connected()
        return list(values_from_ram_words(await self._read_ram(RAM_TABLE)))

    async def write_microstep_table(self, values: Sequence[int]) -> list[int]:
        try:
            wanted = table_ram_words(values)
        except ValueError as error:
            raise UsageError(str(error)) from error
        self._session.require_connected()
        await self._write_ram(RAM_TABLE, wanted, "the microstep table")
        return await self.read_microstep_table()

    async def read_driver_chain(self) -> ChainContents:
        self._session.require_connected()
        ram_words = await self._read_ram(RAM_CHAIN)
        word = await self._link.read_once(self._global)
        return ChainContents(ram_words, self._lsmd.unpack(word))

    async def write_driver_chain(self, ram_words: Sequence[int], lsmd: int) -> ChainContents:
        if not 1 <= len(ram_words) <= RAM_WORDS:
            raise OutOfRange("number of RAM words", len(ram_words), 1, RAM_WORDS)
        for index, word in enumerate(ram_words):
            if word & ~RAM_MASK:
                raise OutOfRange(f"RAM word {index}", word, 0, RAM_MASK, "two cells of 6 bits")
        if not self._lsmd.minimum <= lsmd <= self._lsmd.maximum:
            raise OutOfRange("LSMD", lsmd, self._lsmd.minimum, self._lsmd.maximum)
        self._session.require_connected()
        await self._write_ram(RAM_CHAIN, ram_words, "the driver chain")
        await self._registers.write(self._global.name, fields={"LSMD": lsmd})
        return await self.read_driver_chain()

    async def _read_ram(self, first: int) -> list[int]:
        words = []
        for index in range(RAM_WORDS):
            words.append(await read_once_more(self._session.queue, first + index) & RAM_MASK)  # noqa: PERF401 (in turns)
        return words

    async def _write_ram(self, first: int, wanted: Sequence[int], table: str) -> None:
        """Write and read back each word. Other commands may come between two words, a second writer of RAM may not."""
        rows = [
            register for index in range(len(wanted)) if (register := self._link.table.at(first + index)) is not None
        ]
        async with self._link.turn() as turn:
            io = self._link.io(turn)
            before = [await io.read(register) & RAM_MASK for register in rows]
            for register, word in zip(rows, wanted, strict=True):
                await io.write(register, word)
            for register, word, old in zip(rows, wanted, before, strict=True):
                back = await io.read(register) & RAM_MASK
                if back != word:
                    raise WriteRefused(register.name, word, back, "write the table again")
                if word != old:
                    self._session.tell(register_changed(register, old, word, io.time_s, part_of=table))
