"""What a write by hand does to a motion, besides storing a word; and what is expected after it."""

from __future__ import annotations

from collections.abc import Sequence

from ...errors import BenchError, LinkError
from ...registers.model import Register
from ..core.events import MotionStarted
from ..core.register_file import RegisterRules, changes_by_itself
from ..core.register_io import RegisterIO, Snapshot
from ..core.register_link import RegisterLink
from ..core.results import RegisterWritten
from ..core.unread_registers import arrived_unread
from . import prediction, roles
from .events import Events
from .expected_motion import ExpectedMotion
from .memory import ChipMemory
from .ramp_parameters import RampParameters

STATE = (roles.XACTUAL, roles.VACTUAL, roles.AACTUAL, roles.XTARGET)
ELSEWHERE = (roles.XACTUAL, roles.VACTUAL)
GATES = {"XTARGET": roles.GATE_XTARGET, "VMAX": roles.GATE_VMAX, "RAMPMODE": roles.GATE_RAMPMODE}
BY_ITSELF = {"REFERENCE_CONF": "start_home_tracking", "ENC_IN_CONF": "clr_latch_once_on_n"}
"""Bits that return to 0 by themselves."""


class Writes(RegisterRules):
    """What is known of the registers of one TMC4361, and the side effects of writes to them."""

    def __init__(self, link: RegisterLink, memory: ChipMemory, events: Events, expected: ExpectedMotion) -> None:
        self._link = link
        self._session = link.session
        self._memory = memory
        self._events = events
        self._expected = expected
        self._before: tuple[int, int, float] = (0, 1, 0.0)
        """XACTUAL and VACTUAL right before a write, and when the write went out."""

    # --- words seen and sent --------------------------------------------------------------------

    def remembers(self, register: Register) -> bool:
        return self._memory.remembers(register)

    def saw(self, register: Register, word: int) -> None:
        self._memory.saw(register, word)
        self._events.saw(register, word)

    def sent(self, register: Register, word: int) -> None:
        self._memory.sent(register, word)
        if register.address in roles.MOVING:
            self._session.commanded(roles.AXIS, register.name)
        self._events.saw(register, word)
        if register.address in roles.MOVING:
            position, velocity, _ = self._before
            self._before = (position, velocity, self._session.port.last_exchange_s)

    async def read_alone(self, register: Register) -> int | None:
        return await self._events.read_by_name() if register is roles.EVENTS else None

    def kept_word(self, register: Register) -> int | None:
        return self._memory.kept_word(register)

    def held_unread(self, register: Register) -> int:
        return self._memory.held_unread(register)

    def written_unread(self, register: Register, word: int, notes: Sequence[str]) -> RegisterWritten:
        return arrived_unread(register, word, notes)

    # --- side effects ---------------------------------------------------------------------------

    async def before_write(self, io: RegisterIO, register: Register, word: int) -> list[str]:
        if register.address not in roles.MOVING:
            return []
        read = await io.values((*ELSEWHERE, roles.RAMPMODE, roles.XTARGET))
        position, velocity, mode, target = read
        self._before = (position, velocity, io.time_s)
        positioning = bool(mode & roles.POSITIONING_BIT)
        notes = []
        if register is roles.VMAX and word == 0 and positioning and mode & 3 == roles.S_SHAPED and velocity:
            notes.append("VMAX 0 alone must not be written while an S-ramp is positioning: stop it (DS-TMC4361 8.2.2)")
        elif register is roles.XACTUAL and positioning and register.decode(word) != target:
            notes.append("while positioning the motor now drives to XTARGET")
        elif register is roles.RAMPMODE and word & roles.POSITIONING_BIT and not positioning and target != position:
            notes.append(f"the motor now drives to XTARGET, {target}")
        elif register in (roles.AMAX, roles.DMAX, *roles.BOWS) and positioning and velocity:
            notes.append("changed while positioning: XTARGET may be overshot, and is come back to (DS-TMC4361 8.2.2)")
        return notes

    async def explain(self, io: RegisterIO, register: Register, word: int, back: int) -> str | None:
        if register is roles.XACTUAL:
            velocity = await io.value(roles.VACTUAL)
            return f"the motor moves: it is at {register.decode(back)} now" if velocity else None
        if register is roles.CL_OFFSET and not roles.part(roles.ENC_IN_CONF, "cl_calibration_en").unpack(
            await io.read(roles.ENC_IN_CONF)
        ):
            return None
        if register in (roles.XTARGET, roles.VMAX, roles.RAMPMODE):
            gates = await io.read(roles.START_CONF)
            return "it waits for a start signal (START_CONF)" if GATES[register.name].unpack(gates) else None
        if register in (roles.REFERENCE_CONF, roles.ENC_IN_CONF):
            by_itself = BY_ITSELF[register.name]
            if (word ^ back) & register.mask & ~roles.part(register, by_itself).mask:
                return None
            return f"{by_itself} has returned to 0 by itself"
        return changes_by_itself(register, back)

    async def after_write(self, register: Register) -> None:
        if register.address not in roles.MOVING:
            return
        try:
            await self._predict()
        except BenchError:
            # The write itself is done and judged; that the next reading failed is not its failure.
            self._expected.book.end(self._session.port.last_exchange_s, f"{register.name} was written")

    async def _predict(self) -> None:
        """Begin the prediction for whatever the axis does now."""
        before_position, before_velocity, sent_s = self._before
        asked = (*roles.RAMP, *STATE)
        async with self._link.turn() as turn:
            io = self._link.io(turn)
            held = Snapshot(asked, await io.read_many(asked))
            time_s = io.time_s
        self._memory.saw_all(held)
        ramp = RampParameters(held.words)
        position, velocity, acceleration, target = (held.value(register) for register in STATE)
        if before_velocity == 0 and position == before_position:
            # From rest the start is known exactly: it was when the datagram went out.
            velocity, acceleration, time_s = 0, 0, min(time_s, sent_s) or time_s
        vmax_pps = ramp.value(roles.VMAX) / 256
        moves = target != position and vmax_pps if ramp.positioning else vmax_pps or velocity
        if not moves or roles.SDIN_MODE.unpack(held.word(roles.GENERAL_CONF)):
            self._expected.book.end(time_s, "a register was written")
            return
        if ramp.positioning:
            plan = prediction.to_position(ramp, ramp.shape, abs(vmax_pps), target - position, velocity, acceleration)
        else:
            plan = prediction.to_velocity(ramp, ramp.shape, vmax_pps, velocity, acceleration)
        self._expected.expect(time_s, position, plan)
        if ramp.positioning:
            self._expected.watch.began("position", time_s, target)
        else:
            self._expected.watch.began("velocity", time_s)
        if before_velocity == 0:
            self._session.tell(MotionStarted(roles.AXIS, time_s))

    async def predict_by_hand(self) -> None:
        """A raw datagram has written something that may move the axis."""
        self._before = (0, 1, self._session.port.last_exchange_s)
        try:
            await self._predict()
        except LinkError as error:
            self._expected.uncertain(str(error))
