"""What the parameters of a module mean as a configuration."""

from __future__ import annotations

from ...errors import WrongState
from ...registers.model import Register, to_raw
from ..core.capabilities import ConfigurationRules
from ..core.results import AxisState
from ..core.session import Session
from ..core.tmcl_refusals import limits, unit_of
from .borrowed import BorrowedAcceleration
from .parameters import Parameters
from .state import ModuleState
from .stops import Stops


class ModuleConfiguration(ConfigurationRules):
    """An immediate stop borrows the acceleration; a program writes parameters too; a motor drives on to its target."""

    def __init__(
        self,
        session: Session,
        state: ModuleState,
        parameters: Parameters,
        borrowed: BorrowedAcceleration,
        stops: Stops,
    ) -> None:
        self._session = session
        self._state = state
        self._parameters = parameters
        self._borrowed = borrowed
        self._stops = stops

    @property
    def firmware(self) -> str:
        return self._state.firmware

    def unit_of(self, register: Register, /) -> str:
        return unit_of(register, self._state.unit_mode)

    def range_of(self, register: Register, /) -> tuple[int, int]:
        return limits(register, self._state.unit_mode)

    def as_set(self, register: Register, word: int, /) -> int:
        own = self._borrowed.own
        if own is not None and register is self._state.roles.max_acceleration:
            return to_raw(own, register.width)
        return to_raw(register.decode(word), register.width)

    async def require_idle(self) -> None:
        if (await self._parameters.read("tmcl_application_status")).value:
            raise WrongState(f"a program runs on {self._session.name}, which may write parameters too", "stop it first")

    async def hold_still(self, axis: int, state: AxisState, /) -> list[str]:
        if state.target_position is None or state.target_position == state.position:
            return []
        self._session.require_connected()
        (outcome,) = await self._stops.stop_axes([axis], "ramp")
        if outcome.problem is not None:
            raise outcome.problem
        return [f"axis {axis} was not at its target {state.target_position}: it was told to stop there"]
