"""Which registers of a table are a ramp generator, by their names: mode, target, position, speeds, acceleration.

Several families of chips have one of this kind, and mean the same by the names (DS-TMC5160 14): mode 0 goes to the
target, 1 and 2 turn forwards and backwards at VMAX, 3 keeps the speed. A mode of another width means something else,
and then there is no ramp generator that anybody here could drive. A table may also say of a register or field what it
is (`Bits.role`), whatever it is called.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import Literal

from ..model import Field, Register

Role = Literal["mode", "target", "position", "speed", "max_speed", "acceleration", "deceleration", "status"]
NAMES: Mapping[str, Role] = {
    "rampmode": "mode",
    "xtarget": "target",
    "xactual": "position",
    "vactual": "speed",
    "vmax": "max_speed",
    "amax": "acceleration",
    "dmax": "deceleration",
}
NEEDED = frozenset(NAMES.values()) - {"deceleration"}
TOLD: Mapping[str, Role] = {
    "mode": "mode",
    "target": "target",
    "position": "position",
    "velocity": "speed",
    "max_velocity": "max_speed",
    "acceleration": "acceleration",
    "deceleration": "deceleration",
    "status": "status",
}
"""What a table may say that a register is. A field may be the mode."""
MEANINGS: Mapping[Role, str] = {
    "mode": "0 goes to the target, 1 and 2 turn forwards and backwards at the greatest speed, 3 keeps the speed",
    "target": "where a positioning goes",
    "position": "the position counter",
    "speed": "the speed now",
    "max_speed": "the greatest speed of a positioning, and the speed of a rotation",
    "acceleration": "the acceleration",
    "deceleration": "the deceleration",
    "status": "its single bits are the flags of the axis",
}
POSITION, FORWARD, BACKWARD, HOLD = 0, 1, 2, 3
MODE_BITS = 2
_NAME = re.compile(
    r"^(?P<before>\w+_)?(?P<role>rampmode|xtarget|xactual|vactual|vmax|amax|dmax)(?:_m(?P<nth>[1-9]))?$", re.IGNORECASE
)
_AXIS = re.compile(r"(?:^|_)m(?P<axis>\d)_$", re.IGNORECASE)


@dataclass(frozen=True, slots=True)
class Mode:
    """Where the ramp mode is: a register, or a field of one that other axes have fields of too."""

    register: Register
    field: Field | None = None

    def unpack(self, word: int) -> int:
        """The mode out of a word of the register."""
        return self.register.decode(word) if self.field is None else self.field.unpack(word)

    def pack(self, mode: int, over: int) -> int:
        """A word of the register with this mode, the rest as in `over`."""
        return mode if self.field is None else self.field.pack(mode, over & self.register.write_mask)


@dataclass(frozen=True, slots=True)
class Ramp:
    """The ramp generator of one axis."""

    axis: int
    mode: Mode
    target: Register
    position: Register
    speed: Register
    max_speed: Register
    acceleration: Register
    deceleration: Register | None = None
    status: Register | None = None
    """Of which the single bits are flags."""

    @property
    def moving(self) -> tuple[Register, ...]:
        """Registers a write to which may set the axis in motion."""
        return self.mode.register, self.target, self.position, self.max_speed, self.acceleration


def ramps_of(rows: Iterable[Register]) -> tuple[Ramp, ...]:
    """The ramp generators that these names tell; none where a role is missing, or has two registers."""
    found: dict[int, dict[Role, list[tuple[Register, Field | None]]]] = {}
    told: set[tuple[int, Role]] = set()
    for row in rows:
        if row.when:
            continue
        for part in (None, *row.fields):
            role, axis = _role(row, part)
            if role is None or not (part is None or role == "mode"):
                continue
            places, says = found.setdefault(axis, {}), bool((part or row).role)
            if says and (axis, role) not in told:  # then whatever else is called so is something else
                places[role] = []
                told.add((axis, role))
            if says or (axis, role) not in told:
                places.setdefault(role, []).append((row, part))
    ramps = [ramp for axis in sorted(found) if (ramp := _ramp(axis, found[axis])) is not None]
    return tuple(ramps) if [ramp.axis for ramp in ramps] == list(range(len(ramps))) else ()


def role_by_name(row: Register) -> Role | None:
    """What the name of a register says that it is to a ramp generator; None of most."""
    named = [role for part in (None, *row.fields) if (role := _role(row, part)[0]) is not None]
    return named[0] if named else None


def _role(row: Register, part: Field | None) -> tuple[Role | None, int]:
    if (part or row).role:
        return TOLD[(part or row).role], row.axis or 0
    name = _NAME.match(row.name if part is None else part.name)
    if name is None:
        return None, 0
    numbered = _AXIS.search(name["before"] or "")
    axis = int(name["nth"]) - 1 if name["nth"] else int(numbered["axis"]) if numbered else row.axis or 0
    return NAMES[name["role"].casefold()], axis


def _ramp(axis: int, places: Mapping[Role, list[tuple[Register, Field | None]]]) -> Ramp | None:
    """None where it is not unambiguous."""
    if not places.keys() >= NEEDED:
        return None
    fitting = [Mode(row, part) for row, part in places["mode"] if (part or row).width == MODE_BITS]
    # A register with the one field that it is named after is one place, not two.
    modes = list({(mode.register.address, mode.field.lsb if mode.field else 0): mode for mode in fitting}.values())
    single: dict[Role, Register] = {}
    for role, rows in places.items():
        if role != "mode":
            if len(rows) != 1:
                return None
            single[role] = rows[0][0]
    read = [single["target"], single["position"], single["speed"]]
    written = [single["target"], single["max_speed"], single["acceleration"]]
    if len(modes) != 1 or not all(row.access.readable for row in (modes[0].register, *read)):
        return None
    if not all(row.access.writable for row in (modes[0].register, *written)):
        return None
    return Ramp(
        axis,
        modes[0],
        single["target"],
        single["position"],
        single["speed"],
        single["max_speed"],
        single["acceleration"],
        single.get("deceleration"),
        single.get("status"),
    )


def with_meaning(rows: Iterable[Register]) -> tuple[Register, ...]:
    """The same rows, those of ramp generators with what their names mean: sign, help, and what the chip changes."""
    rows = tuple(rows)
    ramps = ramps_of(rows)
    told: dict[int, Register] = {}
    for ramp in ramps:
        for role in ("target", "position", "speed", "max_speed", "acceleration", "deceleration", "status"):
            row: Register | None = getattr(ramp, role)
            if row is not None:
                told[id(row)] = _meant(row, role, ramp.axis)
        if ramp.mode.field is None:
            told[id(ramp.mode.register)] = _meant(ramp.mode.register, "mode", ramp.axis)
    return tuple(told.get(id(row), row) for row in rows)


def _meant(row: Register, role: Role, axis: int) -> Register:
    signed = role in ("target", "position", "speed")
    return replace(
        row,
        axis=axis,
        signed=signed or row.signed,
        range=None if signed else row.range,
        volatile=row.volatile or role in ("position", "speed", "status"),
        help=MEANINGS[role] if not row.help else row.help,
    )
