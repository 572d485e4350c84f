"""What parameters of standard meaning mean for soft limits. Addresses are `limit_address`; commands count as the
parameters that they write: MVP as the target, ROR, ROL and MST as the target speed.

A limit of speed or acceleration is one of the module's own numbers, for nobody here knows what they count in.
Parameters without a standard meaning are not judged.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from ...errors import WrongState
from ...links.tmcl import FRAME_BYTES, VALUE_MAX, Request
from ...registers.model import Register
from ...registers.tmcl.commands import Opcode, Status
from ..core.axis_limits import AxisLimits
from ..core.limit_rules.quantities import Motion, PositionRegister, Quantity, QuantityKind, View, sign
from ..core.limit_rules.rules import AxisReading, Rules
from ..core.session import Session
from ..core.tmcl_frames import WIDE_SHIFT
from ..core.tmcl_link import TmclLink
from .ongoing import ListedMotions
from .state import ListedState, limit_address

ABS, START = 0, 0


class ListedRules(Rules):
    """By the parts of the driver that know the standard parameters, how to ask for them, and what drives an axis."""

    def __init__(
        self,
        session: Session,
        state: ListedState,
        link: TmclLink,
        motions: ListedMotions,
        limits: Sequence[AxisLimits],
        clock_hz: float,
    ) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._motions = motions
        super().__init__(limits, clock_hz)

    # --- the table ------------------------------------------------------------------------------

    def quantities_of(self, axis: int) -> Iterable[Quantity]:
        rows = self._state.axes[axis]
        yield _quantity("velocity", rows.max_speed)
        yield _quantity("velocity", rows.target_speed, at_start=False)
        yield _quantity("acceleration", rows.max_acceleration)

    def positions_of(self, axis: int) -> Iterable[PositionRegister]:
        rows = self._state.axes[axis]
        for row in (rows.target_position, rows.position):
            yield PositionRegister(row.name, _address(row), _decoded(row))

    def sources_of(self, axis: int) -> Iterable[int]:
        return (_address(row) for row in self._state.axes[axis].moving)

    def motion(self, axis: int, view: View, address: int | None = None) -> Motion | None:
        rows, driven = self._state.axes[axis], self._motions.axes[axis].driven
        if address is None or address == _address(rows.position):
            if address is not None and driven != "position":
                return None  # of the counter: it counts on, and nothing drives anywhere by it
            address = _address(rows.target_position if driven == "position" else rows.target_speed)
            if driven not in ("position", "velocity"):
                return None
        if address == _address(rows.target_position):
            used = tuple(one for one in self.quantities[axis] if one.at_start)
            return Motion(used, positioning=True, target=view(address), counter=view(_address(rows.position)))
        speed = view(address)
        turning = tuple(one for one in self.quantities[axis] if one.kind == "acceleration")
        way = 0 if speed is None else sign(speed)
        return Motion(turning, positioning=False, way=way) if speed != 0 else None

    def motion_before(self, axis: int, view: View, address: int) -> Motion | None:
        return None  # every command sets the axis off anew

    # --- frames ---------------------------------------------------------------------------------

    def writes(self, frame: bytes) -> Sequence[tuple[int, int]]:
        if len(frame) != FRAME_BYTES or frame[0] != self._link.address:
            return ()
        request = Request.decode(frame)
        if request.opcode == Opcode.SAP:
            axis, number = request.motor & (1 << WIDE_SHIFT) - 1, request.type | request.motor >> WIDE_SHIFT << 8
            return ((limit_address(axis, number), request.value),)
        if request.motor >= len(self._state.axes):
            return ()
        rows = self._state.axes[request.motor]
        match request.opcode:
            case Opcode.ROR:
                return ((_address(rows.target_speed), request.value),)
            case Opcode.ROL:
                return ((_address(rows.target_speed), -request.value),)
            case Opcode.MST:
                return ((_address(rows.target_speed), 0),)
            case Opcode.MVP if request.type == ABS:
                return ((_address(rows.target_position), request.value),)
        return ()

    @property
    def tells_more(self) -> bool:
        return True

    def concerns(self, frame: bytes) -> bool:
        if len(frame) != FRAME_BYTES or frame[0] != self._link.address:
            return False
        opcode, type_ = frame[1], frame[2]
        if opcode == Opcode.MVP:
            return type_ != ABS
        return opcode in (Opcode.AAP, Opcode.RSAP) or (opcode == Opcode.RFS and type_ == START)

    def require_told(self, frame: bytes, view: View) -> Sequence[tuple[int, int]] | None:
        if not self.concerns(frame):
            return None
        request = Request.decode(frame)
        limited = range(len(self.limits)) if request.motor >= len(self.limits) else (request.motor,)
        if not any(self.limits[axis].given for axis in limited):
            return None
        raise WrongState(
            f"{Opcode(request.opcode).name} {request.type} does not tell where it leads, and this axis has soft limits",
            "move by MVP ABS, ROR or ROL, and write parameters by SAP",
        )

    def accepted(self, frame: bytes, reply: bytes) -> bool:
        return len(reply) == FRAME_BYTES and reply[2] == Status.OK

    # --- what is known --------------------------------------------------------------------------

    def readable(self, address: int) -> bool:
        return True

    def remembered(self, address: int) -> int | None:
        return self._state.known(address)

    async def learn(self) -> None:
        for axis, limits in enumerate(self.limits):
            if not limits.given:
                continue
            rows = self._state.axes[axis]
            async with self._link.calls() as calls:
                await calls.ask_many((rows.max_speed, rows.max_acceleration, rows.target_speed, rows.target_position))
            await self.read_axis(axis)

    # --- the watch ------------------------------------------------------------------------------

    async def read_axis(self, axis: int) -> AxisReading:
        async with self._link.calls() as calls:
            values = await self._motions.poll(axis, calls)
        going_to = values[2] if self._motions.axes[axis].driven == "position" else None
        return AxisReading(values[0] or 0, float(values[1] or 0), target=going_to)

    def braking(self, axis: int, reading: AxisReading, view: View) -> float | None:
        word = view(_address(self._state.axes[axis].max_acceleration))
        return reading.velocity_pps**2 / (2 * word) if word else None


def _address(row: Register) -> int:
    return limit_address(row.axis or 0, row.address)


def _quantity(kind: QuantityKind, row: Register, *, at_start: bool = True) -> Quantity:
    return Quantity(kind, row.name, _address(row), float, lambda _: 1.0, float(VALUE_MAX), at_start=at_start)


def _decoded(row: Register) -> Callable[[int, View], int]:
    return lambda word, _: row.decode(word)
