"""Setting an axis off: what is read before, what holds it is released, and what moves it goes out once.

Everything that a motion needs goes out in one chain of datagrams, whose order sees to it that nothing moves before the
last one. Nothing here is ever sent twice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ...calc.positions.extended import Counter
from ...errors import LinkError, WriteRefused, WrongState
from ...registers.model import Register, to_raw
from ..core.motion_watch import Kind
from ..core.register_io import RegisterIO, Snapshot, Write
from ..core.register_link import RegisterLink
from . import roles
from .cruise import Cruise
from .events import Events
from .expected_motion import ExpectedMotion
from .memory import ChipMemory
from .ramp_parameters import RampParameters
from .switches import stopped_by

COUNTER = Counter(32)
STATE = (roles.XACTUAL, roles.VACTUAL, roles.AACTUAL, roles.STATUS)
HOLDS = {
    "STOPL_EVENT": "STOPL_ACTIVE_F",
    "STOPR_EVENT": "STOPR_ACTIVE_F",
    "VSTOPL_ACTIVE": "VSTOPL_ACTIVE_F",
    "VSTOPR_ACTIVE": "VSTOPR_ACTIVE_F",
    "STOP_ON_STALL": "ACTIVE_STALL_F",
}
"""Events that keep the motor from a direction, and the flags of what has caused them."""


@dataclass(slots=True)
class Before:
    """The axis right before it is sent somewhere. Positions in microsteps, velocity in pps, acceleration in pps^2."""

    ramp: RampParameters
    position: int
    velocity: int
    acceleration: int
    target: int
    flags: dict[str, int]
    reference: dict[str, int]
    warnings: list[str] = field(default_factory=list)

    @property
    def stands(self) -> bool:
        return self.velocity == 0 and self.acceleration == 0

    def blocked(self, way: int) -> str:
        """What stops motion that way (+1, -1); "" where nothing does."""
        return stopped_by(self.flags, self.reference, way)


class Departure:
    """Sets the axis of one TMC4361 in motion."""

    def __init__(
        self, link: RegisterLink, memory: ChipMemory, cruise: Cruise, events: Events, expected: ExpectedMotion
    ) -> None:
        self._link = link
        self._session = link.session
        self._memory = memory
        self._cruise = cruise
        self._events = events
        self._expected = expected

    async def prepare(self, io: RegisterIO) -> Before:
        """Read what decides, and refuse what cannot go well. Nothing moves."""
        registers = (*roles.RAMP, roles.REFERENCE_CONF, roles.XTARGET, *STATE)
        held = await self._events.peek(io, registers)
        if self._events.has("FROZEN"):
            raise WrongState(
                "the chip is frozen (NFREEZE went low): nothing but a reset ends that",
                "write RESET_CLK_GATING.RESET_REG 0x525354, then set it up again",
            )
        return Before(
            RampParameters(held.words),
            held.value(roles.XACTUAL),
            held.value(roles.VACTUAL),
            held.value(roles.AACTUAL),
            held.value(roles.XTARGET),
            held.fields(roles.STATUS),
            held.fields(roles.REFERENCE_CONF),
            self._memory.clock_warnings(),
        )

    @staticmethod
    def warn_of_gates(before: Before, wanted: Sequence[str]) -> None:
        """Say what of `wanted` waits for a start signal."""
        gated = [
            name
            for name, waits in zip(("XTARGET", "VMAX", "RAMPMODE"), before.ramp.gates(), strict=True)
            if waits and name in wanted
        ]
        if gated:
            before.warnings.append(f"{' and '.join(gated)} waits for a start signal (START_CONF)")

    async def release(self, io: RegisterIO, before: Before) -> None:
        """Clear events of stops whose cause is gone: a direction stays closed until then (DS-TMC4361 9)."""
        gone = roles.event(*(name for name, flag in HOLDS.items() if self._events.has(name) and not before.flags[flag]))
        if not gone:
            return
        if before.stands and before.ramp.positioning and before.target != before.position:
            # Else it would set off to its old target as soon as the way is free.
            await io.write_many(((roles.XTARGET, to_raw(before.position, 32)),))
        await self._events.clear(io, gone)

    async def set_off(
        self, io: RegisterIO, writes: Sequence[Write], kind: Kind, target: int | None, speed: int = 0
    ) -> Snapshot:
        """Send what sets the axis in motion, once; XTARGET, VMAX and RAMPMODE as they are then."""
        self._link.allow(writes)
        checked = (roles.XTARGET, roles.VMAX, roles.RAMPMODE)
        if kind == "position" and target is not None:
            self._session.commanded(roles.AXIS, "move", target=target)
        else:
            self._session.commanded(roles.AXIS, "rotate", velocity=speed)
        for write in writes:
            if write.register is roles.VMAX:
                self._cruise.overwrite_vmax(write.register.decode(write.word))
            elif write.register is roles.RAMPMODE:
                self._cruise.overwrite_mode(write.word)
        try:
            back = Snapshot(checked, (await io.chain(*writes, checked))[0])
        except LinkError as error:
            self._expected.uncertain(str(error))
            raise
        self._expected.watch.began(kind, io.time_s, target)
        self._memory.saw_all(back)
        return back

    @staticmethod
    def check_back(back: Snapshot, wanted: Sequence[tuple[Register, int]]) -> None:
        """Raises WriteRefused where the chip does not hold what was sent."""
        for register, value in wanted:
            if back.value(register) != value:
                raise WriteRefused(
                    register.name, to_raw(value, 32), back.word(register), "the axis may be under way: stop it"
                )


def put(register: Register, value: int) -> Write:
    """The write of a value that is in the register's range."""
    return Write(register, to_raw(value, register.width))
