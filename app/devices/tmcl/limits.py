"""PD42-1241: what its parameters and commands mean (FM-PD42-1241). Addresses are numbers of axis parameters; commands
count as the parameters that they write: MVP as 0, ROR, ROL and MST as 2, a reference search as a number of its own.

Currents are parts of a full scale that the manual does not state, so `current_full_scale_a` makes amperes of them. What
cannot be told: what a stored program does (its commands are judged while they are downloaded from here), what follows
from the step/direction inputs. AAP takes a value that nobody here knows, and is refused for what is limited.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from ...errors import WrongState
from ...links.tmcl import FRAME_BYTES, Request
from ...registers.model import Register
from ...registers.tmcl.commands import COORDINATES_IN_EEPROM, Opcode, Status
from ..core.axis_limits import AxisLimits
from ..core.limit_rules.quantities import COORDINATES, Motion, PositionRegister, Quantity, View, sign
from ..core.limit_rules.rules import AxisReading, Rules
from ..core.session import Session
from ..core.tmcl_link import TmclLink
from .ongoing import OngoingMotion
from .state import ModuleState
from .units import Unit

SEARCH = 0x200
"""The address of a reference search."""
ABS, REL, COORD = 0, 1, 2
"""Types of MVP."""
START = 0
"""Type of RFS."""
FULL = 255
SCALER_FULL = 256
BY_ACCUMULATOR = frozenset({Opcode.MVPA, Opcode.RORA, Opcode.ROLA})
TELLING = frozenset({Opcode.MVP, Opcode.AAP, Opcode.RSAP, Opcode.RFS}) | BY_ACCUMULATOR


class ModuleRules(Rules):
    """By the parts of the driver that know how the module is set, how to ask it, and what drives its axis."""

    def __init__(
        self,
        session: Session,
        state: ModuleState,
        link: TmclLink,
        ongoing: OngoingMotion,
        limits: Sequence[AxisLimits],
        clock_hz: float,
    ) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._ongoing = ongoing
        self._roles = rows = state.roles
        self._speeds = rows.present(rows.max_speed, rows.vstart, rows.vstop, rows.min_speed)
        self._search_speeds = (rows.search_speed, rows.switch_speed)
        self._accelerations = rows.present(rows.max_acceleration, rows.a1, rows.max_deceleration, rows.d1)
        self._currents = (rows.max_current, rows.standby_current)
        self._below_v1 = tuple(_named(row) for row in rows.present(rows.a1, rows.d1))
        self._looked_at = (rows.target_position, rows.actual_speed, rows.actual_position)
        super().__init__(limits, clock_hz)
        self._limited = {one.address for one in self.quantities[0]} | {one.address for one in self.positions[0]}

    # --- the table ------------------------------------------------------------------------------

    def quantities_of(self, axis: int) -> Iterable[Quantity]:
        mode = frozenset(row.address for row in self._roles.counting)
        most = self._state.scaling.most
        for row in (*self._speeds, self._roles.target_speed, *self._search_speeds):
            yield Quantity(
                "velocity",
                _named(row),
                row.address,
                float,
                self._speed,
                most,
                mode,
                row in self._speeds,
            )
        for row in self._accelerations:
            yield Quantity("acceleration", _named(row), row.address, float, self._acceleration, most, mode)
        full_scale_a = self.limits[axis].current_full_scale_a
        if full_scale_a is not None:
            for row in self._currents:
                yield Quantity(
                    "current",
                    _named(row),
                    row.address,
                    lambda word: word / FULL,
                    self._scaled(full_scale_a),
                    1.0,
                    frozenset(row.address for row in self._roles.present(self._roles.current_scaler)),
                    advice=_current_advice(row.alias),
                )

    def _speed(self, view: View) -> float:
        return self._greatest(self._state.scaling.speed_unit, view)

    def _acceleration(self, view: View) -> float:
        return self._greatest(self._state.scaling.acceleration_unit, view)

    def _greatest(self, unit: Unit, view: View) -> float:
        known = [view(row.address) for row in self._roles.counting]
        return self._state.scaling.greatest(unit, self.clock_hz, known)

    def _scaled(self, full_scale_a: float) -> Callable[[View], float]:
        def full_a(view: View) -> float:
            scaler = view(self._roles.current_scaler.address)
            return full_scale_a * (scaler or SCALER_FULL) / SCALER_FULL  # 0 is full scale, and so is what nobody knows

        return full_a

    @property
    def _counted(self) -> tuple[Register, ...]:
        """What unit mode (AP 255) makes other numbers of."""
        return (*self._speeds, *self._search_speeds, *self._accelerations, self._roles.target_speed)

    def positions_of(self, axis: int) -> Iterable[PositionRegister]:
        for row in (self._roles.target_position, self._roles.actual_position):
            yield PositionRegister(row.name, row.address, lambda word, _: word)

    def sources_of(self, axis: int) -> Iterable[int]:
        return (
            self._roles.target_position.address,
            self._roles.actual_position.address,
            self._roles.target_speed.address,
            SEARCH,
        )

    def motion(self, axis: int, view: View, address: int | None = None) -> Motion | None:
        if address is None or address == self._roles.actual_position.address:
            driven = self._ongoing.driven
            if driven is None or (address is not None and driven != "position"):
                return None  # of the counter: it counts on, and nothing drives anywhere by it
            kinds = {
                "position": self._roles.target_position.address,
                "velocity": self._roles.target_speed.address,
                "search": SEARCH,
            }
            address = kinds.get(driven)
        by_v1 = view(self._roles.v1.address) != 0
        names = {one.name for one in self.quantities[0] if one.at_start and (by_v1 or one.name not in self._below_v1)}
        if address == self._roles.target_position.address:
            return Motion(self._quantities(names), positioning=True, target=view(address), counter=view(1))
        turning = {_named(row) for row in (self._roles.max_acceleration,)}
        currents = {one.name for one in self.quantities[0] if one.kind == "current"}
        if address == self._roles.target_speed.address:
            speed = view(address)
            way = 0 if speed is None else sign(speed)
            return Motion(self._quantities(turning | currents), positioning=False, way=way) if speed != 0 else None
        searching = {_named(row) for row in self._search_speeds}
        return Motion(self._quantities(names | searching), positioning=False)

    def motion_before(self, axis: int, view: View, address: int) -> Motion | None:
        return None  # every command sets the axis off anew

    def _quantities(self, names: set[str]) -> tuple[Quantity, ...]:
        return tuple(one for one in self.quantities[0] if one.name in names)

    # --- frames ---------------------------------------------------------------------------------

    def writes(self, frame: bytes) -> Sequence[tuple[int, int]]:
        if len(frame) != FRAME_BYTES or frame[0] != self._link.address:
            return ()
        match frame[1]:
            case Opcode.GAP | Opcode.GGP:  # most of what is sent
                return ()
            case Opcode.SAP if frame[3] == 0:
                return ((frame[2], _value(frame)),)
            case Opcode.ROR:
                return ((self._roles.target_speed.address, _value(frame)),)
            case Opcode.ROL:
                return ((self._roles.target_speed.address, -_value(frame)),)
            case Opcode.MST:
                return ((self._roles.target_speed.address, 0),)
            case Opcode.MVP if frame[2] == ABS:
                return ((self._roles.target_position.address, _value(frame)),)
            case Opcode.SCO if frame[3] != COORDINATES_IN_EEPROM:
                return ((COORDINATES + frame[2], _value(frame)),)
        return ()

    @property
    def tells_more(self) -> bool:
        return True

    def concerns(self, frame: bytes) -> bool:
        if len(frame) != FRAME_BYTES or frame[0] != self._link.address:
            return False
        return frame[1] in TELLING or (frame[1] == Opcode.SAP and frame[2] == self._roles.ramp_mode.address)

    def require_told(self, frame: bytes, view: View) -> Sequence[tuple[int, int]] | None:
        if not self.concerns(frame):
            return None
        request = Request.decode(frame)
        if request.opcode == Opcode.RFS:
            return ((SEARCH, 0),) if request.type == START else ()
        if request.opcode == Opcode.SAP:
            raise WrongState(
                f"SAP {request.type} sets off for the latest target or speed, and nobody here judges that",
                "this axis has soft limits: use MVP, ROR or ROL",
            )
        if request.opcode in BY_ACCUMULATOR:
            raise WrongState(
                f"{Opcode(request.opcode).name} goes by the accumulator, and nobody here knows that",
                "this axis has soft limits: use MVP, ROR or ROL",
            )
        if request.opcode in (Opcode.AAP, Opcode.RSAP):
            if request.type in self._limited:
                source = "the accumulator" if request.opcode == Opcode.AAP else "what the EEPROM holds"
                raise WrongState(
                    f"{Opcode(request.opcode).name} {request.type} writes {source}, and nobody here knows that",
                    "this parameter has a soft limit: write it by SAP",
                )
            return ()
        if request.type == REL:
            return self._relative(request.value, view)
        if request.type == COORD:
            return self._coordinate(request.value, view)
        return None

    def _relative(self, distance: int, view: View) -> Sequence[tuple[int, int]]:
        """MVP REL counts from the last target or from the position (AP 127): both ends have to be inside."""
        target, position = view(self._roles.target_position.address), view(self._roles.actual_position.address)
        if not self.limits[0].ranged:
            return ((self._roles.target_position.address, distance),)
        if target is None or position is None:
            raise WrongState("nobody knows where MVP REL would count from", "move by MVP ABS")
        return tuple((self._roles.target_position.address, start + distance) for start in (target, position))

    def _coordinate(self, number: int, view: View) -> Sequence[tuple[int, int]]:
        position = view(COORDINATES + (number & 0xFF))
        if position is None and self.limits[0].ranged:
            raise WrongState(f"nobody knows coordinate {number & 0xFF}", "read it (GCO) or write it (SCO) first")
        return ((self._roles.target_position.address, position or 0),)

    def accepted(self, frame: bytes, reply: bytes) -> bool:
        return len(reply) == FRAME_BYTES and reply[2] == Status.OK  # stored in a program is not done

    def forgotten(self, frame: bytes) -> Iterable[int]:
        if len(frame) != FRAME_BYTES or frame[0] != self._link.address:
            return ()
        match frame[1]:
            case Opcode.MVP if frame[2] != ABS:
                return (self._roles.target_position.address,)
            case Opcode.CCO | Opcode.ACO:
                return (COORDINATES + frame[2],)
            case Opcode.GCO if frame[3] == COORDINATES_IN_EEPROM:
                return tuple(range(COORDINATES, COORDINATES + 256))
            case Opcode.AAP | Opcode.RSAP:
                return (frame[2],)
            case Opcode.SAP if frame[2] == self._roles.unit_mode.address:
                # What the driver remembers counts in the old unit too.
                self._state.forget(row.address for row in self._counted)
                return tuple(row.address for row in self._counted)
        return ()

    # --- what is known --------------------------------------------------------------------------

    def readable(self, address: int) -> bool:
        return address < SEARCH

    def remembered(self, address: int) -> int | None:
        return self._state.known.get(address)

    async def learn(self) -> None:
        if not self.limits[0].given:
            return
        rows = self._roles
        decisive = [*rows.counting, *self._counted, rows.v1, rows.target_position]
        currents = [*self._currents, rows.current_scaler]
        async with self._link.calls() as calls:
            await calls.ask_many((*decisive, *currents))
        await self.read_axis(0)

    async def learn_for(self, command: int, type_: int, value: int) -> None:
        if command != Opcode.MVP or not self.limits[0].ranged:
            return
        async with self._link.calls() as calls:
            if type_ == REL:
                await calls.ask_many((self._roles.target_position, self._roles.actual_position))
            elif type_ == COORD and (row := self._roles.coordinate(value & 0xFF)) is not None:
                await calls.get(row)

    # --- the watch ------------------------------------------------------------------------------

    async def read_axis(self, axis: int) -> AxisReading:
        async with self._link.calls() as calls:
            asked_s = self._session.device_time_s()
            target, told_speed, told_position = await calls.ask_many(self._looked_at)
            speed = calls.need(self._roles.actual_speed, told_speed)
            position = calls.need(self._roles.actual_position, told_position)
        self._session.saw_position(axis, position, asked_s)
        going_to = target if self._ongoing.driven == "position" else None
        return AxisReading(position, speed * self._state.speed_unit_pps, target=going_to)

    def braking(self, axis: int, reading: AxisReading, view: View) -> float | None:
        word = view(self._roles.max_acceleration.address)
        if not word:
            return None
        return reading.velocity_pps**2 / (2 * word * self._state.acceleration_unit_pps2)


def _named(row: Register) -> str:
    return f"{row.name} ({row.alias})"


def _value(frame: bytes) -> int:
    return int.from_bytes(frame[4:8], "big", signed=True)


def _current_advice(alias: str) -> Callable[[float], str]:
    return lambda share: f"write {alias} {int(share * FULL)} or less"
