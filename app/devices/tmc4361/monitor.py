"""The axis as it is now, and the poller: ten times a second while it moves, once while it rests.

The same poll brings the events, so that no edge of a flag is told later than that.
"""

from __future__ import annotations

from typing import TypedDict

from ...calc.positions.tmc4361_encoder import load_angle_deg
from ...errors import BenchError, LinkDown, LinkTimeout
from ...links.queue import Priority
from ..core.background_tasks import BackgroundTasks
from ..core.capabilities import AxisMonitor
from ..core.motion_watch import MotionReading, UnderWay
from ..core.polling import Poller
from ..core.register_io import Snapshot
from ..core.register_link import RegisterLink
from ..core.results import AxisState, DeviceState, MotionEnd, StopReason, Switches
from ..core.signs import Signs
from . import roles
from . import signs as sign
from .counter import tell_position
from .cruise import Cruise
from .departure import COUNTER
from .events import Events
from .expected_motion import ExpectedMotion
from .memory import ChipMemory
from .ramp_parameters import RampParameters
from .switches import home_level, is_pressed, stopped_by

MODE_NAMES = ("velocity", "positioning")
SHAPE_NAMES = ("hold", "trapezoid", "S-ramp", "S-ramp")
LOOK = (roles.XACTUAL, roles.VACTUAL, roles.STATUS, roles.XTARGET)
STATE = (
    roles.XACTUAL,
    roles.ENC_POS,
    roles.ENC_POS_DEV,
    roles.MSCNT,
    roles.V_ENC_MEAN,
    roles.VACTUAL,
    roles.AACTUAL,
    roles.XTARGET,
    roles.STATUS,
    *roles.REMEMBERED,
)


class Encoder(TypedDict, total=False):
    """What `AxisState` has of an encoder."""

    encoder_position: int
    deviation: float
    encoder_velocity_pps: float
    load_angle_deg: float


class Monitor(AxisMonitor):
    """Tells how the axis of one TMC4361 is, and polls it; `tasks` are the driver's own."""

    def __init__(
        self,
        link: RegisterLink,
        memory: ChipMemory,
        cruise: Cruise,
        events: Events,
        expected: ExpectedMotion,
        tasks: BackgroundTasks,
    ) -> None:
        self.stalled = False
        """A stall has stopped it, and holds it, as last seen."""
        self._link = link
        self._session = link.session
        self._memory = memory
        self._cruise = cruise
        self._events = events
        self._expected = expected
        self._poller = Poller(self._session, tasks, self._poll, self._any_moves)
        expected.begun_hooks.append(self._poller.begin)
        self._session.state_hooks.append(self._state_set)

    # --- state ----------------------------------------------------------------------------------

    async def axis_state(self, axis: int, priority: Priority = Priority.COMMAND) -> AxisState:
        self._session.axis(axis)
        self._session.require_connected()
        async with self._link.turn(priority) as turn:
            words, asked_at_s = self._link.io(turn), self._session.device_time_s()
            held = await self._events.peek(words, STATE)
            time_s = words.time_s
        tell_position(self._session, held, asked_at_s)
        ramp = RampParameters(held.words)
        value = held.value
        position, velocity, target = value(roles.XACTUAL), value(roles.VACTUAL), value(roles.XTARGET)
        flags = held.fields(roles.STATUS)
        vmax_pps = ramp.value(roles.VMAX) / 256
        reference = held.fields(roles.REFERENCE_CONF)
        self.stalled = self._holds_stall(reference)
        moving = self._moving(ramp, flags, velocity, COUNTER.way(target, position), reference)
        self._update_watch(time_s, held, moving)
        return AxisState(
            position=position,
            target_position=target if ramp.positioning else None,
            velocity_pps=float(velocity),
            target_velocity_pps=None if ramp.positioning else vmax_pps,
            acceleration_pps2=float(value(roles.AACTUAL)),
            position_reached=bool(flags["TARGET_REACHED_F"]),
            moving=moving,
            mode=f"{MODE_NAMES[ramp.positioning]}, {SHAPE_NAMES[ramp.mode & 3]}",
            switches=Switches(
                is_pressed("left switch", flags, reference),
                is_pressed("right switch", flags, reference),
                home_level(
                    held.word(roles.REFERENCE_CONF),
                    bool(flags["HOME_ERROR_F"]),
                    position,
                    value(roles.X_HOME),
                    value(roles.HOME_SAFETY_MARGIN),
                ),
            ),
            flags=self._flags(flags),
            time_s=time_s,
            **self._encoder(held),
        )

    def motion_ends(self, axis: int) -> tuple[MotionEnd, ...]:
        self._session.axis(axis)
        return self._expected.watch.ends

    def signs(self, axis: int, state: AxisState) -> Signs:
        index = self._session.axis(axis).index
        return sign.signs(
            self._memory,
            self._cruise,
            self._events,
            index,
            state,
            stalled=self.stalled,
            driver=self._session.driven().get(index),
        )

    def _encoder(self, held: Snapshot) -> Encoder:
        """What the encoder tells; nothing while ENC_IN_RES is not set and so none of its counts counts."""
        if not held.word(roles.ENC_CONST):
            return {}
        encoder, deviation = held.value(roles.ENC_POS), held.value(roles.ENC_POS_DEV)
        return {
            "encoder_position": encoder,
            "deviation": float(deviation),
            "encoder_velocity_pps": float(held.value(roles.V_ENC_MEAN)),
            "load_angle_deg": self._load_angle(
                encoder, deviation, held.value(roles.MSCNT), held.word(roles.ENC_IN_CONF)
            ),
        }

    def _load_angle(self, encoder: int, deviation: int, mscnt: int, enc_in_conf: int) -> float:
        """How far the field leads the rotor [deg electrical], by what the chip knows."""
        if roles.REGULATION.unpack(enc_in_conf) == 1:
            offset = roles.CL_OFFSET.decode(self._memory.known(roles.CL_OFFSET) or 0)
            reversed_ = bool(roles.REVERSED.unpack(self._memory.known(roles.GENERAL_CONF) or 0))
            return load_angle_deg(mscnt, encoder, offset, reversed_=reversed_)
        return -deviation * 90 / self._memory.microsteps

    def _holds_stall(self, reference: dict[str, int]) -> bool:
        """Whether a stall holds it: one that stopped it does until the event is cleared and `drv_after_stall` set."""
        event = self._events.has("STOP_ON_STALL")
        free = reference["drv_after_stall"] and not event
        return bool(reference["stop_on_stall"]) and not free and (event or self.stalled)

    def _moving(
        self, ramp: RampParameters, flags: dict[str, int], velocity: int, to_go: int, reference: dict[str, int]
    ) -> bool:
        """VACTUAL reads 0 below 1 pps too; then the flags of velocity and ramp tell."""
        if velocity or flags["VEL_STATE_F"] or flags["RAMP_STATE_F"]:
            return True
        vmax = ramp.value(roles.VMAX)
        wanted = (to_go if vmax else 0) if ramp.positioning else vmax
        if not wanted or self.stalled or ramp.gates()[0]:
            return False
        try:
            ramp.require_motion(ramp.shape)
        except BenchError:
            return False
        return not stopped_by(flags, reference, 1 if wanted > 0 else -1)

    def _flags(self, status: dict[str, int]) -> dict[str, bool]:
        """Flags of STATUS, and the events that are set."""
        others = roles.other_drivers(self._memory.known(roles.SPI_OUT_CONF) or 0)
        told = {
            name: bool(value) for name, value in status.items() if not name.endswith("_STATE_F") and name not in others
        }
        told |= {part.name: bool(part.unpack(self._events.present)) for part in roles.EVENTS.fields}
        return told

    # --- polling -------------------------------------------------------------------------------

    def _any_moves(self) -> bool:
        return self._expected.watch.under_way is not None

    async def _poll(self) -> None:
        async with self._link.turn(Priority.SAMPLE) as turn:
            words, asked_at_s = self._link.io(turn), self._session.device_time_s()
            held = await self._events.take(words, LOOK)
            time_s = words.time_s
        tell_position(self._session, held, asked_at_s)
        moving = bool(held.word(roles.STATUS) & (roles.VEL_STATE.mask | roles.RAMP_STATE.mask))
        self._update_watch(time_s, held, moving)
        rests = self._expected.watch.at_rest(self._session.device_time_s())
        if rests is not None:
            self._expected.watch.end(*self._why(*rests, held))

    def _update_watch(self, time_s: float, held: Snapshot, moving: bool) -> None:
        """Tell the watch what was seen."""
        velocity = held.value(roles.VACTUAL) or int(moving)
        reached = bool(held.fields(roles.STATUS)["TARGET_REACHED_F"])
        self._expected.watch.update(MotionReading(time_s, held.value(roles.XACTUAL), velocity, reached))

    def _why(self, motion: UnderWay, rest: MotionReading, held: Snapshot) -> tuple[StopReason, str]:
        """Why the motor rests."""
        flags = held.fields(roles.STATUS)
        if motion.stopped_s is not None:
            return "stop_command", "stopped on command"
        if self._events.has("FROZEN"):
            return "unknown", "NFREEZE went low: the chip is frozen until a reset"
        if self._events.has("STOP_ON_STALL") or flags["ACTIVE_STALL_F"]:
            return "stall", "the motor driver reported a stall (STOP_ON_STALL)"
        reference = roles.REFERENCE_CONF.unpack(self._memory.known(roles.REFERENCE_CONF) or 0)
        for way in (motion.direction,) if motion.direction else (-1, 1):
            stop = stopped_by(flags, reference, way)
            if stop:
                return ("left_switch" if stop.startswith("left") else "right_switch"), f"the {stop} is active"
        for name, reason in (("STOPL_EVENT", "left"), ("STOPR_EVENT", "right")):
            if self._events.has(name):
                return ("left_switch" if reason == "left" else "right_switch"), f"the {reason} switch was met ({name})"
        if flags["TARGET_REACHED_F"] and motion.kind != "velocity":
            return "target_reached", "at its target"
        return "unknown", "the motor rests, and nothing that the chip tells says why"

    # --- connected, and lost sight of -----------------------------------------------------------

    def _state_set(self, state: DeviceState, problem: BenchError | None) -> None:
        if state == "connected":
            self._poller.begin()
        elif (
            state == "failed"
            and isinstance(problem, LinkDown | LinkTimeout)
            and self._expected.watch.under_way is not None
        ):
            self._expected.watch.end(
                "lost_link", f"the link failed while it moved; what it did then is not known: {problem}"
            )
