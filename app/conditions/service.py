"""Keeps the condition of every axis: as it was judged last, since when it is so, and whether the axis is referenced."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

from app.conditions.judge import Condition, Seen, Thresholds, judge
from app.conditions.truth import Truth, truth_of
from app.devices.device import Device, DeviceEvent, MotionCommanded, StateChanged
from app.devices.results import AxisState, MotionEnd
from app.links.errors import BenchError

LOST_FULLSTEPS, FOLLOWING_FULLSTEPS = 2, 4
"""Thresholds where the user has set none: a rotor that is pulled no further than one full step comes back."""
MICROSTEPS = 256
"""Of a full step, where nobody knows how the chip is set."""


@dataclass(frozen=True, slots=True)
class Standing:
    """How one axis stands. `referenced` is None where nobody knows; `truth` is there for emulators alone."""

    condition: Condition
    referenced: bool | None = None
    truth: Truth | None = None


@dataclass(slots=True)
class _Axis:
    """What is remembered of one axis between two looks."""

    standing: Standing | None = None
    sent: bool = False
    """The latest command was to go to a target."""
    stopped: bool = False
    """The latest command was a stop."""
    over: MotionEnd | None = None
    """An end of a motion that counts no more: another command came behind it."""
    referenced: bool | None = None


@dataclass(slots=True)
class _Watched:
    axes: list[_Axis]
    end: Callable[[], None]


@dataclass(slots=True)
class ConditionService:
    """The conditions of all axes of the devices that it was told of by `sync`."""

    _watched: dict[Device, _Watched] = field(default_factory=dict)

    def sync(self, devices: Sequence[Device]) -> None:
        """These are all devices now."""
        for device in self._watched.keys() - set(devices):
            self._watched.pop(device).end()
        for device in devices:
            if device not in self._watched:
                end = device.listen(partial(self._hear, device))
                self._watched[device] = _Watched([_Axis() for _ in device.axes], end)

    async def look(self, device: Device, axis: int) -> tuple[AxisState, Standing]:
        """Read the axis, and judge it by that. Raises what `axis_state` raises; that is judged too."""
        try:
            state = await device.axis_state(axis)
        except BenchError as error:
            self._judge(device, axis, None, str(error))
            raise
        return state, self._judge(device, axis, state)

    def standing(self, device: Device, axis: int) -> Standing:
        """As last judged; asks nothing."""
        if device not in self._watched:
            return Standing(judge(Seen(axis, "disconnected")))
        found = self._watched[device].axes[axis].standing
        return self._judge(device, axis, None) if found is None else found

    # --- inside ---------------------------------------------------------------------------------

    def _judge(self, device: Device, axis: int, state: AxisState | None, problem: str = "") -> Standing:
        if device not in self._watched:
            return Standing(judge(Seen(axis, "disconnected")))
        known = self._watched[device].axes[axis]
        ends = device.motion_ends(axis)
        seen = Seen(
            axis,
            device.state,
            problem or str(device.problem or ""),
            state,
            end=ends[-1] if ends and ends[-1] is not known.over else None,
            sent=known.sent,
            stopped=known.stopped,
            thresholds=thresholds(device, axis),
        )
        if state is not None:
            seen = replace(seen, signs=device.signs(axis, state))
        condition = judge(seen)
        now_s = device.device_time_s() if state is None else state.time_s
        before = known.standing
        since_s = now_s if before is None or before.condition.kind != condition.kind else before.condition.since_s
        known.standing = Standing(replace(condition, since_s=since_s), known.referenced, truth_of(device, axis))
        return known.standing

    def _hear(self, device: Device, event: DeviceEvent) -> None:
        axes = self._watched[device].axes
        if isinstance(event, StateChanged):
            for axis in range(len(axes)):
                self._judge(device, axis, None)
        elif isinstance(event, MotionCommanded):
            known, ends = axes[event.axis], device.motion_ends(event.axis)
            if event.what == "stop":
                known.sent, known.stopped = False, True
                return
            known.over = ends[-1] if ends else None
            known.sent = "target" in event.asked or "target" in event.what.lower()
            known.stopped = False


def thresholds(device: Device, axis: int) -> Thresholds:
    """As the user has set them for the axis, or by its full steps."""
    microsteps = device.axis(axis).microsteps_per_full_step or MICROSTEPS
    return Thresholds(LOST_FULLSTEPS * microsteps, FOLLOWING_FULLSTEPS * microsteps)
