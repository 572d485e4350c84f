"""Setting the position of an axis that stands."""

from __future__ import annotations

from ...errors import OutOfRange, WriteRefused, WrongState
from ...registers.model import to_raw
from ..core.capabilities import PositionFromEncoder, PositionSetting, Registers
from ..core.register_io import Snapshot, Write
from ..core.register_link import RegisterLink
from . import roles
from .cruise import Cruise
from .expected_motion import ExpectedMotion
from .memory import ChipMemory

LOWEST, HIGHEST = -(1 << 31), (1 << 31) - 1
ELECTRICAL_TURN = 1024


class Position(PositionSetting, PositionFromEncoder):
    """Calls the place where the axis of one TMC4361 stands by another number."""

    def __init__(
        self,
        link: RegisterLink,
        memory: ChipMemory,
        cruise: Cruise,
        expected: ExpectedMotion,
        registers: Registers,
    ) -> None:
        self._link = link
        self._session = link.session
        self._memory = memory
        self._cruise = cruise
        self._expected = expected
        self._registers = registers

    def cruise_pps(self, axis: int) -> float | None:
        """The speed limit of moves as the user has set it [pps]."""
        self._session.axis(axis)
        return self._cruise.speed / 256

    async def set_position(self, axis: int, position: int, *, with_encoder: bool = True) -> int:
        """Call the place where the motor stands `position`; XTARGET and the encoder follow. Returns the difference.

        Without `with_encoder` ENC_POS stays as it is: where the encoder is absolute, it alone knows its place.

        The axis is in velocity mode with VMAX 0 afterwards, as after a stop. Regulation is off for the moment in which
        position and encoder disagree, and CL_OFFSET turns with the encoder, so that the field stays where it is.
        Raises WrongState while the motor turns, OutOfRange outside 32 bits.
        """
        self._session.axis(axis)
        if not LOWEST <= position <= HIGHEST:
            raise OutOfRange("position", position, LOWEST, HIGHEST, "microsteps")
        self._session.require_connected()
        if self._session.limiter is not None:
            self._session.limiter.require_target(axis, position)
        # No guard: a stop that comes between changes nothing here, and nothing here sets the motor in motion.
        async with self._link.turn() as turn:
            io = self._link.io(turn)
            asked = (
                roles.XACTUAL,
                roles.VACTUAL,
                roles.AACTUAL,
                roles.ENC_POS,
                roles.ENC_IN_CONF,
                roles.CL_OFFSET,
                roles.GENERAL_CONF,
                roles.RAMPMODE,
            )
            read = Snapshot(asked, await io.read_many(asked))
            if read.word(roles.VACTUAL) or read.word(roles.AACTUAL):
                raise WrongState(f"axis {axis} moves", "stop it first")
            before = read.value(roles.XACTUAL)
            shift = before - position
            turned = -shift if roles.REVERSED.unpack(read.word(roles.GENERAL_CONF)) else shift
            offset = read.value(roles.CL_OFFSET) + turned
            enc_in_conf, mode = read.word(roles.ENC_IN_CONF), read.word(roles.RAMPMODE) & 3
            regulated = roles.REGULATION.unpack(enc_in_conf) != 0
            self._session.commanded(axis, "set_position", position=position)
            self._cruise.overwrite_mode(mode)
            self._cruise.overwrite_vmax(0)
            steps = [
                Write(roles.VMAX, 0),
                Write(roles.RAMPMODE, mode),
                *([Write(roles.ENC_IN_CONF, roles.REGULATION.pack(0, enc_in_conf))] if regulated else []),
                Write(roles.XACTUAL, to_raw(position, 32)),
                Write(roles.XTARGET, to_raw(position, 32)),
                *(
                    [
                        Write(roles.ENC_POS, to_raw(read.value(roles.ENC_POS) - shift, 32)),
                        Write(roles.CL_OFFSET, to_raw(_half_turn(offset), 32)),
                    ]
                    if with_encoder
                    else []
                ),
                *([Write(roles.ENC_IN_CONF, enc_in_conf)] if regulated else []),
            ]
            checked = (roles.XACTUAL, roles.XTARGET, roles.RAMPMODE, roles.VMAX)
            back = Snapshot(checked, (await io.chain(*steps, checked))[0])
            self._memory.saw_all(back)
            self._expected.book.end(io.time_s, "the position was set")
        for register in (roles.XACTUAL, roles.XTARGET):
            if back.value(register) != position:
                raise WriteRefused(
                    register.name, to_raw(position, 32), back.word(register), f"{roles.XACTUAL.name} was {before}"
                )
        return shift

    async def position_from_encoder(self, axis: int) -> int:
        """Call the place where the motor stands what its encoder shows; the difference. Raises WrongState."""
        # Read, not remembered: a write of ENC_IN_RES changes it.
        if not (await self._registers.read(roles.ENC_CONST.name, axis)).value:
            raise WrongState("no encoder counts on this axis", "write ENC_IN_RES first")
        encoder = (await self._registers.read(roles.ENC_POS.name, axis)).value
        return await self.set_position(axis, encoder, with_encoder=False)


def _half_turn(offset: int) -> int:
    """An electrical angle as -512..511."""
    return (offset + ELECTRICAL_TURN // 2) % ELECTRICAL_TURN - ELECTRICAL_TURN // 2
