"""How a motion begins: what could keep it from going well is looked at first, then one command goes out, once."""

from __future__ import annotations

from dataclasses import dataclass

from ...errors import LinkError, WrongState
from ...links.tmcl import Request
from ...registers.tmcl.commands import Opcode
from ..core.motion_watch import Kind
from ..core.session import Session
from ..core.tmcl_calls import Calls
from ..core.tmcl_frames import spelled
from ..core.tmcl_link import TmclLink
from .borrowed import BorrowedAcceleration
from .ongoing import OngoingMotion
from .state import ModuleState


@dataclass(frozen=True, slots=True)
class Before:
    """The axis right before it is sent somewhere."""

    position: int
    speed: int
    left: bool
    right: bool


class Departure:
    """Sets the axis off, for moves, rotation and reference searches."""

    def __init__(
        self,
        session: Session,
        state: ModuleState,
        link: TmclLink,
        ongoing: OngoingMotion,
        borrowed: BorrowedAcceleration,
    ) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._ongoing = ongoing
        self._borrowed = borrowed

    async def prepare(self, calls: Calls) -> tuple[Before, list[str]]:
        """Look before it goes out, and refuse what cannot go well. Only a borrowed acceleration is written."""
        state, roles = self._state, self._state.roles
        missing = [row for row in roles.remembered if state.last(row) is None]
        await calls.ask_many((*roles.always_fresh, roles.step_direction, *missing))
        calls.unit_mode = state.unit_mode
        if state.last(roles.step_direction):
            raise WrongState(
                "the module follows its step/direction inputs, and no command moves it",
                "write step_direction_mode (AP 254) 0 first",
            )
        await self._borrowed.give_back(calls)
        position, speed, left, right = await calls.ask_many(roles.before)
        warnings = []
        if state.last(roles.off_time) == 0:
            warnings.append("chopper_off_time (AP 167) is 0: the driver is off and the motor will not turn")
        here, now = calls.need(roles.actual_position, position), calls.need(roles.actual_speed, speed)
        return Before(here, now, bool(left), bool(right)), warnings

    def blocked(self, way: float, before: Before) -> list[str]:
        """What a switch has against motion that way."""
        roles = self._state.roles
        for side, active, row, sign in (
            ("left", before.left, roles.left_disabled, -1),
            ("right", before.right, roles.right_disabled, 1),
        ):
            if active and way * sign > 0 and not self._state.last(row):
                return [f"the {side} switch is active and stops motion that way"]
        return []

    async def set_off(self, calls: Calls, request: Request, kind: Kind, target: int | None) -> float:
        """Send the command that moves the motor, once. Returns when it was obeyed, device time [s]."""
        session, what = self._session, spelled(request)
        self._link.check_limits(request)
        asked = {"target": target} if target is not None else {}
        if kind == "velocity":
            asked = {"velocity": -request.value if request.opcode == Opcode.ROL else request.value}
        session.commanded(request.motor, what, **asked)
        sent_s = session.device_time_s()
        try:
            await calls.move(request, what)
        except LinkError as error:
            self._ongoing.mark_unknown(str(error))
            raise
        started_s = calls.time_s if session.chip_timed else (sent_s + calls.time_s) / 2
        self._ongoing.drives(kind, started_s, target)
        return started_s
