"""START as the wire by which several chips start together (DS-TMC4361 10.1; START_CONF).

Each has its new XTARGET wait. The one that leads has POS_COMP_REACHED trigger its start: writing its own position to
POS_COMP is what starts all, for its START is an output and theirs are triggers without delay. START is low active, as
after power-on: then a chip on the wire that takes no part drives it to where it rests.
"""

from __future__ import annotations

from dataclasses import dataclass

from ...errors import WriteRefused, WrongState
from ...registers.model import Register, to_raw
from ..core.capabilities import StartWire
from ..core.register_io import RegisterIO, Snapshot, Write
from ..core.register_link import RegisterLink
from . import roles
from .memory import ChipMemory
from .moves import Moves

POS_COMP, START_DELAY = roles.row("POS_COMP"), roles.row("START_DELAY")
_XTARGET_WAITS, _BY_PIN, _BY_COMPARE, _AT_ONCE = 1 << 0, 1 << 5, 1 << 8, 1 << 10
LEADS = _XTARGET_WAITS | _BY_COMPARE
LISTENS = _XTARGET_WAITS | _BY_PIN | _AT_ONCE
FAR = 1 << 30
_COMPARED = roles.part(roles.REFERENCE_CONF, "modified_pos_compare")
_BY_ENCODER = roles.part(roles.REFERENCE_CONF, "pos_comp_source")
_REACHED = roles.part(roles.STATUS, "TARGET_REACHED_F")
_BORROWED = (roles.START_CONF, POS_COMP, START_DELAY)


@dataclass(frozen=True, slots=True)
class _Before:
    words: tuple[tuple[Register, int], ...]
    leads: bool


class StartPin(StartWire):
    """Of one TMC4361."""

    def __init__(self, link: RegisterLink, memory: ChipMemory, moves: Moves) -> None:
        self._link = link
        self._session = link.session
        self._memory = memory
        self._moves = moves
        self._before: _Before | None = None

    async def arm_start(self, axis: int, /, *, leads: bool) -> None:
        if self._before is not None:
            raise WrongState(f"{self._session.name} waits for a start already", "let that one end first")
        await self._moves.stand_ready(axis)
        async with self._link.command(axis) as turn:
            io = self._link.io(turn)
            asked = (*_BORROWED, roles.REFERENCE_CONF, roles.XACTUAL, roles.STATUS)
            held = Snapshot(asked, await io.read_many(asked))
            if leads and (_COMPARED.unpack(held.word(roles.REFERENCE_CONF)) or self._by_encoder(held)):
                raise WrongState(
                    f"POS_COMP of {self._session.name} is not compared with XACTUAL, so writing it cannot give a start",
                    "write REFERENCE_CONF.modified_pos_compare 0 and pos_comp_source 0",
                )
            self._before = _Before(tuple((register, held.word(register)) for register in _BORROWED), leads)
            away = to_raw(_signed(held.word(roles.XACTUAL) + FAR), 32)
            writes = [
                *([Write(POS_COMP, away), Write(START_DELAY, 0)] if leads else []),
                Write(roles.START_CONF, LEADS if leads else LISTENS),
            ]
            self._link.allow(writes)
            await self._write(io, writes)

    @staticmethod
    def _by_encoder(held: Snapshot) -> bool:
        return bool(_BY_ENCODER.unpack(held.word(roles.REFERENCE_CONF)))

    async def give_start(self, axis: int, /) -> None:
        async with self._link.command(axis) as turn:
            io = self._link.io(turn)
            here = await io.read(roles.XACTUAL)
            await io.chain(Write(POS_COMP, here))

    async def has_started(self, axis: int, /) -> bool:
        async with self._link.command(axis) as turn:
            status, velocity = await self._link.io(turn).read_many((roles.STATUS, roles.VACTUAL))
        return bool(velocity) or not _REACHED.unpack(status)

    async def disarm_start(self, axis: int, /, *, started: bool) -> None:
        before, self._before = self._before, None
        if before is None:
            return
        async with self._link.turn() as turn:  # behind a stop, too
            io = self._link.io(turn)
            if not started:
                await io.chain(Write(roles.XTARGET, await io.read(roles.XACTUAL)))
            await self._write(io, [Write(register, word) for register, word in before.words])

    async def _write(self, io: RegisterIO, writes: list[Write]) -> None:
        registers = [write.register for write in writes]
        back = Snapshot(registers, (await io.chain(*writes, registers))[0])
        for write in writes:
            if back.word(write.register) != write.word:
                raise WriteRefused(write.register.name, write.word, back.word(write.register), "try again")
        self._memory.saw_all(back)


def _signed(word: int) -> int:
    word &= 0xFFFFFFFF
    return word - (1 << 32) if word >> 31 else word
