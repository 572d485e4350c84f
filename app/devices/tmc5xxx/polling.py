"""The axes as they are now, and the task that looks on; the same look brings the events.

Arrival and switches come from RAMP_STAT. Where that must not be read (`events`), arrival is XACTUAL = XTARGET while
positioning, which is what the flag says, and the switches are not known.
"""

from __future__ import annotations

from typing import TypedDict

from ...clock import Clock
from ...errors import BenchError, LinkDown, LinkTimeout
from ...links.port import FramePort
from ...links.queue import Priority
from ...registers.model import Register
from ..core.config import DeviceConfig
from ..core.counter import CounterLook
from ..core.motion_watch import Look, UnderWay
from ..core.polling import Looking
from ..core.register_io import Held
from ..core.results import AxisState, DeviceState, MotionEnd, StopReason, Switches
from ..core.signs import EncoderSeen, Remedy, Signs
from . import encoder
from . import rows as r
from . import signs as sign
from .writes import Writes

NOT_TOLD = frozenset({"SG_RESULT", "CS_ACTUAL"})
"""Numbers in DRV_STATUS, among its flags."""


class Encoder(TypedDict, total=False):
    """What `AxisState` has of an encoder."""

    encoder_position: int
    deviation: float


class Looks(Writes):
    """A TMC5xxx that is looked at."""

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> None:
        super().__init__(device_id, config, port, clock)
        self._looking = Looking(self, self.tasks, self._look_once, self._any_moves)
        self._seen_at_reset = [0] * len(self.axes)
        """How many resets had been seen at the latest `look` at each axis."""
        self._apart_s = [0.0] * len(self.axes)
        """How long the encoder of each axis was read after its position, of the latest state [s]."""
        self._ended = False
        """A motion has ended since the latest look of our own."""

    async def refresh(self) -> None:
        async with self.queue.turn() as turn:
            words = self.words(turn)
            await self._remember(words, self.chip.remembered)
            await self._look_at_events(words, [axis.index for axis in self.axes], self.chip.remembered)

    # --- state ----------------------------------------------------------------------------------

    def _asked(self, axis: int) -> tuple[Register, ...]:
        rows = self.rows(axis)
        encoder = () if rows.x_enc is None else (rows.x_enc,)
        return (rows.xactual, *encoder, rows.vactual, rows.xtarget, *rows.remembered, rows.drv_status, self.chip.inputs)

    async def axis_state(self, axis: int, priority: Priority = Priority.COMMAND) -> AxisState:
        rows = self.rows(self.axis(axis).index)
        self.require_connected()
        async with self.queue.turn(priority) as turn:
            words = self.words(turn)
            held = await self._look_at_events(words, [axis], self._asked(axis))
            time_s, asked_at_s = words.time_s, words.asked_s
        self._apart_s[axis] = (time_s - asked_at_s) / len(held.registers)
        position, velocity, target = (held.value(row) for row in (rows.xactual, rows.vactual, rows.xtarget))
        mode = held.value(rows.rampmode)
        positioning = mode == r.POSITION
        stat = held.fields(rows.ramp_stat) if rows.ramp_stat.address in held.words else None
        self._look(axis, time_s, held)
        unit = self.ramp(axis).velocity_unit_pps
        vmax = self.word(rows.vmax)
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
                None if stat is None or not self.has_right_switch() else bool(stat["status_stop_r"]),
                None,
            ),
            flags=self._flags(axis, held),
            time_s=time_s,
            **self._encoder(axis, held),
        )

    ENCODER_REGISTERS = encoder.REGISTERS

    def encoder_remedies(self, axis: int, state: AxisState, seen: EncoderSeen) -> tuple[Remedy, ...]:
        return encoder.encoder_remedies(self, self.axis(axis).index, state, seen)

    def signs(self, axis: int, state: AxisState) -> Signs:
        return sign.signs(self, self.axis(axis).index, state, self._apart_s[axis])

    def _encoder(self, axis: int, held: Held) -> Encoder:
        """What the encoder tells; nothing while nobody has set how its counts count."""
        rows = self.rows(axis)
        if rows.x_enc is None or not self.counts_encoder(axis):
            return {}
        encoder = held.value(rows.x_enc)
        return {"encoder_position": encoder, "deviation": float(encoder - held.value(rows.xactual))}

    def _moves(self, axis: int, held: Held) -> bool:
        """Whether the axis moves, or is about to. One that stands is held where RAMP_STAT, which would tell by what,
        must not be read."""
        rows = self.rows(axis)
        if held.word(rows.vactual):
            return True
        if rows.ramp_stat.address not in held.words:
            return False
        mode, vmax, amax = held.value(rows.rampmode), self.word(rows.vmax), self.word(rows.amax)
        to_go = held.value(rows.xtarget) - held.value(rows.xactual)
        way = {r.POSITION: to_go, r.FORWARD: 1, r.BACKWARD: -1, r.HOLD: 0}[mode]
        if not way or not vmax or not amax:
            return False
        return not self._held_by(axis, held, way)

    def _held_by(self, axis: int, held: Held, way: int) -> str:
        """What keeps the axis from going `way`, by RAMP_STAT; "" where nothing does."""
        rows = self.rows(axis)
        stat, switches = held.fields(rows.ramp_stat), held.fields(rows.sw_mode)
        side, name = ("l", "left switch") if way < 0 else ("r", "right switch")
        if switches[f"stop_{side}_enable"] and stat[f"status_stop_{side}"]:
            return name
        return "stall" if self._stat[axis] & self.flags[axis].stall and switches["sg_stop"] else ""

    def _flags(self, axis: int, held: Held) -> dict[str, bool]:
        """RAMP_STAT, GSTAT and the flags of DRV_STATUS; what was seen and not read by its name counts."""
        rows = self.rows(axis)
        told: dict[str, bool] = {}
        for row in (rows.ramp_stat, self.chip.gstat, rows.drv_status):
            if row.address in held.words:
                fields = row.unpack(self._shown(row, held.word(row)))
                told |= {name: bool(value) for name, value in fields.items() if name not in NOT_TOLD}
        if self.chip.inputs.address in held.words:
            told[self.chip.disable_pin] = bool(held.fields(self.chip.inputs)[self.chip.disable_pin])
        return told

    # --- the position counter -------------------------------------------------------------------

    async def look(self, axis: int) -> CounterLook:
        """The counter, then GSTAT, in one chain; a reset is told once, and stays to be read by its name."""
        rows = self.rows(self.axis(axis).index)
        self.require_connected()
        asked = (rows.xactual, *(() if rows.x_enc is None else (rows.x_enc,)), rows.vactual)
        async with self.queue.turn() as turn:
            words = self.words(turn)
            held = await self._look_at_events(words, [axis], asked)
            asked_at_s = words.asked_s
        before, self._seen_at_reset[axis] = self._seen_at_reset[axis], self.resets
        return CounterLook(held.value(rows.xactual), asked_at_s, self.resets > before)

    def latch_register(self, axis: int) -> str | None:
        return self.table.get("XLATCH", self.axis(axis).index).name

    def compare_register(self, axis: int) -> str | None:
        found = self.rows(self.axis(axis).index).find("X_COMPARE")
        return None if found is None or found.axis != axis else found.name

    # --- looking on -----------------------------------------------------------------------------

    def _look_on(self) -> None:
        self._looking.begin()

    def _any_moves(self) -> bool:
        return self._ended or any(watch.under_way is not None for watch in self._watches)

    def _tell_end(self, end: MotionEnd) -> None:
        super()._tell_end(end)
        self._ended = True  # the flags that came with it shall not wait for a look in a while

    async def _look_once(self) -> None:
        self._ended = False
        axes = [axis.index for axis in self.axes]
        asked = [
            row
            for rows in self.chip.axes
            for row in (rows.xactual, rows.vactual, rows.xtarget, rows.rampmode, rows.sw_mode)
        ]
        async with self.queue.turn(Priority.SAMPLE) as turn:
            words = self.words(turn)
            held = await self._look_at_events(words, axes, asked)
            time_s = words.time_s
        for axis in axes:
            self._look(axis, time_s, held)
            rests = self._watches[axis].at_rest(self.device_time_s())
            if rests is not None:
                held = await self._seen_through(axis, held, asked)
                self._watches[axis].end(*self._why(axis, *rests, held))

    async def _seen_through(self, axis: int, held: Held, asked: list[Register]) -> Held:
        """`held` with RAMP_STAT: an axis that rests somewhere else than it should is kept there first."""
        if self.rows(axis).ramp_stat.address in held.words:
            return held
        async with self.queue.turn() as turn:
            words = self.words(turn)
            await self._stand_still(words, axis)
            return await self._peek(words, [axis], asked)

    def _look(self, axis: int, time_s: float, held: Held) -> None:
        """Tell the watch what was seen."""
        rows = self.rows(axis)
        position, target = held.value(rows.xactual), held.value(rows.xtarget)
        moving = held.value(rows.vactual) or int(self._moves(axis, held))
        watch = self._watches[axis]
        watch.wait_s = (self.wanted(rows.ramp["TZEROWAIT"]) or 0) * 512 / self.clock_hz
        reached = held.value(rows.rampmode) == r.POSITION and position == target
        watch.look(Look(time_s, position, moving, reached))

    def _why(self, axis: int, motion: UnderWay, rest: Look, held: Held) -> tuple[StopReason, str]:
        """Why the motor rests."""
        rows, flags = self.rows(axis), self.flags[axis]
        if motion.stopped_s is not None:
            return "stop_command", "stopped on command"
        if self._reset_s >= motion.began_s:
            return "unknown", "the chip was reset while it moved"
        if self._stat[axis] & flags.stall:
            return "stall", "StallGuard stopped it (event_stop_sg)"
        for way in (motion.direction,) if motion.direction else (-1, 1):
            stop = self._held_by(axis, held, way)
            if stop in ("left switch", "right switch"):
                return ("left_switch" if stop == "left switch" else "right_switch"), f"the {stop} is active"
        gstat = self.chip.gstat.unpack(held.word(self.chip.gstat))
        errors = [name for name, value in gstat.items() if value and name in flags.names.values() and name != "reset"]
        if errors:
            return "driver_error", f"the driver has shut down: {', '.join(errors)}"
        if held.value(rows.xactual) == held.value(rows.xtarget) and motion.kind != "velocity":
            return "target_reached", "at its target"
        del rest
        return "unknown", "the motor rests, and nothing that the chip tells says why"

    # --- connected, and lost sight of -----------------------------------------------------------

    def set_state(self, state: DeviceState, problem: BenchError | None = None) -> None:
        super().set_state(state, problem)
        if state == "connected":
            self._look_on()
        elif state == "failed" and isinstance(problem, LinkDown | LinkTimeout):
            for watch in self._watches:
                if watch.under_way is not None:
                    watch.end("lost_link", f"the link failed while it moved; what it did then is not known: {problem}")
