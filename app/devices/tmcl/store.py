"""The module's EEPROM, which keeps user variables and coordinates on request."""

from __future__ import annotations

from ...errors import WrongState
from ...links.tmcl import Request
from ...registers.model import Space
from ...registers.tmcl.commands import COORDINATES_IN_EEPROM, Opcode
from ..core.capabilities import ParameterStore
from ..core.results import RegisterReading
from ..core.session import Session
from ..core.tmcl_link import TmclLink
from .records import Records
from .state import ModuleState

GETS_BACK = frozenset({Opcode.RSAP, Opcode.RSGP, Opcode.GCO})
"""Commands that make RAM what EEPROM holds."""


class Eeprom(ParameterStore):
    """Copies parameters to EEPROM and back."""

    def __init__(self, session: Session, state: ModuleState, link: TmclLink, records: Records) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._records = records

    async def store(self, name: str, axis: int | None = None) -> RegisterReading:
        """Copy a parameter to EEPROM; its value as RAM holds it.

        Raises UnknownThing, LinkError, and WrongState where it cannot be stored or the module refuses.
        """
        return await self._copy(name, axis, Opcode.STAP, Opcode.STGP, Opcode.SCO)

    async def restore(self, name: str, axis: int | None = None) -> RegisterReading:
        """Copy a parameter back from EEPROM; its value afterwards. Raises as `store`."""
        return await self._copy(name, axis, Opcode.RSAP, Opcode.RSGP, Opcode.GCO)

    async def _copy(
        self, name: str, axis: int | None, parameter: Opcode, variable: Opcode, coordinate: Opcode
    ) -> RegisterReading:
        register, _ = self._state.find(name, axis)
        if register.stored == "auto":
            raise WrongState(f"{register.name} goes to EEPROM by itself as it is written", "write it")
        if register.stored != "on request":
            also = ", and axis parameters that are settings" if self._state.module.stores_axis else ""
            keeps = f"user variables 0..55 and coordinates 1..20 can be stored{also}"
            raise WrongState(f"{register.name} ({register.alias}) lives in RAM alone", keeps)
        if parameter is Opcode.RSAP and register in self._state.roles.moving:
            raise WrongState(
                f"restoring {register.name} ({register.alias}) would change what positions count", "write it"
            )
        self._session.require_connected()
        if register.space is Space.AXIS:
            request = Request(self._link.address, parameter, register.address)
        elif register.space is Space.COORDINATE:
            request = Request(self._link.address, coordinate, register.address, COORDINATES_IN_EEPROM)
        else:
            request = Request(self._link.address, variable, register.address, 2)
        async with self._link.calls() as calls:
            old = await calls.get(register) if request.opcode in GETS_BACK else None
            await calls.do(request)
            value = await calls.get(register)
        if old is not None:
            self._records.tell_change(register, old, value)
        return self._records.reading(register, value)
