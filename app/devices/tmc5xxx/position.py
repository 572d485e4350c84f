"""Calling the place where a motor stands by another number."""

from __future__ import annotations

from dataclasses import dataclass

from ...errors import OutOfRange, WriteRefused, WrongState
from ...links.queue import Priority
from ...registers.model import Register, to_raw
from ..core.capabilities import PositionFromEncoder, PositionSetting, Registers
from ..core.register_io import Snapshot, Write
from ..core.register_link import RegisterLink
from ..core.session import Session
from .decoded_registers import DecodedRegisters
from .memory import ChipMemory
from .predictions import Predictions
from .roles import HIGHEST, LOWEST
from .standstill import Standstill


@dataclass(frozen=True, slots=True)
class PositionCalls(PositionSetting, PositionFromEncoder):
    """Sets XACTUAL of an axis that stands, and all that counts with it."""

    session: Session
    link: RegisterLink
    memory: ChipMemory
    decoded: DecodedRegisters
    standstill: Standstill
    predictions: Predictions
    registers: Registers

    def cruise_pps(self, axis: int) -> float | None:
        """The speed limit of moves as the user has set it [pps]; None where nobody knows it."""
        return self.decoded.ramp(self.session.axis(axis).index).pps("VMAX")

    async def set_position(self, axis: int, position: int, *, with_encoder: bool = True) -> int:
        """Call the place where the motor stands `position`; XTARGET follows, and an encoder that counts, but for
        `with_encoder` False. Returns the difference.

        The axis is in velocity mode with VMAX 0 afterwards, as after a stop. Raises WrongState while the motor turns,
        OutOfRange outside 32 bits.
        """
        rows = self.memory.rows(self.session.axis(axis).index)
        if not LOWEST <= position <= HIGHEST:
            raise OutOfRange("position", position, LOWEST, HIGHEST, "microsteps")
        self.session.require_connected()
        if self.session.limiter is not None:
            self.session.limiter.require_target(axis, position)
        # No guard: a stop that comes between changes nothing here, and nothing here sets the motor in motion.
        async with self.session.queue.turn(Priority.COMMAND) as turn:
            io = self.link.io(turn)
            encoder = rows.x_enc if self.decoded.counts_encoder(axis) else None
            asked = (rows.xactual, rows.vactual, *(() if encoder is None else (encoder,)))
            read = Snapshot(asked, await io.read_many(asked))
            if read.word(rows.vactual):
                raise WrongState(f"axis {axis} moves", "stop it first")
            before = read.value(rows.xactual)
            shift = before - position
            self.session.commanded(axis, "set_position", position=position)
            steps: list[tuple[Register, int]] = [
                *self.standstill.writes(axis),
                (rows.xactual, to_raw(position, 32)),
                (rows.xtarget, to_raw(position, 32)),
            ]
            if encoder is not None and with_encoder:
                steps.append((encoder, to_raw(read.value(encoder) - shift, 32)))
            checked = (rows.xactual, rows.xtarget, rows.rampmode)
            back = Snapshot(checked, (await io.chain(*(Write(*step) for step in steps), checked))[0])
            self.memory.saw(back)
            self.predictions.end(axis, io.time_s, "the position was set")
        for register in (rows.xactual, rows.xtarget):
            if back.value(register) != position:
                raise WriteRefused(
                    register.name, to_raw(position, 32), back.word(register), f"{rows.xactual.name} was {before}"
                )
        self.session.saw_position(axis, position, io.asked_s)
        return shift

    async def position_from_encoder(self, axis: int) -> int:
        """Call the place where the motor stands what its encoder shows; the difference. Raises WrongState."""
        rows = self.memory.rows(self.session.axis(axis).index)
        if rows.x_enc is None or not self.decoded.counts_encoder(axis):
            raise WrongState("no encoder counts on this axis", "set ENC_CONST first")
        return await self.set_position(
            axis, (await self.registers.read(rows.x_enc.name, axis)).value, with_encoder=False
        )
