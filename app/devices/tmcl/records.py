"""What was read and written, as records and events: each write with what was there before and what came of it."""

from __future__ import annotations

from ...errors import BenchError, WriteRefused
from ...registers.model import Register, to_raw
from ..core.changes import DONE, outcome_of, outcome_of_failure, register_changed
from ..core.results import RegisterReading, RegisterWritten
from ..core.session import Session
from ..core.tmcl_refusals import limits, unit_of
from . import units
from .state import ModuleState


class Records:
    """Makes records of values, and judges what is read back, as the module is set."""

    def __init__(self, session: Session, state: ModuleState) -> None:
        self._session = session
        self._state = state

    def reading(self, register: Register, value: int) -> RegisterReading:
        """One that was read."""
        raw = to_raw(value, register.width) & register.mask
        return RegisterReading(
            register.name,
            register.address,
            register.axis,
            raw,
            value,
            register.unpack(raw) if register.fields else {},
            unit_of(register, self._state.unit_mode),
            register.space,
        )

    def written(self, register: Register, value: int, back: int, verified: bool | None, note: str) -> RegisterWritten:
        """`value` was written, and `back` read back."""
        reading = self.reading(register, back)
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

    def judge(self, register: Register, value: int, back: int) -> tuple[bool | None, str]:
        """Whether the module took `value`, and what to know about it. Raises WriteRefused."""
        if back == value:
            return True, register.write_note
        unit = unit_of(register, self._state.unit_mode)
        if register.volatile:
            return None, f"the module changes it by itself; it is {back} now"
        slack = units.read_back_tolerance(unit, value, self._session.clock_hz, self._state.microsteps)
        if abs(back - value) <= slack:
            return True, f"held as {back} {unit}: whole units of the driver chip"
        low, high = limits(register, self._state.unit_mode)
        if back in (low, high) or (0 < abs(back) < abs(value) and back * value > 0):
            return False, f"the module took it as {back}: clipped"
        why = register.write_note or "the module answered that it did it; read it again, or write another value"
        raise WriteRefused(register.name, value & register.mask, back & register.mask, why)

    def tell(self, register: Register, old: int | None, value: int, came: RegisterWritten | BenchError) -> None:
        """Tell of a write, and of what came of it."""
        if isinstance(came, BenchError):
            outcome = outcome_of_failure(came)
        elif came.verified is False:  # it took another value, and says so
            outcome, value = f"{DONE}: {came.note}", came.value
        else:
            outcome = outcome_of(came.verified, came.note)
        if outcome is not None:
            self.tell_change(register, old, value, outcome)

    def tell_change(self, register: Register, old: int | None, new: int, outcome: str = DONE) -> None:
        """`register` was `old`, or nobody knows what, and came to be `new`."""
        bits = None if old is None else to_raw(old, register.width)
        at_s = self._session.port.last_exchange_s
        self._session.tell(register_changed(register, bits, to_raw(new, register.width), at_s, outcome))
