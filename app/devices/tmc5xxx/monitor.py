"""The axes as they are now, and the poll that tells why they came to rest; the same poll brings the events.

Arrival and switches come from RAMP_STAT. Where that must not be read (`reader`), arrival is XACTUAL = XTARGET while
positioning, which is what the flag says, and the switches are not known.
"""

from __future__ import annotations

from typing import TypedDict

from ...links.queue import Priority
from ...registers.model import Register
from ..core.capabilities import AxisMonitor
from ..core.motion_watch import MotionReading, UnderWay
from ..core.register_io import Snapshot
from ..core.register_link import RegisterLink
from ..core.results import AxisState, MotionEnd, StopReason, Switches
from ..core.session import Session
from ..core.signs import Signs
from . import roles as r
from .decoded_registers import DecodedRegisters
from .events import Events
from .memory import ChipMemory
from .motions import Motions
from .reader import ChipReader
from .signs import signs
from .standstill import Standstill

NOT_TOLD = frozenset({"SG_RESULT", "CS_ACTUAL"})
"""Numbers in DRV_STATUS, among its flags."""


class EncoderState(TypedDict, total=False):
    """What `AxisState` has of an encoder."""

    encoder_position: int
    deviation: float


class Monitor(AxisMonitor):
    """Tells how an axis is, and why it came to rest."""

    def __init__(
        self,
        session: Session,
        link: RegisterLink,
        memory: ChipMemory,
        decoded: DecodedRegisters,
        log: Events,
        reader: ChipReader,
        standstill: Standstill,
        motions: Motions,
    ) -> None:
        self.session = session
        self.link = link
        self.memory = memory
        self.decoded = decoded
        self.log = log
        self.reader = reader
        self.standstill = standstill
        self.motions = motions
        self._apart_s = [0.0] * len(session.axes)
        """How long the encoder of each axis was read after its position, of the latest state [s]."""

    def motion_ends(self, axis: int) -> tuple[MotionEnd, ...]:
        return self.motions.ends(self.session.axis(axis).index)

    # --- state ----------------------------------------------------------------------------------

    def _asked(self, axis: int) -> tuple[Register, ...]:
        rows = self.memory.rows(axis)
        encoder = () if rows.x_enc is None else (rows.x_enc,)
        return (
            rows.xactual,
            *encoder,
            rows.vactual,
            rows.xtarget,
            *rows.remembered,
            rows.drv_status,
            self.memory.chip.inputs,
        )

    async def axis_state(self, axis: int, priority: Priority = Priority.COMMAND) -> AxisState:
        rows = self.memory.rows(self.session.axis(axis).index)
        self.session.require_connected()
        async with self.session.queue.turn(priority) as turn:
            io = self.link.io(turn)
            held = await self.reader.poll(io, [axis], self._asked(axis))
            time_s, asked_at_s = io.time_s, io.asked_s
        self._apart_s[axis] = (time_s - asked_at_s) / len(held.registers)
        position, velocity, target = (held.value(row) for row in (rows.xactual, rows.vactual, rows.xtarget))
        mode = held.value(rows.rampmode)
        positioning = mode == r.POSITION
        stat = held.fields(rows.ramp_stat) if rows.ramp_stat.address in held.words else None
        self._tell(axis, time_s, held)
        unit = self.decoded.ramp(axis).velocity_unit_pps
        vmax = self.memory.word(rows.vmax)
        wanted_pps = None if vmax is None else {r.FORWARD: 1, r.BACKWARD: -1}.get(mode, 0) * vmax * unit
        return AxisState(
            position=position,
            target_position=target if positioning else None,
            velocity_pps=velocity * unit,
            target_velocity_pps=None if positioning or mode == r.HOLD else wanted_pps,
            acceleration_pps2=None,
            position_reached=position == target if stat is None else bool(stat["position_reached"]),
            moving=self._moves(axis, held),
            mode=r.MODE_NAMES[mode],
            switches=Switches(
                None if stat is None else bool(stat["status_stop_l"]),
                None if stat is None or not self.decoded.has_right_switch() else bool(stat["status_stop_r"]),
                None,
            ),
            flags=self._flags(axis, held),
            time_s=time_s,
            **self._encoder(axis, held),
        )

    def signs(self, axis: int, state: AxisState) -> Signs:
        axis = self.session.axis(axis).index
        return signs(self.memory, self.session.clock_hz, self.log.resets, axis, state, self._apart_s[axis])

    def _encoder(self, axis: int, held: Snapshot) -> EncoderState:
        """What the encoder tells; nothing while nobody has set how its counts count."""
        rows = self.memory.rows(axis)
        if rows.x_enc is None or not self.decoded.counts_encoder(axis):
            return {}
        encoder = held.value(rows.x_enc)
        return {"encoder_position": encoder, "deviation": float(encoder - held.value(rows.xactual))}

    def _moves(self, axis: int, held: Snapshot) -> bool:
        """Whether the axis moves, or is about to. One that stands is held where RAMP_STAT, which would tell by what,
        must not be read."""
        rows = self.memory.rows(axis)
        if held.word(rows.vactual):
            return True
        if rows.ramp_stat.address not in held.words:
            return False
        mode, vmax, amax = held.value(rows.rampmode), self.memory.word(rows.vmax), self.memory.word(rows.amax)
        to_go = held.value(rows.xtarget) - held.value(rows.xactual)
        way = {r.POSITION: to_go, r.FORWARD: 1, r.BACKWARD: -1, r.HOLD: 0}[mode]
        if not way or not vmax or not amax:
            return False
        return not self._held_by(axis, held, way)

    def _held_by(self, axis: int, held: Snapshot, way: int) -> str:
        """What keeps the axis from going `way`, by RAMP_STAT; "" where nothing does."""
        rows = self.memory.rows(axis)
        stat, switches = held.fields(rows.ramp_stat), held.fields(rows.sw_mode)
        side, name = ("l", "left switch") if way < 0 else ("r", "right switch")
        if switches[f"stop_{side}_enable"] and stat[f"status_stop_{side}"]:
            return name
        return "stall" if self.log.stalled(axis) and switches["sg_stop"] else ""

    def _flags(self, axis: int, held: Snapshot) -> dict[str, bool]:
        """RAMP_STAT, GSTAT and the flags of DRV_STATUS; what was seen and not read by its name counts."""
        rows = self.memory.rows(axis)
        told: dict[str, bool] = {}
        for row in (rows.ramp_stat, self.memory.chip.gstat, rows.drv_status):
            if row.address in held.words:
                fields = row.unpack(self.log.shown(row, held.word(row)))
                told |= {name: bool(value) for name, value in fields.items() if name not in NOT_TOLD}
        if self.memory.chip.inputs.address in held.words:
            told[self.memory.chip.disable_pin] = bool(
                held.fields(self.memory.chip.inputs)[self.memory.chip.disable_pin]
            )
        return told

    # --- polling --------------------------------------------------------------------------------

    async def poll(self) -> None:
        """Ask all axes how they are, and tell what ended."""
        self.motions.polled()
        axes = [axis.index for axis in self.session.axes]
        asked = [
            row
            for rows in self.memory.chip.axes
            for row in (rows.xactual, rows.vactual, rows.xtarget, rows.rampmode, rows.sw_mode)
        ]
        async with self.session.queue.turn(Priority.SAMPLE) as turn:
            io = self.link.io(turn)
            held = await self.reader.poll(io, axes, asked)
            time_s = io.time_s
        for axis in axes:
            self._tell(axis, time_s, held)
            rests = self.motions.of(axis).at_rest(self.session.device_time_s())
            if rests is not None:
                held = await self._seen_through(axis, held, asked)
                self.motions.of(axis).end(*self._why(axis, *rests, held))

    async def _seen_through(self, axis: int, held: Snapshot, asked: list[Register]) -> Snapshot:
        """`held` with RAMP_STAT: an axis that rests somewhere else than it should is kept there first."""
        if self.memory.rows(axis).ramp_stat.address in held.words:
            return held
        async with self.session.queue.turn() as turn:
            io = self.link.io(turn)
            await self.standstill.keep(io, axis)
            return await self.reader.peek(io, [axis], asked)

    def _tell(self, axis: int, time_s: float, held: Snapshot) -> None:
        """Tell the watch what was seen."""
        rows = self.memory.rows(axis)
        position, target = held.value(rows.xactual), held.value(rows.xtarget)
        moving = held.value(rows.vactual) or int(self._moves(axis, held))
        watch = self.motions.of(axis)
        watch.wait_s = (self.memory.wanted(rows.ramp["TZEROWAIT"]) or 0) * 512 / self.session.clock_hz
        reached = held.value(rows.rampmode) == r.POSITION and position == target
        watch.update(MotionReading(time_s, position, moving, reached))

    def _why(self, axis: int, motion: UnderWay, rest: MotionReading, held: Snapshot) -> tuple[StopReason, str]:
        """Why the motor rests."""
        rows, flags = self.memory.rows(axis), self.log.flags(axis)
        if motion.stopped_s is not None:
            return "stop_command", "stopped on command"
        if self.log.reset_s >= motion.began_s:
            return "unknown", "the chip was reset while it moved"
        if self.log.stalled(axis):
            return "stall", "StallGuard stopped it (event_stop_sg)"
        for way in (motion.direction,) if motion.direction else (-1, 1):
            stop = self._held_by(axis, held, way)
            if stop in ("left switch", "right switch"):
                return ("left_switch" if stop == "left switch" else "right_switch"), f"the {stop} is active"
        gstat = self.memory.chip.gstat.unpack(held.word(self.memory.chip.gstat))
        errors = [name for name, value in gstat.items() if value and name in flags.names.values() and name != "reset"]
        if errors:
            return "driver_error", f"the driver has shut down: {', '.join(errors)}"
        if held.value(rows.xactual) == held.value(rows.xtarget) and motion.kind != "velocity":
            return "target_reached", "at its target"
        del rest
        return "unknown", "the motor rests, and nothing that the chip tells says why"
