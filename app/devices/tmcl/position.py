"""Setting the position of a TMCL module's axis that stands."""

from __future__ import annotations

from ...errors import OutOfRange, WriteRefused, WrongState
from ...links.tmcl import Request
from ...registers.tmcl.commands import Opcode
from ..core.capabilities import PositionFromEncoder, PositionSetting
from ..core.session import Session
from ..core.tmcl_calls import Calls
from ..core.tmcl_frames import STATUS
from ..core.tmcl_link import TmclLink
from .ongoing import OngoingMotion
from .state import ModuleState


class ModulePosition(PositionSetting, PositionFromEncoder):
    """Calls the place where the motor stands by another number (AP 1).

    The axis is stopped by MST first: in positioning the module would drive on to its target from its new place.
    """

    def __init__(self, session: Session, state: ModuleState, link: TmclLink, ongoing: OngoingMotion) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._ongoing = ongoing

    async def set_position(self, axis: int, position: int, /) -> int:
        """Call the place where the motor stands `position` [microsteps]; the difference. The encoders keep theirs.

        Raises WrongState while it moves, OutOfRange beyond what the module counts.
        """
        axis, half = self._session.axis(axis).index, 1 << (self._state.module.position_bits - 1)
        if not -half <= position < half:
            raise OutOfRange("position", position, -half, half - 1, "microsteps")
        self._session.require_connected()
        async with self._link.calls(axis) as calls:
            return await self._set(calls, axis, position)

    async def position_from_encoder(self, axis: int) -> int:
        """Call it what the built-in encoder shows (AP 209); the difference.

        Raises WrongState while it moves, and where the firmware has no such encoder.
        """
        axis, encoder = self._session.axis(axis).index, self._state.roles.encoder
        self._session.require_connected()
        async with self._link.calls(axis) as calls:
            (shown,) = await calls.ask_many((encoder,))
            if shown is None:
                raise WrongState(f"this module has no {encoder.name} ({encoder.alias})")
            return await self._set(calls, axis, shown)

    async def _set(self, calls: Calls, axis: int, position: int) -> int:
        roles, address = self._state.roles, self._link.address
        before, speed = await calls.ask_many((roles.actual_position, roles.actual_speed))
        if speed or (await calls.do(Request(address, Opcode.RFS, STATUS))).value:
            raise WrongState(f"axis {axis} moves", "stop it first")
        if self._session.limiter is not None:
            self._session.limiter.require_target(axis, position)
        await calls.do(Request(address, Opcode.MST))
        self._ongoing.driven = "velocity"
        self._session.commanded(axis, "set_position", position=position)
        self._ongoing.book.end(calls.time_s, "the position was set")
        await calls.do(Request(address, Opcode.SAP, roles.actual_position.address, 0, position))
        back = await calls.get(roles.actual_position)
        if back != position:
            raise WriteRefused(roles.actual_position.name, position, back, f"it was {before}")
        return calls.need(roles.actual_position, before) - position
