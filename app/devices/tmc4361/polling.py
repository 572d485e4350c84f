"""The axis as it is now, and the task that looks on: ten times a second while it moves, once while it rests.

The same look brings the events, so that no edge of a flag is told later than that.
"""

from __future__ import annotations

from typing import TypedDict

from ...calc.positions.tmc4361_encoder import load_angle_deg
from ...clock import Clock
from ...errors import BenchError, LinkDown, LinkTimeout
from ...links.port import FramePort
from ...links.queue import Priority
from ..core.config import DeviceConfig
from ..core.motion_watch import Look, UnderWay
from ..core.polling import Looking
from ..core.register_io import Held
from ..core.results import AxisState, DeviceState, StopReason, Switches
from ..core.signs import EncoderSeen, Remedy, Signs
from . import encoder, rows
from . import signs as sign
from .moves import COUNTER
from .setting import Setting
from .switches import home_level, stopped_by
from .writes import Writes

MODE_NAMES = ("velocity", "positioning")
SHAPE_NAMES = ("hold", "trapezoid", "S-ramp", "S-ramp")
LOOK = (rows.XACTUAL, rows.VACTUAL, rows.STATUS, rows.XTARGET)
STATE = (
    rows.XACTUAL,
    rows.ENC_POS,
    rows.ENC_POS_DEV,
    rows.MSCNT,
    rows.V_ENC_MEAN,
    rows.VACTUAL,
    rows.AACTUAL,
    rows.XTARGET,
    rows.STATUS,
    *rows.REMEMBERED,
)


OTHER_DRIVERS = frozenset(part.name for part in rows.STATUS.fields if "TMC23x" in part.when)
"""Flags of motor drivers that the chip is seldom used with, at bits that others have too."""


class Encoder(TypedDict, total=False):
    """What `AxisState` has of an encoder."""

    encoder_position: int
    deviation: float
    encoder_velocity_pps: float
    load_angle_deg: float


class Looks(Writes):
    """A TMC4361 that is looked at."""

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> None:
        super().__init__(device_id, config, port, clock)
        self._looking = Looking(self, self.tasks, self._look_once, self._any_moves)
        self.stalled = False
        """A stall has stopped it, and holds it, as last seen."""

    # --- state ----------------------------------------------------------------------------------

    async def axis_state(self, axis: int, priority: Priority = Priority.COMMAND) -> AxisState:
        self.axis(axis)
        self.require_connected()
        async with self.queue.turn(priority) as turn:
            words, asked_at_s = self.words(turn), self.device_time_s()
            held = await self._peek(words, STATE)
            time_s = words.time_s
        self._tell_position(held, asked_at_s)
        setting = Setting(held.words)
        value = held.value
        position, velocity, target = value(rows.XACTUAL), value(rows.VACTUAL), value(rows.XTARGET)
        flags = held.fields(rows.STATUS)
        vmax_pps = setting.value(rows.VMAX) / 256
        reference = held.fields(rows.REFERENCE_CONF)
        self.stalled = self._holds_stall(reference)
        moving = self._moving(setting, flags, velocity, COUNTER.way(target, position), reference)
        self._look(time_s, held, moving)
        return AxisState(
            position=position,
            target_position=target if setting.positioning else None,
            velocity_pps=float(velocity),
            target_velocity_pps=None if setting.positioning else vmax_pps,
            acceleration_pps2=float(value(rows.AACTUAL)),
            position_reached=bool(flags["TARGET_REACHED_F"]),
            moving=moving,
            mode=f"{MODE_NAMES[setting.positioning]}, {SHAPE_NAMES[setting.mode & 3]}",
            switches=Switches(
                bool(flags["STOPL_ACTIVE_F"]),
                bool(flags["STOPR_ACTIVE_F"]),
                home_level(
                    held.word(rows.REFERENCE_CONF),
                    bool(flags["HOME_ERROR_F"]),
                    position,
                    value(rows.X_HOME),
                    value(rows.HOME_SAFETY_MARGIN),
                ),
            ),
            flags=self._flags(flags),
            time_s=time_s,
            **self._encoder(held),
        )

    ENCODER_REGISTERS = encoder.REGISTERS

    def encoder_remedies(self, axis: int, state: AxisState, seen: EncoderSeen) -> tuple[Remedy, ...]:
        return encoder.encoder_remedies(self, self.axis(axis).index, state, seen)

    def signs(self, axis: int, state: AxisState) -> Signs:
        return sign.signs(self, self.axis(axis).index, state, stalled=self.stalled)

    def _encoder(self, held: Held) -> Encoder:
        """What the encoder tells; nothing while ENC_IN_RES is not set and so none of its counts counts."""
        if not held.word(rows.ENC_CONST):
            return {}
        encoder, deviation = held.value(rows.ENC_POS), held.value(rows.ENC_POS_DEV)
        return {
            "encoder_position": encoder,
            "deviation": float(deviation),
            "encoder_velocity_pps": float(held.value(rows.V_ENC_MEAN)),
            "load_angle_deg": self.load_angle(encoder, deviation, held.value(rows.MSCNT), held.word(rows.ENC_IN_CONF)),
        }

    def load_angle(self, encoder: int, deviation: int, mscnt: int, enc_in_conf: int) -> float:
        """How far the field leads the rotor [deg electrical], by what the chip knows."""
        if rows.REGULATION.unpack(enc_in_conf) == 1:
            offset = rows.CL_OFFSET.decode(self.known(rows.CL_OFFSET) or 0)
            reversed_ = bool(rows.REVERSED.unpack(self.known(rows.GENERAL_CONF) or 0))
            return load_angle_deg(mscnt, encoder, offset, reversed_=reversed_)
        return -deviation * 90 / self.microsteps

    def _holds_stall(self, reference: dict[str, int]) -> bool:
        """Whether a stall holds it: one that stopped it does until the event is cleared and `drv_after_stall` set."""
        event = bool(self._events & rows.event("STOP_ON_STALL"))
        free = reference["drv_after_stall"] and not event
        return bool(reference["stop_on_stall"]) and not free and (event or self.stalled)

    def _moving(
        self, setting: Setting, flags: dict[str, int], velocity: int, to_go: int, reference: dict[str, int]
    ) -> bool:
        """VACTUAL reads 0 below 1 pps too; then the flags of velocity and ramp tell."""
        if velocity or flags["VEL_STATE_F"] or flags["RAMP_STATE_F"]:
            return True
        vmax = setting.value(rows.VMAX)
        wanted = (to_go if vmax else 0) if setting.positioning else vmax
        if not wanted or self.stalled or setting.gates()[0]:
            return False
        try:
            setting.require_motion(setting.shape)
        except BenchError:
            return False
        return not stopped_by(flags, reference, 1 if wanted > 0 else -1)

    def _flags(self, status: dict[str, int]) -> dict[str, bool]:
        """Flags of STATUS, and the events that are set."""
        told = {
            name: bool(value)
            for name, value in status.items()
            if not name.endswith("_STATE_F") and name not in OTHER_DRIVERS
        }
        told |= {part.name: bool(part.unpack(self._events)) for part in rows.EVENTS.fields}
        return told

    # --- looking on -----------------------------------------------------------------------------

    def _look_on(self) -> None:
        self._looking.begin()

    def _any_moves(self) -> bool:
        return self._watch.under_way is not None

    async def _look_once(self) -> None:
        async with self.queue.turn(Priority.SAMPLE) as turn:
            words, asked_at_s = self.words(turn), self.device_time_s()
            held = await self._look_at_events(words, LOOK)
            time_s = words.time_s
        self._tell_position(held, asked_at_s)
        moving = bool(held.word(rows.STATUS) & (rows.VEL_STATE.mask | rows.RAMP_STATE.mask))
        self._look(time_s, held, moving)
        rests = self._watch.at_rest(self.device_time_s())
        if rests is not None:
            self._watch.end(*self._why(*rests, held))

    def _tell_position(self, held: Held, asked_at_s: float) -> None:
        """Tell who follows the position counter; the encoder's along, where it was read and counts."""
        has_encoder = rows.ENC_POS.address in held.words and held.words.get(rows.ENC_CONST.address)
        encoder = held.value(rows.ENC_POS) if has_encoder else None
        self.saw_position(rows.AXIS, held.value(rows.XACTUAL), asked_at_s, encoder)

    def _look(self, time_s: float, held: Held, moving: bool) -> None:
        """Tell the watch what was seen."""
        velocity = held.value(rows.VACTUAL) or int(moving)
        reached = bool(held.fields(rows.STATUS)["TARGET_REACHED_F"])
        self._watch.look(Look(time_s, held.value(rows.XACTUAL), velocity, reached))

    def _why(self, motion: UnderWay, rest: Look, held: Held) -> tuple[StopReason, str]:
        """Why the motor rests."""
        flags = held.fields(rows.STATUS)
        if motion.stopped_s is not None:
            return "stop_command", "stopped on command"
        if self._events & rows.event("FROZEN"):
            return "unknown", "NFREEZE went low: the chip is frozen until a reset"
        if self._events & rows.event("STOP_ON_STALL") or flags["ACTIVE_STALL_F"]:
            return "stall", "the motor driver reported a stall (STOP_ON_STALL)"
        reference = rows.REFERENCE_CONF.unpack(self.known(rows.REFERENCE_CONF) or 0)
        for way in (motion.direction,) if motion.direction else (-1, 1):
            stop = stopped_by(flags, reference, way)
            if stop:
                return ("left_switch" if stop.startswith("left") else "right_switch"), f"the {stop} is active"
        for name, reason in (("STOPL_EVENT", "left"), ("STOPR_EVENT", "right")):
            if self._events & rows.event(name):
                return ("left_switch" if reason == "left" else "right_switch"), f"the {reason} switch was met ({name})"
        if flags["TARGET_REACHED_F"] and motion.kind != "velocity":
            return "target_reached", "at its target"
        return "unknown", "the motor rests, and nothing that the chip tells says why"

    # --- connected, and lost sight of -----------------------------------------------------------

    def set_state(self, state: DeviceState, problem: BenchError | None = None) -> None:
        super().set_state(state, problem)
        if state == "connected":
            self._look_on()
        elif state == "failed" and isinstance(problem, LinkDown | LinkTimeout) and self._watch.under_way is not None:
            self._watch.end("lost_link", f"the link failed while it moved; what it did then is not known: {problem}")
