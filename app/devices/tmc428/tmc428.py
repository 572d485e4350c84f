"""What is the TMC428's own: switches behind a multiplexer, cover datagrams, and no register that tells its type."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ...errors import OtherModel, WrongState
from ...registers.model import Field, Register, RegisterTable
from ...registers.tmc428.status import STATUS_TMC428
from ...registers.tmc428.tmc4210 import TYPE_VERSION
from ..core.register_io import RegisterIO, read_once_more
from ..core.register_link import RegisterLink
from ..core.register_samples import Asked
from ..core.sample_plan import Decoder, FloatArray, IntArray
from .axis_roles import AxisRoles, field_of
from .identity import RampIdentity
from .interrupts import Interrupts
from .memory import RampMemory
from .prediction import TickedBook
from .switching import Switching
from .writes import RampWrites

GLOBAL = "stepper_motor_global_parameter_register"
SECOND_PMUL, PMUL_MSB = 0x19, 15
TYPE_ADDRESS = 0x39
"""Unused here, so it reads 0; the TMC4210 and the TMC429 show their type there."""


def axis_roles(table: RegisterTable, axis: int) -> AxisRoles:
    """The registers of `axis` by their names in this chip's data sheet."""
    return AxisRoles.of(
        table,
        axis,
        reference="lp_ref_conf_rm",
        dividers="pulse_div_ramp_div_usrs",
        interrupts="interrupt_mask_interrupt_flags",
        mode="rm",
    )


class Tmc428Identity(RampIdentity):
    """Tells a TMC428 from what has a type register."""

    async def probe(self) -> str:
        session = self.link.session
        kind = await read_once_more(session.queue, TYPE_ADDRESS)
        if kind == TYPE_VERSION:
            # A second motor's PMUL has its leading one; where there is none, nothing answers (inferred). It is stopped
            # as the first one named.
            second = await read_once_more(session.queue, SECOND_PMUL)
            found = ("tmc429", "tmc4210") if second >> PMUL_MSB & 1 else ("tmc4210", "tmc429")
            raise OtherModel("a TMC429 or TMC4210 answers here, not a TMC428", session.model, found)
        async with session.queue.turn() as turn:
            io = self.link.io(turn)
            settings = await io.read(self.link.table.get(GLOBAL))
        return f"a TMC428 answers; global parameters {settings:#08x}, status {io.status:#04x}"


class Tmc428Switching(Switching):
    """Up to six switches, as refmux and mot1r have them wired."""

    status_names = STATUS_TMC428

    def __init__(self, link: RegisterLink, memory: RampMemory) -> None:
        self._session = link.session
        self._memory = memory
        self._global = link.table.get(GLOBAL)
        self._inputs = link.table.get("l3_r3_l2_r2_l1_r1")
        self._refmux = field_of(self._global, "refmux")
        self._mot1r = field_of(self._global, "mot1r")

    def _wired(self, axis: int) -> tuple[bool, bool]:
        """Which of the left and the right switch exist (DS-TMC428 Table 9-3)."""
        word = self._memory.word(self._global, self._global.reset or 0)
        if self._refmux.unpack(word):
            return True, True
        if self._mot1r.unpack(word):
            return axis < 2, axis == 0
        return True, False

    def _bit(self, side: str, axis: int) -> Field:
        return field_of(self._inputs, f"{side}{axis + 1}")

    async def read(self, io: RegisterIO, axis: int) -> tuple[bool | None, bool | None]:
        self._memory.saw(self._global, await io.read(self._global))
        word = await io.read(self._inputs)
        left, right = self._wired(axis)
        return (
            bool(self._bit("l", axis).unpack(word)) if left else None,
            bool(self._bit("r", axis).unpack(word)) if right else None,
        )

    def problem(self) -> tuple[str, str] | None:
        word = self._memory.word(self._global)
        if self._refmux.unpack(word) and not field_of(self._global, "continuous_update").unpack(word):
            return "multiplexed switches are not sampled at rest", "set continuous_update (DS-TMC428 9.7)"
        return None

    def latency_s(self) -> float:
        """Multiplexed switches are sampled by datagrams, at rest by those of the continuous update (DS-TMC428 9.7)."""
        settings = [self._memory.ramp(axis.index) for axis in self._session.axes]
        if not self._refmux.unpack(self._memory.word(self._global)) or any(ramp is None for ramp in settings):
            return 0.0
        clock_hz = self._session.clock_hz
        updates_hz = sum(clock_hz / 32768 / 2**ramp.ramp_div for ramp in settings if ramp is not None)
        return float(1 / updates_hz)

    def reached(self, status: int, axis: int) -> bool:
        return bool(status >> (2 * axis) & 1)

    def reached_column(self, status: IntArray, axis: int) -> FloatArray:
        return (status >> (2 * axis) & 1).astype(np.float64)

    def decoder(self, side: str, axis: int, asked: Asked) -> Decoder:
        if side == "reference":
            return lambda _, __, status: (status >> (2 * axis + 1) & 1).astype(np.float64)
        column = asked.column(self._inputs)
        bit = self._bit(side[0], axis).lsb
        where = 0 if side == "left" else 1

        def decode(times_s: FloatArray, words: IntArray, status: IntArray) -> FloatArray:
            if not self._wired(axis)[where]:
                return np.full(len(times_s), np.nan)
            return (words[:, column] >> bit & 1).astype(np.float64)

        return decode


class Tmc428Writes(RampWrites):
    """Besides those of the ramps: cover datagrams, of which the chip counts one more than was written."""

    def __init__(
        self, link: RegisterLink, memory: RampMemory, books: Sequence[TickedBook], interrupts: Interrupts
    ) -> None:
        super().__init__(link, memory, books, interrupts)
        self._cover = link.table.get("cover_pos_cover_len")
        self._cover_datagram = link.table.get("cover_datagram")
        self._cover_pos = field_of(self._cover, "cover_pos")

    async def before_write(self, io: RegisterIO, register: Register, word: int) -> list[str]:
        if register is self._cover_datagram:
            await io.read(self._cover)
            if io.status >> STATUS_TMC428.index("CDGW") & 1:
                raise WrongState("a cover datagram still waits to be sent (CDGW)", "try again when CDGW is 0")
        return await super().before_write(io, register, word)

    def expected_back(self, register: Register, word: int) -> int:
        # The chip stores cover_pos + 1 (DS-TMC428 9.2).
        return self._shifted(word, 1) if register is self._cover else word

    def as_written(self, register: Register, held: int) -> int:
        return self._shifted(held, -1) if register is self._cover else held

    def _shifted(self, word: int, by: int) -> int:
        part = self._cover_pos
        position = (part.unpack(word) + by) % (1 << part.width)
        return part.pack(position, over=word)

    async def explain(self, io: RegisterIO, register: Register, word: int, back: int) -> str | None:
        if register is self._cover:
            return None  # only cw changes by itself, and that one is read only
        if register.name.startswith("datagram_"):
            return "re-armed: it takes the next answer of the driver chain; the value itself cannot be written"
        return await super().explain(io, register, word, back)
