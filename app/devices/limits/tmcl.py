"""PD42-1241: what its parameters and commands mean (FM-PD42-1241). Addresses are numbers of axis parameters; commands
count as the parameters that they write: MVP as 0, ROR, ROL and MST as 2, a reference search as a number of its own.

Currents are parts of a full scale that the manual does not state, so `current_full_scale_a` makes amperes of them. What
cannot be told: what a stored program does (its commands are judged while they are downloaded from here), what follows
from the step/direction inputs. AAP takes a value that nobody here knows, and is refused for what is limited.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from typing import TYPE_CHECKING

from ...errors import WrongState
from ...links.tmcl import FRAME_BYTES, Request
from ...registers.tmcl.commands import COORDINATES_IN_EEPROM, Opcode, Status
from ..tmcl import rows, units
from .axis_limits import AxisLimits
from .parts import COORDINATES, Going, Part, Place, View, sign
from .rules import Look, Rules

if TYPE_CHECKING:
    from ..tmcl.motion import Motion

SEARCH = 0x200
"""The address of a reference search."""
ABS, REL, COORD = 0, 1, 2
"""Types of MVP."""
START = 0
"""Type of RFS."""
RUN_CURRENT, HOLD_CURRENT, SCALER = 6, 7, 178
FULL = 255
SCALER_FULL = 256
SPEEDS = (rows.MAX_SPEED, rows.VSTART, rows.VSTOP)
SEARCH_SPEEDS = (rows.SEARCH_SPEED, rows.SWITCH_SPEED)
ACCELERATIONS = (rows.MAX_ACCELERATION, rows.A1, rows.MAX_DECELERATION, rows.D1)
BELOW_V1 = frozenset({rows.A1.name, rows.D1.name})
COUNTED = (*SPEEDS, *SEARCH_SPEEDS, *ACCELERATIONS, rows.TARGET_SPEED)
"""What unit mode (AP 255) makes other numbers of."""
TELLING = frozenset({Opcode.MVP, Opcode.AAP, Opcode.RFS})
LOOKED_AT = (rows.TARGET_POSITION, rows.ACTUAL_SPEED, rows.ACTUAL_POSITION)


class ModuleRules(Rules):
    """`module` is the driver."""

    def __init__(self, module: Motion, limits: Sequence[AxisLimits], clock_hz: float) -> None:
        self._module = module
        super().__init__(limits, clock_hz)
        self._limited = {part.address for part in self.parts[0]} | {place.address for place in self.places[0]}

    # --- the table ------------------------------------------------------------------------------

    def parts_of(self, axis: int) -> Iterable[Part]:
        mode = frozenset({rows.UNIT_MODE.address})
        for row in (*SPEEDS, rows.TARGET_SPEED, *SEARCH_SPEEDS):
            yield Part(
                "velocity", _named(row.name, row.alias), row.address, float, self._speed, 8e6, mode, row in SPEEDS
            )
        for row in ACCELERATIONS:
            yield Part("acceleration", _named(row.name, row.alias), row.address, float, self._acceleration, 8e6, mode)
        full_scale_a = self.limits[axis].current_full_scale_a
        if full_scale_a is not None:
            for number in (RUN_CURRENT, HOLD_CURRENT):
                row = rows.axis_parameter(number)
                yield Part(
                    "current",
                    _named(row.name, row.alias),
                    number,
                    lambda word: word / FULL,
                    _scaled(full_scale_a),
                    1.0,
                    frozenset({SCALER}),
                    advice=_current_advice(row.alias),
                )

    def _speed(self, view: View) -> float:
        mode = view(rows.UNIT_MODE.address)
        known = (0, 1) if mode is None else (mode,)
        return max(units.speed_unit_pps(self.clock_hz, each) for each in known)

    def _acceleration(self, view: View) -> float:
        mode = view(rows.UNIT_MODE.address)
        known = (0, 1) if mode is None else (mode,)
        return max(units.acceleration_unit_pps2(self.clock_hz, each) for each in known)

    def places_of(self, axis: int) -> Iterable[Place]:
        for row in (rows.TARGET_POSITION, rows.ACTUAL_POSITION):
            yield Place(row.name, row.address, lambda word, _: word)

    def sources_of(self, axis: int) -> Iterable[int]:
        return (rows.TARGET_POSITION.address, rows.ACTUAL_POSITION.address, rows.TARGET_SPEED.address, SEARCH)

    def going(self, axis: int, view: View, address: int | None = None) -> Going | None:
        if address is None or address == rows.ACTUAL_POSITION.address:
            driven = self._module.driven
            if driven is None or (address is not None and driven != "position"):
                return None  # of the counter: it counts on, and nothing drives anywhere by it
            kinds = {"position": rows.TARGET_POSITION.address, "velocity": rows.TARGET_SPEED.address, "search": SEARCH}
            address = kinds.get(driven)
        by_v1 = view(rows.V1.address) != 0
        names = {part.name for part in self.parts[0] if part.at_start and (by_v1 or not part.name.startswith(_BELOW))}
        if address == rows.TARGET_POSITION.address:
            return Going(self._parts(names), positioning=True, target=view(address), counter=view(1))
        turning = {_named(row.name, row.alias) for row in (rows.MAX_ACCELERATION,)}
        currents = {part.name for part in self.parts[0] if part.quantity == "current"}
        if address == rows.TARGET_SPEED.address:
            speed = view(address)
            way = 0 if speed is None else sign(speed)
            return Going(self._parts(turning | currents), positioning=False, way=way) if speed != 0 else None
        searching = {_named(row.name, row.alias) for row in SEARCH_SPEEDS}
        return Going(self._parts(names | searching), positioning=False)

    def going_before(self, axis: int, view: View, address: int) -> Going | None:
        return None  # every command sets the axis off anew

    def _parts(self, names: set[str]) -> tuple[Part, ...]:
        return tuple(part for part in self.parts[0] if part.name in names)

    # --- frames ---------------------------------------------------------------------------------

    def writes(self, frame: bytes) -> Sequence[tuple[int, int]]:
        if len(frame) != FRAME_BYTES or frame[0] != self._module.address:
            return ()
        match frame[1]:
            case Opcode.GAP | Opcode.GGP:  # most of what is sent
                return ()
            case Opcode.SAP if frame[3] == 0:
                return ((frame[2], _value(frame)),)
            case Opcode.ROR:
                return ((rows.TARGET_SPEED.address, _value(frame)),)
            case Opcode.ROL:
                return ((rows.TARGET_SPEED.address, -_value(frame)),)
            case Opcode.MST:
                return ((rows.TARGET_SPEED.address, 0),)
            case Opcode.MVP if frame[2] == ABS:
                return ((rows.TARGET_POSITION.address, _value(frame)),)
            case Opcode.SCO if frame[3] != COORDINATES_IN_EEPROM:
                return ((COORDINATES + frame[2], _value(frame)),)
        return ()

    @property
    def tells_more(self) -> bool:
        return True

    def concerns(self, frame: bytes) -> bool:
        return len(frame) == FRAME_BYTES and frame[1] in TELLING and frame[0] == self._module.address

    def require_told(self, frame: bytes, view: View) -> Sequence[tuple[int, int]] | None:
        if not self.concerns(frame):
            return None
        request = Request.decode(frame)
        if request.opcode == Opcode.RFS:
            return ((SEARCH, 0),) if request.type == START else ()
        if request.opcode == Opcode.AAP:
            if request.type in self._limited:
                raise WrongState(
                    f"AAP {request.type} writes the accumulator, and nobody here knows what it holds",
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
        target, position = view(rows.TARGET_POSITION.address), view(rows.ACTUAL_POSITION.address)
        if not self.limits[0].ranged:
            return ((rows.TARGET_POSITION.address, distance),)
        if target is None or position is None:
            raise WrongState("nobody knows where MVP REL would count from", "move by MVP ABS")
        return tuple((rows.TARGET_POSITION.address, start + distance) for start in (target, position))

    def _coordinate(self, number: int, view: View) -> Sequence[tuple[int, int]]:
        position = view(COORDINATES + (number & 0xFF))
        if position is None and self.limits[0].ranged:
            raise WrongState(f"nobody knows coordinate {number & 0xFF}", "read it (GCO) or write it (SCO) first")
        return ((rows.TARGET_POSITION.address, position or 0),)

    def accepted(self, frame: bytes, reply: bytes) -> bool:
        return len(reply) == FRAME_BYTES and reply[2] == Status.OK  # stored in a program is not done

    def forgotten(self, frame: bytes) -> Iterable[int]:
        if len(frame) != FRAME_BYTES or frame[0] != self._module.address:
            return ()
        match frame[1]:
            case Opcode.MVP if frame[2] != ABS:
                return (rows.TARGET_POSITION.address,)
            case Opcode.CCO | Opcode.ACO:
                return (COORDINATES + frame[2],)
            case Opcode.GCO if frame[3] == COORDINATES_IN_EEPROM:
                return tuple(range(COORDINATES, COORDINATES + 256))
            case Opcode.AAP:
                return (frame[2],)
            case Opcode.SAP if frame[2] == rows.UNIT_MODE.address:
                # What the driver remembers counts in the old unit too.
                self._module.forget_parameters(row.address for row in COUNTED)
                return tuple(row.address for row in COUNTED)
        return ()

    # --- what is known --------------------------------------------------------------------------

    def readable(self, address: int) -> bool:
        return address < SEARCH

    def remembered(self, address: int) -> int | None:
        return self._module.remembered_word(address)

    async def learn(self) -> None:
        if not self.limits[0].given:
            return
        decisive = [rows.UNIT_MODE, *COUNTED, rows.V1, rows.TARGET_POSITION]
        currents = [rows.axis_parameter(number) for number in (RUN_CURRENT, HOLD_CURRENT, SCALER)]
        async with self._module.calls() as calls:
            await calls.ask_many((*decisive, *currents))
        await self.look(0)

    async def learn_for(self, command: int, type_: int, value: int) -> None:
        if command != Opcode.MVP or not self.limits[0].ranged:
            return
        async with self._module.calls() as calls:
            if type_ == REL:
                await calls.ask_many((rows.TARGET_POSITION, rows.ACTUAL_POSITION))
            elif type_ == COORD and (row := rows.coordinate(value & 0xFF)) is not None:
                await calls.get(row)

    # --- the watch ------------------------------------------------------------------------------

    async def look(self, axis: int) -> Look:
        module = self._module
        async with module.calls() as calls:
            asked_s = module.device_time_s()
            target, told_speed, told_position = await calls.ask_many(LOOKED_AT)
            speed = calls.need(rows.ACTUAL_SPEED, told_speed)
            position = calls.need(rows.ACTUAL_POSITION, told_position)
        module.saw_position(axis, position, asked_s)
        going_to = target if module.driven == "position" else None
        return Look(position, speed * module.speed_unit_pps, target=going_to)

    def braking(self, axis: int, look: Look, view: View) -> float | None:
        word = view(rows.MAX_ACCELERATION.address)
        if not word:
            return None
        return look.velocity_pps**2 / (2 * word * self._module.acceleration_unit_pps2)


_BELOW = tuple(sorted(BELOW_V1))


def _named(name: str, alias: str) -> str:
    return f"{name} ({alias})"


def _value(frame: bytes) -> int:
    return int.from_bytes(frame[4:8], "big", signed=True)


def _scaled(full_scale_a: float) -> Callable[[View], float]:
    def full_a(view: View) -> float:
        scaler = view(SCALER)
        return full_scale_a * (scaler or SCALER_FULL) / SCALER_FULL  # 0 is full scale, and so is what nobody knows

    return full_a


def _current_advice(alias: str) -> Callable[[float], str]:
    return lambda share: f"write {alias} {int(share * FULL)} or less"
