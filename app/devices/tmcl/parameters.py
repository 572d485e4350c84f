"""Reading and writing the module's parameters: every write is checked before and read back after."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from ...errors import BadReply, BenchError, LinkTimeout, OutOfRange, UnknownParameter, UsageError, WrongState
from ...registers.model import Register, Space
from ..core.capabilities import Registers
from ..core.lookup import checked_fields
from ..core.results import RegisterReading, RegisterWritten, WriteItem
from ..core.session import Session
from ..core.tmcl_calls import Calls
from ..core.tmcl_link import TmclLink
from ..core.tmcl_refusals import limits, unit_of
from .moving_writes import MovingWrites
from .records import Records
from .state import ModuleState

ADDRESS, SUPPRESS_REPLY = 66, 255
"""Global parameters of bank 0 whose write changes how the module answers."""


class Parameters(Registers):
    """A module's parameters are its registers; `moving` writes those that may move the motor."""

    def __init__(
        self, session: Session, state: ModuleState, link: TmclLink, records: Records, moving: MovingWrites
    ) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._records = records
        self._moving = moving

    # --- reading --------------------------------------------------------------------------------

    async def read(self, name: str, axis: int | None = None) -> RegisterReading:
        register, part = self._state.find(name, axis)
        if not register.access.readable:
            raise WrongState(f"{register.name} ({register.alias}) is write only")
        self._session.require_connected()
        async with self._link.calls() as calls:
            value = await calls.get(register)
        reading = self._records.reading(register, value)
        if part is not None:
            reading.name, reading.value, reading.unit = part.name, reading.fields[part.name], part.unit
        return reading

    def clears_when_read(self, name: str, axis: int | None = None) -> bool:
        return self._state.find(name, axis)[0].read_clears

    async def read_all(self, axis: int | None = None, groups: Collection[str] = ()) -> list[RegisterReading]:
        """Every parameter but those that a read would clear: these only a caller gets that asks for them by name."""
        if axis is not None:
            self._session.axis(axis)
        self._session.require_connected()
        wanted = [
            register
            for register in self._state.table
            if register.access.readable
            and not register.read_clears
            and (axis is None or register.axis == axis)
            and (not groups or register.group in groups)
        ]
        values = await self._values(wanted)
        return [
            self._records.reading(register, value)
            for register, value in zip(wanted, values, strict=True)
            if value is not None
        ]

    async def _values(self, wanted: Sequence[Register]) -> list[int | None]:
        """Of many rows, a turn for some at a time; None for those that this module does not have."""
        values: list[int | None] = []
        for chunk in self._link.shares(wanted):
            async with self._link.calls() as calls:
                try:
                    values += await calls.get_many(chunk)
                except UnknownParameter:  # the table knows more than this firmware
                    for register in chunk:
                        values.append(await _value_or_none(calls, register))
        return values

    # --- writing --------------------------------------------------------------------------------

    async def write(
        self,
        name: str,
        axis: int | None = None,
        value: int | None = None,
        fields: dict[str, int | str] | None = None,
    ) -> RegisterWritten:
        register, part = self._state.find(name, axis)
        if (value is None) == (fields is None):
            raise UsageError("give either a value or fields")
        if fields is not None or part is not None:
            checked_fields(register, fields or {name: value or 0})  # no field can be written: tells so, by its name
        if value is None or not register.access.writable:
            raise WrongState(f"{register.name} ({register.alias}) is read only")
        unit_mode = self._state.unit_mode
        low, high = limits(register, unit_mode)
        if not low <= value <= high:
            raise OutOfRange(register.name, value, low, high, unit_of(register, unit_mode))
        if (register.space, register.address, value) == (Space.GLOBAL_0, SUPPRESS_REPLY, 1):
            raise WrongState(
                "without answers nobody can tell whether a command arrived", "send SGP 255, 0, 1 from the console"
            )
        self._session.require_connected()
        if self._moving.may_move(register):
            return await self._moving.write(register, value)
        async with self._link.calls(register.axis) as calls:
            old = await calls.before(register)
            try:
                written = await self._write(calls, register, value)
            except BenchError as error:
                self._records.tell(register, old, value, error)
                raise
        self._records.tell(register, old, value, written)
        self._moving.wrote(register)
        return written

    async def check_writes(self, items: Sequence[WriteItem]) -> None:
        limiter = self._session.limiter
        if limiter is None:
            return
        found = []
        for item in items:
            register, _ = self._state.find(item.name, item.axis)
            if register.space is Space.AXIS and limiter.affects_limits(register.address) and item.value is not None:
                found.append((register.address, item.value))
        limiter.check_writes(found)

    async def _write(self, calls: Calls, register: Register, value: int) -> RegisterWritten:
        records = self._records
        lost: BenchError | None = None
        try:
            await calls.put(register, value)
        except (BadReply, LinkTimeout) as error:
            lost = error  # it may have been done all the same, and reading it back moves nothing
        if (register.space, register.address) == (Space.GLOBAL_0, ADDRESS) and value != self._link.address:
            return await self._new_address(calls, register, value)
        if not register.access.readable:
            if lost is not None:
                raise lost
            return records.written(register, value, value, None, "it cannot be read back")
        try:
            back = await calls.get(register)
        except BenchError as error:
            raise lost or error from error
        verified, note = records.judge(register, value, back)
        if lost is not None:
            if verified is not True:
                raise lost
            note = f"{note}; " * bool(note) + "the answer was lost, the read-back shows the value"
        return records.written(register, value, back, verified, note)

    async def _new_address(self, calls: Calls, register: Register, value: int) -> RegisterWritten:
        """The module answers elsewhere from now on: only there it can be asked whether it took it."""
        calls.address = value
        back = await calls.get(register)
        verified, _ = self._records.judge(register, value, back)
        note = f"the module answers at address {value} now: change the address of this connection"
        return self._records.written(register, value, back, verified, note)


async def _value_or_none(calls: Calls, register: Register) -> int | None:
    try:
        return await calls.get(register)
    except UnknownParameter:
        return None
