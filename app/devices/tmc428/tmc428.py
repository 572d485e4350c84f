"""The TMC428: three ramp generators, a driver chain and a microstep table in RAM."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...calc.microsteps.datagrams import table_ram_words, values_from_ram_words
from ...clock import Clock
from ...errors import OtherModel, OutOfRange, UsageError, WriteRefused, WrongState
from ...links.datagram32 import STATUS_TMC428
from ...links.port import FramePort
from ...links.queue import Priority
from ...registers.model import Field, Register
from ...registers.tmc428.tmc428 import RAM_CHAIN, RAM_TABLE
from ...registers.tmc428.tmc4210 import TYPE_VERSION
from ..core.changes import register_changed
from ..core.config import DeviceConfig
from ..core.register_io import Words, read_once_more
from ..core.results import ChainContents
from ..core.sample_plan import Decoder, FloatArray
from .axis_rows import AxisRows
from .samples import Frames, IntArray, RampSamples

RAM_WORDS = 32
RAM_MASK = 0x3F3F
"""Two cells of six bits; the other bits of a RAM word mean nothing."""
TYPE_ADDRESS = 0x39
"""Unused here, so it reads 0; the TMC4210 and the TMC429 show their type there."""


class Tmc428(RampSamples):
    """Driver of one TMC428."""

    status_names = STATUS_TMC428

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> None:
        super().__init__(device_id, config, port, clock)
        self._global = self.table.get("stepper_motor_global_parameter_register")
        self._switch_row = self.table.get("l3_r3_l2_r2_l1_r1")
        self._cover = self.table.get("cover_pos_cover_len")
        self._cover_datagram = self.table.get("cover_datagram")
        self._lsmd = self._field(self._global, "LSMD")
        self._refmux = self._field(self._global, "refmux")
        self._mot1r = self._field(self._global, "mot1r")
        self._cover_pos = self._field(self._cover, "cover_pos")
        self._remembered |= {self._global.address}

    @staticmethod
    def _field(register: Register, name: str) -> Field:
        part = register.field_named(name)
        assert part is not None
        return part

    def _axis_rows(self, axis: int) -> AxisRows:
        return AxisRows.of(
            self.table,
            axis,
            reference="lp_ref_conf_rm",
            dividers="pulse_div_ramp_div_usrs",
            interrupts="interrupt_mask_interrupt_flags",
            mode="rm",
        )

    async def probe(self) -> str:
        kind = await read_once_more(self.queue, TYPE_ADDRESS)
        if kind == TYPE_VERSION:
            raise OtherModel("a TMC4210 or TMC429 answers here, not a TMC428", self.model, ("tmc4210",))
        async with self.queue.turn() as turn:
            words = self.words(turn)
            settings = await words.read(self._global)
        return f"a TMC428 answers; global parameters {settings:#08x}, status {words.status:#04x}"

    async def refresh(self) -> None:
        await super().refresh()
        self._saw_word(self._global, await read_once_more(self.queue, self._global.address))

    def _microsteps(self, axis: int) -> int | None:
        rows = self.rows[axis]
        word = self._known.get(rows.dividers.address)
        if word is None or rows.usrs is None:
            return None
        return int(1 << min(rows.usrs.unpack(word), 6))  # 7 has no meaning in Table 8-8

    # --- switches -------------------------------------------------------------------------------

    def _wired(self, axis: int) -> tuple[bool, bool]:
        """Which of the left and the right switch exist (DS-TMC428 Table 9-3)."""
        word = self._known.get(self._global.address, self._global.reset or 0)
        if self._refmux.unpack(word):
            return True, True
        if self._mot1r.unpack(word):
            return axis < 2, axis == 0
        return True, False

    def _switch_bit(self, side: str, axis: int) -> Field:
        return self._field(self._switch_row, f"{side}{axis + 1}")

    async def _switches(self, words: Words, axis: int) -> tuple[bool | None, bool | None]:
        self._saw_word(self._global, await words.read(self._global))
        word = await words.read(self._switch_row)
        left, right = self._wired(axis)
        return (
            bool(self._switch_bit("l", axis).unpack(word)) if left else None,
            bool(self._switch_bit("r", axis).unpack(word)) if right else None,
        )

    def switch_problem(self) -> tuple[str, str] | None:
        word = self._known.get(self._global.address, 0)
        if self._refmux.unpack(word) and not self._field(self._global, "continuous_update").unpack(word):
            return "multiplexed switches are not sampled at rest", "set continuous_update (DS-TMC428 9.7)"
        return None

    def switch_latency_s(self) -> float:
        """Multiplexed switches are sampled by datagrams, at rest by those of the continuous update (DS-TMC428 9.7)."""
        word = self._known.get(self._global.address, 0)
        settings = [self.setting(axis.index) for axis in self.axes]
        if not self._refmux.unpack(word) or any(setting is None for setting in settings):
            return 0.0
        updates_hz = sum(self.clock_hz / 32768 / 2**setting.ramp_div for setting in settings if setting is not None)
        return float(1 / updates_hz)

    def _reached(self, status: int, axis: int) -> bool:
        return bool(status >> (2 * axis) & 1)

    def _reached_column(self, status: IntArray, axis: int) -> FloatArray:
        return (status >> (2 * axis) & 1).astype(np.float64)

    def _switch_decoder(self, side: str, axis: int, frames: Frames) -> Decoder:
        if side == "reference":
            return lambda _, __, status: (status >> (2 * axis + 1) & 1).astype(np.float64)
        column = frames.column(self._switch_row)
        bit = self._switch_bit(side[0], axis).lsb
        where = 0 if side == "left" else 1

        def decode(times_s: FloatArray, words: IntArray, status: IntArray) -> FloatArray:
            if not self._wired(axis)[where]:
                return np.full(len(times_s), np.nan)
            return (words[:, column] >> bit & 1).astype(np.float64)

        return decode

    # --- writes with a meaning of their own -----------------------------------------------------

    async def _before_write(self, words: Words, register: Register, word: int) -> list[str]:
        if register is self._cover_datagram:
            await words.read(self._cover)
            if words.status >> STATUS_TMC428.index("CDGW") & 1:
                raise WrongState("a cover datagram still waits to be sent (CDGW)", "try again when CDGW is 0")
        return await super()._before_write(words, register, word)

    def _expected_back(self, register: Register, word: int) -> int:
        if register is self._cover:  # the chip stores cover_pos + 1 (DS-TMC428 9.2)
            return self._shifted(word, 1)
        return super()._expected_back(register, word)

    def _as_written(self, register: Register, held: int) -> int:
        if register is self._cover:
            return self._shifted(held, -1)
        return super()._as_written(register, held)

    def as_set(self, register: Register, word: int) -> int:
        """The word that has made `register` read `word`: cover_pos reads one more than was written."""
        return self._as_written(register, word)

    def _shifted(self, word: int, by: int) -> int:
        part = self._cover_pos
        position = (part.unpack(word) + by) % (1 << part.width)
        return part.pack(position, over=word)

    async def _explain(self, words: Words, register: Register, word: int, back: int) -> str | None:
        if register is self._cover:
            return None  # only cw changes by itself, and that one is read only
        if register.name.startswith("datagram_"):
            return "re-armed: it takes the next answer of the driver chain; the value itself cannot be written"
        return await super()._explain(words, register, word, back)

    # --- tables in RAM --------------------------------------------------------------------------

    async def read_microstep_table(self) -> list[int]:
        self.require_connected()
        return list(values_from_ram_words(await self._read_ram(RAM_TABLE)))

    async def write_microstep_table(self, values: Sequence[int]) -> list[int]:
        try:
            wanted = table_ram_words(values)
        except ValueError as error:
            raise UsageError(str(error)) from error
        self.require_connected()
        await self._write_ram(RAM_TABLE, wanted, "the microstep table")
        return await self.read_microstep_table()

    async def read_driver_chain(self) -> ChainContents:
        self.require_connected()
        ram_words = await self._read_ram(RAM_CHAIN)
        word = await read_once_more(self.queue, self._global.address)
        return ChainContents(ram_words, self._lsmd.unpack(word))

    async def write_driver_chain(self, ram_words: Sequence[int], lsmd: int) -> ChainContents:
        if not 1 <= len(ram_words) <= RAM_WORDS:
            raise OutOfRange("number of RAM words", len(ram_words), 1, RAM_WORDS)
        for index, word in enumerate(ram_words):
            if word & ~RAM_MASK:
                raise OutOfRange(f"RAM word {index}", word, 0, RAM_MASK, "two cells of 6 bits")
        if not self._lsmd.minimum <= lsmd <= self._lsmd.maximum:
            raise OutOfRange("LSMD", lsmd, self._lsmd.minimum, self._lsmd.maximum)
        self.require_connected()
        await self._write_ram(RAM_CHAIN, ram_words, "the driver chain")
        await self.write(self._global.name, fields={"LSMD": lsmd})
        return await self.read_driver_chain()

    async def _read_ram(self, first: int) -> list[int]:
        words = []
        for index in range(RAM_WORDS):
            words.append(await read_once_more(self.queue, first + index) & RAM_MASK)  # noqa: PERF401 (in turns)
        return words

    async def _write_ram(self, first: int, wanted: Sequence[int], table: str) -> None:
        """Write and read back each word. Other commands may come between two words, a second writer of RAM may not."""
        rows = [register for index in range(len(wanted)) if (register := self.table.at(first + index)) is not None]
        async with self.queue.turn(Priority.COMMAND) as turn:
            words = Words(turn)
            before = [await words.read(register) & RAM_MASK for register in rows]
            for register, word in zip(rows, wanted, strict=True):
                await words.write(register, word)
            for register, word, old in zip(rows, wanted, before, strict=True):
                back = await words.read(register) & RAM_MASK
                if back != word:
                    raise WriteRefused(register.name, word, back, "write the table again")
                if word != old:
                    self._tell(register_changed(register, old, word, words.time_s, part_of=table))
