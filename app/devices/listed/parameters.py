"""Reading and writing a module's parameters by name: every write is read back, and one that may move is sent once."""

from __future__ import annotations

from collections.abc import Collection, Sequence

from ...errors import (
    BadReply,
    BenchError,
    LinkError,
    LinkTimeout,
    OutOfRange,
    UsageError,
    WriteRefused,
    WrongState,
)
from ...registers.model import Register, Space, to_raw
from ..core.capabilities import Registers
from ..core.changes import DONE, outcome_of, outcome_of_failure, register_changed
from ..core.lookup import number_of
from ..core.results import RegisterReading, RegisterWritten, WriteItem
from ..core.session import Session
from ..core.tmcl_calls import Calls
from ..core.tmcl_frames import writing
from ..core.tmcl_link import TmclLink
from .ongoing import ListedMotions
from .state import ListedState, limit_address

ADDRESS, SUPPRESS_REPLY = 66, 255
"""Global parameters of bank 0 whose write changes how every module answers."""


class ListedParameters(Registers):
    """Axis parameters and global parameters, by their names in the package."""

    def __init__(self, session: Session, state: ListedState, link: TmclLink, motions: ListedMotions) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._motions = motions

    # --- reading --------------------------------------------------------------------------------

    async def read(self, name: str, axis: int | None = None) -> RegisterReading:
        register, _ = self._state.find(name, axis)
        self._session.require_connected()
        async with self._link.calls() as calls:
            return _reading(register, await calls.get(register))

    def clears_when_read(self, name: str, axis: int | None = None) -> bool:
        return self._state.find(name, axis)[0].read_clears

    async def read_all(self, axis: int | None = None, groups: Collection[str] = ()) -> list[RegisterReading]:
        """Every parameter but those that a read may clear, and those that this firmware does not have."""
        if axis is not None:
            self._session.axis(axis)
        self._session.require_connected()
        wanted = [
            row
            for row in self._state.table
            if not row.read_clears and (axis is None or row.axis == axis) and (not groups or row.group in groups)
        ]
        found: list[RegisterReading] = []
        for chunk in self._link.shares(wanted):
            async with self._link.calls() as calls:
                values = await calls.ask_many(chunk)
            found += [_reading(row, value) for row, value in zip(chunk, values, strict=True) if value is not None]
        return found

    # --- writing --------------------------------------------------------------------------------

    async def write(
        self,
        name: str,
        axis: int | None = None,
        value: int | None = None,
        fields: dict[str, int | str] | None = None,
    ) -> RegisterWritten:
        register, _ = self._state.find(name, axis)
        if fields is not None or value is None:
            raise UsageError(f"{register.name} is written as a whole: give a value")
        if not register.access.writable:
            raise WrongState(f"{register.name} ({register.alias}) is read only")
        value = number_of(register, value)
        if not register.minimum <= value <= register.maximum:
            raise OutOfRange(register.name, value, register.minimum, register.maximum)
        if (register.space, register.address) == (Space.GLOBAL_0, SUPPRESS_REPLY) and value:
            raise WrongState(
                "without answers nobody can tell whether a command arrived", "send SGP 255, 0, 1 from the console"
            )
        self._session.require_connected()
        async with self._link.calls(register.axis) as calls:
            old = await calls.before(register)
            try:
                written = await (self._move if self._state.moves(register) else self._put)(calls, register, value)
            except BenchError as error:
                self._tell(register, old, value, outcome_of_failure(error))
                raise
        if written.verified:
            self._state.took(register)
        self._tell(register, old, value, outcome_of(written.verified, written.note))
        return written

    async def check_writes(self, items: Sequence[WriteItem]) -> None:
        limiter = self._session.limiter
        if limiter is None:
            return
        found = []
        for item in items:
            register, _ = self._state.find(item.name, item.axis)
            if register.axis is not None and item.value is not None:
                address = limit_address(register.axis, register.address)
                if limiter.affects_limits(address):
                    found.append((address, item.value))
        limiter.check_writes(found)

    async def _move(self, calls: Calls, register: Register, value: int) -> RegisterWritten:
        """Write what may set an axis in motion: once, whatever comes of it."""
        assert register.axis is not None  # only such a row is said to move one
        request = writing(self._link.address, register, value)
        self._link.check_limits(request)
        self._session.commanded(register.axis, register.name)
        try:
            await calls.move(request, f"writing {register.name}", register)
        except LinkError:
            self._motions.mark_unknown(register.axis)
            raise
        self._motions.written(register, value, calls.time_s)
        return _written(register, value, await calls.get(register))

    async def _put(self, calls: Calls, register: Register, value: int) -> RegisterWritten:
        lost: BenchError | None = None
        try:
            await calls.put(register, value)
        except (BadReply, LinkTimeout) as error:
            lost = error  # it may have been done all the same, and reading it back moves nothing
        moved = (register.space, register.address) == (Space.GLOBAL_0, ADDRESS) and value != self._link.address
        if moved:
            calls.address = value
        if register.read_clears:
            if lost is not None:
                raise lost
            return _written(register, value, value, None, "not read back: reading it may clear it")
        try:
            back = await calls.get(register)
        except BenchError as error:
            if moved and lost is None:
                return _written(register, value, value, None, "it is not at that address yet: after its next power-on")
            raise lost or error from error
        if moved:
            note = f"the module answers at address {value} now: change the address of this connection"
            return _written(register, value, back, True, note)
        if lost is not None and back != value:
            raise lost
        return _written(register, value, back)

    def _tell(self, register: Register, old: int | None, new: int, outcome: str | None) -> None:
        if outcome is not None:
            bits = None if old is None else to_raw(old, register.width)
            at_s = self._session.port.last_exchange_s
            self._session.tell(register_changed(register, bits, to_raw(new, register.width), at_s, outcome or DONE))


def _reading(register: Register, value: int) -> RegisterReading:
    raw = to_raw(value, register.width)
    return RegisterReading(register.name, register.address, register.axis, raw, value, {}, "", register.space)


def _written(
    register: Register, value: int, back: int, verified: bool | None = True, note: str = ""
) -> RegisterWritten:
    """Raises WriteRefused where `back` is another value, and nobody knows that the module changes it by itself."""
    if verified and back != value and not note:
        if not register.volatile:
            why = "the module answered that it did it: it may be read only, or take fewer values than 32 bits hold"
            raise WriteRefused(register.name, to_raw(value, register.width), to_raw(back, register.width), why)
        verified, note = None, f"the module changes it by itself; it is {back} now"
    return RegisterWritten(
        register.name,
        register.address,
        register.axis,
        to_raw(back, register.width),
        back,
        {},
        "",
        register.space,
        written=to_raw(value, register.width),
        verified=verified,
        note=note,
    )
