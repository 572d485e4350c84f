"""Reading, writing and storing the module's parameters: every write is checked before and read back after."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence

from ...errors import (
    BadReply,
    BenchError,
    LinkTimeout,
    OutOfRange,
    UnknownParameter,
    UsageError,
    WriteRefused,
    WrongState,
)
from ...links.tmcl import Request
from ...registers.model import Register, Space, to_raw
from ...registers.tmcl.commands import COORDINATES_IN_EEPROM, Opcode
from ..core.changes import DONE, outcome_of, outcome_of_failure, register_changed
from ..core.lookup import checked_fields
from ..core.results import BatchResult, RegisterReading, RegisterWritten, WriteItem
from . import rows, units
from .calls import Calls
from .frames import writing
from .module import Module
from .refusals import limits, unit_of

CHUNK_S = 0.02
"""How long a reading of many parameters may keep other commands waiting [s]."""
CHUNKS = (4, 64)
"""Fewest and most questions of one turn."""
GETS_BACK = frozenset({Opcode.RSGP, Opcode.GCO})
"""Commands that make RAM what EEPROM holds."""
ADDRESS, SUPPRESS_REPLY = 66, 255
"""Global parameters of bank 0 whose write changes how the module answers."""


class Parameters(Module):
    """A TMCL module whose parameters are its registers."""

    # --- reading --------------------------------------------------------------------------------

    async def read(self, name: str, axis: int | None = None) -> RegisterReading:
        register, part = self.find(name, axis)
        if not register.access.readable:
            raise WrongState(f"{register.name} ({register.alias}) is write only")
        self.require_connected()
        async with self.calls() as calls:
            value = await calls.get(register)
        reading = self._reading(register, value)
        if part is not None:
            reading.name, reading.value, reading.unit = part.name, reading.fields[part.name], part.unit
        return reading

    def clears_when_read(self, name: str, axis: int | None = None) -> bool:
        return self.find(name, axis)[0].read_clears

    async def read_all(self, axis: int | None = None, groups: Collection[str] = ()) -> list[RegisterReading]:
        """Every parameter but those that a read would clear: these only somebody who asks for them by name gets."""
        if axis is not None:
            self.axis(axis)
        self.require_connected()
        wanted = [
            register
            for register in self.table
            if register.access.readable
            and not register.read_clears
            and (axis is None or register.axis == axis)
            and (not groups or register.group in groups)
        ]
        values = await self._values(wanted)
        return [
            self._reading(register, value) for register, value in zip(wanted, values, strict=True) if value is not None
        ]

    async def _values(self, wanted: Sequence[Register]) -> list[int | None]:
        """Of many rows, a turn for some at a time; None for those that this module does not have."""
        possible = self.calls_per_s_possible
        size = CHUNKS[1] if possible is None else max(CHUNKS[0], min(CHUNKS[1], round(possible * CHUNK_S)))
        values: list[int | None] = []
        for first in range(0, len(wanted), size):
            chunk = wanted[first : first + size]
            async with self.calls() as calls:
                try:
                    values += await calls.get_many(chunk)
                except UnknownParameter:  # the table knows more than this firmware
                    for register in chunk:
                        values.append(await _value_or_none(calls, register))
        return values

    def _reading(self, register: Register, value: int) -> RegisterReading:
        raw = to_raw(value, register.width) & register.mask
        return RegisterReading(
            register.name,
            register.address,
            register.axis,
            raw,
            value,
            register.unpack(raw) if register.fields else {},
            unit_of(register, self.unit_mode),
            register.space,
        )

    # --- writing --------------------------------------------------------------------------------

    async def write(
        self,
        name: str,
        axis: int | None = None,
        value: int | None = None,
        fields: dict[str, int | str] | None = None,
    ) -> RegisterWritten:
        register, part = self.find(name, axis)
        if (value is None) == (fields is None):
            raise UsageError("give either a value or fields")
        if fields is not None or part is not None:
            checked_fields(register, fields or {name: value or 0})  # no field can be written: tells so, by its name
        if value is None or not register.access.writable:
            raise WrongState(f"{register.name} ({register.alias}) is read only")
        low, high = limits(register, self.unit_mode)
        if not low <= value <= high:
            raise OutOfRange(register.name, value, low, high, unit_of(register, self.unit_mode))
        if (register.space, register.address, value) == (Space.GLOBAL_0, SUPPRESS_REPLY, 1):
            raise WrongState(
                "without answers nobody can tell whether a command arrived", "send SGP 255, 0, 1 from the console"
            )
        self.require_connected()
        if register in rows.MOVING:
            return await self._write_moving(register, value)
        async with self.calls(register.axis) as calls:
            old = await self._old(calls, register)
            try:
                written = await self._write(calls, register, value)
            except BenchError as error:
                self._wrote(register, old, value, error)
                raise
        self._wrote(register, old, value, written)
        await self._after_write(register)
        return written

    async def words_of(self, items: Sequence[WriteItem], matters: Callable[[int], bool]) -> list[tuple[int, int]]:
        found = []
        for item in items:
            register, _ = self.find(item.name, item.axis)
            if register.space is Space.AXIS and matters(register.address) and item.value is not None:
                found.append((register.address, item.value))
        return found

    async def write_many(self, items: Sequence[WriteItem]) -> BatchResult:
        await self.check_writes(items)
        done: list[RegisterWritten] = []
        for index, item in enumerate(items):
            try:
                done.append(await self.write(item.name, item.axis, item.value, item.fields))
            except BenchError as error:
                return BatchResult(done, error, len(items) - index - 1)
        return BatchResult(done, None, 0)

    async def _old(self, calls: Calls, register: Register) -> int | None:
        """What the module holds before a write, where it can be asked and clears nothing by it."""
        if not register.access.readable or register.read_clears:
            return None
        try:
            return await calls.get(register)
        except UnknownParameter:  # the table knows more than this firmware: the write itself will tell
            return None

    def _wrote(self, register: Register, old: int | None, value: int, came: RegisterWritten | BenchError) -> None:
        """Tell of a write, and of what came of it."""
        if isinstance(came, BenchError):
            outcome = outcome_of_failure(came)
        elif came.verified is False:  # it took another value, and says so
            outcome, value = f"{DONE}: {came.note}", came.value
        else:
            outcome = outcome_of(came.verified, came.note)
        if outcome is not None:
            bits = None if old is None else to_raw(old, register.width)
            at_s = self.port.last_exchange_s
            self._tell(register_changed(register, bits, to_raw(value, register.width), at_s, outcome))

    async def _write_moving(self, register: Register, value: int) -> RegisterWritten:
        """Write a parameter of `rows.MOVING`."""
        raise NotImplementedError

    async def _after_write(self, register: Register) -> None:
        """A write to `register` that moves nothing has happened, and its turn is over."""

    async def _write(self, calls: Calls, register: Register, value: int) -> RegisterWritten:
        lost: BenchError | None = None
        try:
            await calls.put(register, value)
        except (BadReply, LinkTimeout) as error:
            lost = error  # it may have been done all the same, and reading it back moves nothing
        if (register.space, register.address) == (Space.GLOBAL_0, ADDRESS) and value != self.address:
            return await self._new_address(calls, register, value)
        if not register.access.readable:
            if lost is not None:
                raise lost
            return self._written(register, value, value, None, "it cannot be read back")
        try:
            back = await calls.get(register)
        except BenchError as error:
            raise lost or error from error
        verified, note = self._judge(register, value, back)
        if lost is not None:
            if verified is not True:
                raise lost
            note = f"{note}; " * bool(note) + "the answer was lost, the read-back shows the value"
        return self._written(register, value, back, verified, note)

    async def _new_address(self, calls: Calls, register: Register, value: int) -> RegisterWritten:
        """The module answers elsewhere from now on: only there it can be asked whether it took it."""
        calls.address = value
        back = await calls.get(register)
        verified, _ = self._judge(register, value, back)
        note = f"the module answers at address {value} now: change the address of this connection"
        return self._written(register, value, back, verified, note)

    def _judge(self, register: Register, value: int, back: int) -> tuple[bool | None, str]:
        """Whether the module took `value`, and what to know about it. Raises WriteRefused."""
        if back == value:
            return True, register.write_note
        unit = unit_of(register, self.unit_mode)
        if register.volatile:
            return None, f"the module changes it by itself; it is {back} now"
        if abs(back - value) <= units.read_back_tolerance(unit, value, self.clock_hz, self.microsteps):
            return True, f"held as {back} {unit}: whole units of the driver chip"
        low, high = limits(register, self.unit_mode)
        if back in (low, high) or (0 < abs(back) < abs(value) and back * value > 0):
            return False, f"the module took it as {back}: clipped"
        why = register.write_note or "the module answered that it did it; read it again, or write another value"
        raise WriteRefused(register.name, value & register.mask, back & register.mask, why)

    def _written(self, register: Register, value: int, back: int, verified: bool | None, note: str) -> RegisterWritten:
        reading = self._reading(register, back)
        return RegisterWritten(
            reading.name,
            reading.address,
            reading.axis,
            reading.raw,
            reading.value,
            reading.fields,
            reading.unit,
            reading.space,
            written=value & register.mask,
            verified=verified,
            note=note,
        )

    # --- EEPROM ---------------------------------------------------------------------------------

    async def store(self, name: str, axis: int | None = None) -> RegisterReading:
        """Copy a parameter to EEPROM; its value as RAM holds it.

        Raises UnknownThing, LinkError, and WrongState where it cannot be stored or the module refuses.
        """
        return await self._copy(name, axis, Opcode.STGP, Opcode.SCO)

    async def restore(self, name: str, axis: int | None = None) -> RegisterReading:
        """Copy a parameter back from EEPROM; its value afterwards. Raises as `store`."""
        return await self._copy(name, axis, Opcode.RSGP, Opcode.GCO)

    async def _copy(self, name: str, axis: int | None, variable: Opcode, coordinate: Opcode) -> RegisterReading:
        register, _ = self.find(name, axis)
        if register.stored == "auto":
            raise WrongState(f"{register.name} goes to EEPROM by itself as it is written", "write it")
        if register.stored != "on request":
            keeps = "user variables 0..55 and coordinates 1..20 can be stored"
            raise WrongState(f"{register.name} ({register.alias}) lives in RAM alone", keeps)
        self.require_connected()
        if register.space is Space.COORDINATE:
            request = Request(self.address, coordinate, register.address, COORDINATES_IN_EEPROM)
        else:
            request = Request(self.address, variable, register.address, 2)
        async with self.calls() as calls:
            old = await calls.get(register) if request.opcode in GETS_BACK else None
            await calls.do(request)
            value = await calls.get(register)
        if old is not None:
            bits = to_raw(old, register.width), to_raw(value, register.width)
            self._tell(register_changed(register, *bits, self.port.last_exchange_s))
        return self._reading(register, value)

    def _request(self, register: Register, value: int) -> Request:
        return writing(self.address, register, value)


async def _value_or_none(calls: Calls, register: Register) -> int | None:
    try:
        return await calls.get(register)
    except UnknownParameter:
        return None
