"""Keeps the condition of every axis: looks at a bounded rate, and tells whoever listens of each change."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from ..calc.positions.encoder_resolution import SLACK_MICROSTEPS, Place
from ..clock import Clock
from ..devices.core.background_tasks import BackgroundTasks
from ..devices.core.capabilities import EncoderSetting
from ..devices.core.changes import RegisterChanged
from ..devices.core.counter import CounterWritten, PositionSeen
from ..devices.core.device import Device
from ..devices.core.events import DeviceEvent, LimitReached, MotionCommanded, StateChanged
from ..devices.core.results import AxisState, MotionEnd
from ..devices.core.signs import EncoderSeen, Evidence, Sign, Signs
from ..errors import BenchError
from ..links.queue import Priority, SampleDropped
from .encoder_trace import EncoderTrace
from .ground_truth import AxisGroundTruth, ground_truth_of
from .judge import AxisObservation, Condition, Thresholds, WrongResolution, judge

log = logging.getLogger("stepscope.conditions")

POLL_PERIOD_S = 0.25
"""How often each device is looked at [s]: what happens is told within 0.5 s, the look itself included."""
LIVELY_PERIOD_S = 0.1
"""How often while something moves or has just happened [s]."""
WIRE_SHARE = 0.2
"""How much of a wire's time the looks may take: on a slow one they come less often."""
OWN_SHARE = 0.05
"""How much of the program's own time the looks at resting emulators may take: many are looked at less often."""
REST_PERIOD_MAX_S = 2.0
"""No less often than that [s]."""
FRESH_S = 0.5
"""What is known of a device is no older than that when it is asked for [s]: else it is looked at first."""
ANSWER_WITHIN_S = 0.25
"""How long whoever asks waits for that look [s]; the look itself goes on."""
LIVELY_S = 2.0
"""How long after a command, a written register or another such event a device counts as moving [s]."""

SETS_POSITION = frozenset({"set_position"})
"""Commands, as `commanded` names them, by which a client has said where an axis is."""
LOST_FULLSTEPS, FOLLOWING_FULLSTEPS = 2, 4
"""Thresholds where the user has set none: a rotor that is pulled no further than one full step comes back."""
MICROSTEPS = 256
"""Of a full step, where nobody knows how the chip is set."""


@dataclass(frozen=True, slots=True)
class AxisAssessment:
    """How one axis stands. `referenced` is None where nobody knows; `ground_truth` is there for emulators alone."""

    condition: Condition
    referenced: bool | None = None
    ground_truth: AxisGroundTruth | None = None


@dataclass(slots=True)
class _Axis:
    """What is remembered of one axis between two looks."""

    standing: AxisAssessment | None = None
    polled_s: float = float("-inf")
    """When the latest look began."""
    sent: bool = False
    """The latest command was to go to a target."""
    stopped: bool = False
    """The latest command was a stop."""
    over: MotionEnd | None = None
    """An end of a motion that counts no more: another command came behind it."""
    referenced: bool | None = None
    searched: str = "idle"
    """What the reference search did at the latest look."""
    resets: int | None = None
    reset_s: float | None = None
    limit: Sign | None = None
    """The soft limit that stopped it, until the next command to move."""
    encoders: tuple[EncoderTrace, EncoderTrace] = field(default_factory=lambda: (EncoderTrace(), EncoderTrace()))
    """Where its encoder was seen of late, and the external one."""

    def forget_places(self) -> None:
        """The same places have other numbers from now on."""
        for encoder in self.encoders:
            encoder.clear()


Searched = Callable[[Device, int], str]
"""What the reference search of an axis does, or how the latest ended."""
Listener = Callable[[str, int, AxisAssessment | None], None]
"""Hears the id of a device, the axis, and how it stands now; None: it is no more."""


@dataclass(slots=True)
class _Watched:
    id: str
    axes: list[_Axis]
    end: Callable[[], None]
    looks: asyncio.Task[None]
    lively_until_s: float
    """Until when it is looked at as often as one that moves."""
    extra: asyncio.Task[None] | None = None
    """A look out of turn."""
    look_took_s: float = 0.0
    """Of the latest look at all axes, where that is our own time: an emulator's."""


class ConditionService:
    """The conditions of all axes of the devices that it was told of by `sync`."""

    def __init__(self, clock: Clock, searched: Searched) -> None:
        self._clock = clock
        self._searched = searched
        self._watched: dict[Device, _Watched] = {}
        self._listeners: list[Listener] = []
        self._tasks = BackgroundTasks()

    def sync(self, devices: Sequence[Device]) -> None:
        """These are all devices now, under these ids."""
        for device in self._watched.keys() - set(devices):
            gone = self._watched.pop(device)
            gone.end()
            gone.looks.cancel()
            if gone.id not in {other.id for other in devices}:
                self._gone(gone)
        for device in devices:
            watched = self._watched.get(device)
            if watched is None:
                self._watched[device] = _Watched(
                    device.id,
                    [_Axis() for _ in device.axes],
                    device.listen(partial(self._hear, device)),
                    self._tasks.begin(self._keep_polling(device), f"conditions of {device.id}"),
                    self._clock.now() + LIVELY_S,
                )
            elif watched.id != device.id:
                self._gone(watched)
                watched.id = device.id
            else:
                continue
            for axis in range(len(device.axes)):
                self._tell(device.id, axis, self.standing(device, axis))

    async def close(self) -> None:
        """End looking."""
        self.sync(())
        await self._tasks.end()

    def listen(self, listener: Listener) -> Callable[[], None]:
        """Hear of each change from now on; returns the function that ends it. A listener must not raise."""
        self._listeners.append(listener)
        return partial(self._listeners.remove, listener)

    def all(self) -> list[tuple[Device, int, AxisAssessment]]:
        """Every axis as last judged; asks nothing."""
        axes = [(device, axis) for device in self._watched for axis in range(len(device.axes))]
        return [(device, axis, self.standing(device, axis)) for device, axis in axes]

    def device(self, device_id: str) -> Device | None:
        """The device of that id, as listeners are told of it."""
        return next((device for device, watched in self._watched.items() if watched.id == device_id), None)

    async def poll(
        self, device: Device, axis: int, priority: Priority = Priority.COMMAND
    ) -> tuple[AxisState, AxisAssessment]:
        """Read the axis, and judge it by that. Raises what `axis_state` raises; that is judged too."""
        commands = device.session.motion_commands[axis]
        if device in self._watched:
            self._watched[device].axes[axis].polled_s = self._clock.now()
        try:
            state = await device.monitor.axis_state(axis, priority)
            if priority is Priority.SAMPLE and device.session.motion_commands[axis] != commands:
                return state, self.standing(device, axis)  # a command came between: partly from before it, partly after
            return state, self._judge(device, axis, state)
        except SampleDropped:
            raise
        except BenchError as error:
            self._judge(device, axis, None, str(error))
            raise
        except Exception as error:
            # A fault of this program: what was known before it would else be told for ever.
            self._judge(device, axis, None, f"a look at it failed: {type(error).__name__}: {error}")
            raise

    def stirred(self, device: Device) -> None:
        """Something around the device was changed: look at it now, and often for a while."""
        if device in self._watched:
            self._watched[device].lively_until_s = self._clock.now() + LIVELY_S
            self._poll_now(device)

    async def freshen(self, device: Device) -> None:
        """Look at a device that works and was not looked at for `FRESH_S`; wait no longer than `ANSWER_WITHIN_S`."""
        if device not in self._watched or device.state != "connected" or not self._watched[device].axes:
            return
        oldest_s = min(axis.polled_s for axis in self._watched[device].axes)
        if self._clock.now() - oldest_s > FRESH_S:
            await asyncio.wait([self._poll_now(device)], timeout=ANSWER_WITHIN_S)

    def standing(self, device: Device, axis: int) -> AxisAssessment:
        """As last judged; asks nothing."""
        if device not in self._watched:
            return AxisAssessment(judge(AxisObservation(axis, "disconnected")))
        found = self._watched[device].axes[axis].standing
        return self._judge(device, axis, None) if found is None else found

    # --- looking on -----------------------------------------------------------------------------

    async def _poll_axis(self, device: Device, axis: int) -> None:
        """Look, and have what goes wrong judged; a busy link is looked at later."""
        known = self._watched[device].axes[axis]
        before = known.standing
        try:
            await self.poll(device, axis, Priority.SAMPLE)
        except BenchError:
            pass
        except Exception:
            if before is None or known.standing is None or known.standing.condition.cause != before.condition.cause:
                log.exception("looking at %s axis %d", device.id, axis)

    def _poll_now(self, device: Device) -> asyncio.Task[None]:
        """One look at a time for all who want one of their own."""
        watched = self._watched[device]
        if watched.extra is None or watched.extra.done():
            watched.extra = self._tasks.begin(self._poll_device(device), f"a look at {device.id}")
        return watched.extra

    async def _poll_device(self, device: Device) -> None:
        for axis in range(len(device.axes)):
            if device in self._watched:
                await self._poll_axis(device, axis)

    async def _keep_polling(self, device: Device) -> None:
        pause_s = POLL_PERIOD_S
        polled_s = self._clock.now()
        while True:
            await self._clock.sleep(pause_s)
            pause_s = POLL_PERIOD_S
            began_s = self._clock.now()
            if device.state != "connected" or began_s - polled_s < self._every_s(device):
                continue
            polled_s = began_s
            await self._poll_device(device)
            took_s = self._clock.now() - began_s
            # An emulator in this process has no wire that a look would take from others.
            rest_s = 0.0 if device.session.chip_timed else took_s * (1 / WIRE_SHARE - 1)
            self._watched[device].look_took_s = took_s if device.session.chip_timed else 0.0
            beat_s = self._lively_s() if self._lively(device) else POLL_PERIOD_S
            pause_s = max(beat_s - took_s, beat_s / 2, rest_s)

    def _every_s(self, device: Device) -> float:
        """How long it must be since the latest look [s]: 0 while anything moves."""
        if self._lively(device) or not device.session.chip_timed:
            return 0.0
        # A beat that is a little early is not one too many.
        return min(self._polling_takes_s() / OWN_SHARE, REST_PERIOD_MAX_S) - POLL_PERIOD_S / 2

    def _lively(self, device: Device) -> bool:
        """Whether anything of the device moves, or has just happened, or is not known yet."""
        watched = self._watched[device]
        standings = [axis.standing for axis in watched.axes]
        return (
            self._clock.now() < watched.lively_until_s
            or any(standing is None or standing.condition.kind == "moving" for standing in standings)
            or any(axis.searched == "running" for axis in watched.axes)
        )

    def _lively_s(self) -> float:
        """How often what moves is looked at [s]: less often where looks take much of the program's time."""
        return min(max(self._polling_takes_s() / OWN_SHARE, LIVELY_PERIOD_S), POLL_PERIOD_S)

    def _polling_takes_s(self) -> float:
        """How long one look at every emulator takes [s]."""
        return sum(other.look_took_s for other in self._watched.values())

    # --- inside ---------------------------------------------------------------------------------

    def _judge(self, device: Device, axis: int, state: AxisState | None, problem: str = "") -> AxisAssessment:
        if device not in self._watched:
            return AxisAssessment(judge(AxisObservation(axis, "disconnected")))
        known = self._watched[device].axes[axis]
        ends = device.monitor.motion_ends(axis)
        seen = AxisObservation(
            axis,
            device.state,
            problem or str(device.problem or ""),
            state,
            end=ends[-1] if ends and ends[-1] is not known.over else None,
            sent=known.sent,
            stopped=known.stopped,
            thresholds=thresholds(device, axis),
            held_back=held_back(device),
            counts_position=device.family.counts_position,
        )
        if state is not None:
            signs = device.monitor.signs(axis, state)
            self._follow(known, signs, self._searched(device, axis), state.time_s)
            seen = replace(seen, signs=signs, reset_s=known.reset_s, limit=known.limit)
            seen = replace(seen, resolution=_resolution(device, known, seen, state))
        condition = judge(seen)
        if condition.kind in ("lost_steps", "stalled"):
            known.referenced = False
        now_s = device.device_time_s() if state is None else state.time_s
        before = known.standing
        since_s = now_s if before is None or before.condition.kind != condition.kind else before.condition.since_s
        standing = AxisAssessment(replace(condition, since_s=since_s), known.referenced, ground_truth_of(device, axis))
        known.standing = standing
        if before is None or _said(before) != _said(standing):
            self._tell(device.id, axis, standing)
        return standing

    def _follow(self, known: _Axis, signs: Signs, searched: str, now_s: float) -> None:
        """See whether the device was reset, and what became of a reference search."""
        if signs.resets is not None:
            if signs.resets > (known.resets or 0):
                known.referenced = False
                known.forget_places()
                # The first that is seen may be its power-on, and nobody has known another place before.
                known.reset_s = None if known.resets is None else now_s
            known.resets = signs.resets
        if searched != known.searched:
            if searched == "done":
                known.referenced, known.reset_s = True, None
            elif searched == "running":
                known.referenced = False
            known.searched = searched
            known.forget_places()

    def _tell(self, device_id: str, axis: int, standing: AxisAssessment | None) -> None:
        for listener in tuple(self._listeners):
            listener(device_id, axis, standing)

    def _gone(self, watched: _Watched) -> None:
        for axis in range(len(watched.axes)):
            self._tell(watched.id, axis, None)

    def _hear(self, device: Device, event: DeviceEvent) -> None:
        watched = self._watched[device]
        axes = watched.axes
        # A stop sets nothing in motion, and a place is seen with every sample.
        if not isinstance(event, PositionSeen) and not (isinstance(event, MotionCommanded) and event.what == "stop"):
            watched.lively_until_s = self._clock.now() + LIVELY_S
        if isinstance(event, StateChanged):
            for axis in range(len(axes)):
                axes[axis].forget_places()
                self._judge(device, axis, None)
        elif isinstance(event, MotionCommanded):
            known, ends = axes[event.axis], device.monitor.motion_ends(event.axis)
            if event.what == "stop":
                known.sent, known.stopped = False, True
                return
            known.limit = None
            known.over = ends[-1] if ends else None
            known.sent = "target" in event.asked or "target" in event.what.lower()
            known.stopped = False
            if known.sent or not device.family.counts_position:
                known.reset_s = None
        elif isinstance(event, LimitReached):
            way = "greater" if event.name.endswith("min") else "smaller"
            axes[event.axis].limit = Sign(
                f"it reached its soft limit {event.name} {event.limit:,}: only the way to {way} positions is free",
                (Evidence(event.name, f"{event.limit:,}"), Evidence("position there", f"{event.position:,}")),
            )
        elif isinstance(event, MotionEnd):
            self._tasks.begin(self._poll_axis(device, event.axis), f"end of a motion of {device.id}")
        elif isinstance(event, RegisterChanged):
            for known in axes if event.axis is None else (axes[event.axis],):
                if event.register in _encoder_registers(device):
                    known.forget_places()
                if not device.family.counts_position:  # only its settings were lost, and the user restores them
                    known.reset_s = None
        elif isinstance(event, CounterWritten):
            known = axes[event.axis]
            known.forget_places()
            # A search that is not over has found nothing yet.
            if event.what in SETS_POSITION and known.searched != "running":
                known.referenced, known.reset_s = True, None


def _said(standing: AxisAssessment) -> tuple[object, ...]:
    """What is news where it differs; figures among the evidence are not, nor when they were seen."""
    condition = standing.condition
    return condition.kind, condition.cause, condition.remedies, standing.referenced, standing.ground_truth


def _resolution(device: Device, known: _Axis, seen: AxisObservation, state: AxisState) -> WrongResolution | None:
    """Keep the place where the axis is, and say whether its encoder's resolution is wrong by all that are kept."""
    axis = seen.axis
    microsteps = device.axis(axis).microsteps
    if microsteps is None or seen.signs.regulated:  # a motor that follows its encoder deviates by nothing of the kind
        return None
    full_step, turn = microsteps
    deviations = state.deviation, state.external_deviation
    for encoder, deviation in zip(known.encoders, deviations, strict=True):
        if deviation is not None:
            apart = abs(state.velocity_pps) * seen.signs.encoder_apart_s
            encoder.add(Place(state.position, deviation, apart), turn)
    told_from = min(seen.thresholds.lost_steps, seen.thresholds.following_error)
    # The external one only where its own agrees: what is wrong with both is wrong with what both are scaled by.
    for external, (encoder, deviation) in enumerate(zip(known.encoders, deviations, strict=True)):
        if deviation is not None and abs(deviation) > told_from:
            line = encoder.line(full_step, turn)
            if line is None:
                return None
            told = EncoderSeen(1 + line.slope, line.way, max(line.off, SLACK_MICROSTEPS), bool(external))
            setting = None if state.moving else device.part(EncoderSetting)
            return WrongResolution(line, () if setting is None else setting.encoder_remedies(axis, state, told))
    return None


def _encoder_registers(device: Device) -> frozenset[str]:
    setting = device.part(EncoderSetting)
    return frozenset() if setting is None else setting.ENCODER_REGISTERS


def held_back(device: Device) -> Sign | None:
    """Why a device that answers is left alone, and the way out; None where it is not."""
    why = device.session.held_back
    if why is None or type(device.problem) is not type(why):
        return None
    return Sign(str(why), (Evidence("link", "it answers"),), device.ways_out(why))


def thresholds(device: Device, axis: int) -> Thresholds:
    """As the user has set them for the axis, or by its full steps."""
    known, microsteps = device.axis(axis).settings, device.axis(axis).microsteps_per_full_step or MICROSTEPS
    return Thresholds(
        known.lost_steps_microsteps or LOST_FULLSTEPS * microsteps,
        known.following_error_microsteps or FOLLOWING_FULLSTEPS * microsteps,
    )
