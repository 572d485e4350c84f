"""What is expected of an axis after a register that moves it was written by hand."""

from __future__ import annotations

from ...errors import BenchError, LinkError
from ...links.queue import Priority
from ...registers.model import Register
from ..core.events import MotionStarted
from ..core.register_io import RegisterIO, Snapshot
from ..core.register_link import RegisterLink
from ..core.session import Session
from ..core.sixpoint_plans import move_plan, turn_plan
from . import roles as r
from .decoded_registers import DecodedRegisters
from .memory import ChipMemory
from .motions import Motions
from .predictions import Predictions
from .roles import AxisRoles, signed


class WrittenMotion:
    """Looks at an axis before such a write and after it, and predicts what it does then."""

    def __init__(
        self,
        session: Session,
        link: RegisterLink,
        memory: ChipMemory,
        decoded: DecodedRegisters,
        predictions: Predictions,
        motions: Motions,
    ) -> None:
        self.session = session
        self.link = link
        self.memory = memory
        self.decoded = decoded
        self.predictions = predictions
        self.motions = motions
        self._before: tuple[int, int, float] = (0, 1, 0.0)
        """XACTUAL and VACTUAL right before a write, and when the write went out."""

    async def read_before(self, io: RegisterIO, rows: AxisRoles) -> Snapshot:
        """XACTUAL, VACTUAL, RAMPMODE and XTARGET right before a write that may move the axis."""
        asked = (rows.xactual, rows.vactual, rows.rampmode, rows.xtarget)
        held = Snapshot(asked, await io.read_many(asked))
        self.memory.saw(held)
        self.decoded.tell_positions(held, io.asked_s)
        self._before = (held.value(rows.xactual), held.word(rows.vactual), io.time_s)
        return held

    def sent(self) -> None:
        """The write went out."""
        position, velocity, _ = self._before
        self._before = (position, velocity, self.session.port.last_exchange_s)

    async def written(self, rows: AxisRoles, register: Register) -> None:
        """The write is done."""
        try:
            await self._predict(rows)
        except BenchError:
            # The write itself is done and judged; that the next reading failed is not its failure.
            self.predictions.end(rows.axis, self.session.port.last_exchange_s, f"{register.name} was written")

    async def written_by_frame(self, rows: AxisRoles) -> None:
        """A raw datagram has written something that may move the axis."""
        self._before = (0, 1, self.session.port.last_exchange_s)
        try:
            await self._predict(rows)
        except LinkError as error:
            self.motions.uncertain(rows.axis, str(error))

    async def _predict(self, rows: AxisRoles) -> None:
        """Begin the prediction for whatever the axis does now."""
        axis = rows.axis
        before_position, before_velocity, sent_s = self._before
        asked = (rows.rampmode, rows.sw_mode, rows.xactual, rows.vactual, rows.xtarget)
        async with self.session.queue.turn(Priority.COMMAND) as turn:
            io = self.link.io(turn)
            held = Snapshot(asked, await io.read_many(asked))
            time_s = io.time_s
        self.memory.saw(held)
        self.decoded.tell_positions(held, io.asked_s)
        position, velocity, target = (held.value(row) for row in (rows.xactual, rows.vactual, rows.xtarget))
        if before_velocity == 0 and position == before_position:
            # From rest the start is known exactly: it was when the datagram went out.
            velocity, time_s = 0, min(time_s, sent_s) or time_s
        mode, vmax, amax = held.value(rows.rampmode), self.memory.word(rows.vmax), self.memory.word(rows.amax)
        moves = target != position and vmax != 0 if mode == r.POSITION else vmax != 0 or velocity != 0
        if not moves or (mode == r.HOLD and not velocity):
            self.predictions.end(axis, time_s, "a register was written")
            return
        ramp = self.decoded.ramp(axis)
        unit = ramp.velocity_unit_pps
        if mode == r.POSITION:
            plan = move_plan(ramp.sixpoint(vmax, amax), signed(target - position), velocity * unit)
            self.motions.of(axis).began("position", time_s, target)
        else:
            way = -1 if mode == r.BACKWARD else 1
            wanted = velocity if mode == r.HOLD else way * (vmax or 0)
            known = None if vmax is None else ramp.sixpoint(vmax or 1, amax)
            plan = turn_plan(known, wanted * unit, velocity * unit)
            self.motions.of(axis).began("velocity", time_s)
        self.predictions.expect(axis, time_s, position, plan)
        if before_velocity == 0:
            self.session.tell(MotionStarted(axis, time_s))
