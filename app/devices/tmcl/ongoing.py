"""The motion under way: what drives the axis, why it came to rest, and the ramp expected of it."""

from __future__ import annotations

from collections.abc import Callable

from ...calc.ramps.sixpoint import MotionPlan
from ...errors import BenchError, LinkDown, LinkTimeout
from ...registers.model import Register
from ..core.events import DeviceEvent, MotionCommanded
from ..core.motion_watch import Kind, MotionWatch
from ..core.planned_motion import PlannedMotion
from ..core.prediction import Prediction, PredictionBook
from ..core.results import DeviceState, MotionEnd
from ..core.session import Session
from ..core.sixpoint_plans import move_plan, turn_plan
from ..core.tmcl_calls import Calls
from .prediction import RAMP_WAIT_S, ramp_of
from .state import ModuleState


class OngoingMotion:
    """Of the one axis. Sends nothing that moves it: who does so tells it here."""

    def __init__(self, session: Session, state: ModuleState) -> None:
        self._session = session
        self._state = state
        self.book: PredictionBook[PlannedMotion] = PredictionBook()
        self.driven: Kind | None = None
        """What the latest command from here made of the axis; None where that is not known."""
        self.latched = 0
        """Bits of AP 207 seen since the latest motion began: reading them clears them in the module."""
        self.began_hooks: list[Callable[[], None]] = []
        """Have the axis polled until the motion under way has ended."""
        self.watch = MotionWatch(0, self._tell_end, self._began)

    # --- what is told ---------------------------------------------------------------------------

    def drives(self, kind: Kind, started_s: float, target: int | None) -> None:
        """The axis follows `kind` from now on."""
        self.driven = kind
        self.watch.wait_s = self._state.known.get(self._state.roles.ramp_wait.address, 0) * RAMP_WAIT_S
        self.watch.began(kind, started_s, target)

    def written(self, register: Register, value: int, time_s: float) -> None:
        """A parameter that may set the motor in motion was written."""
        roles = self._state.roles
        if register is roles.target_position:
            self.drives("position", time_s, value)
        elif register is roles.target_speed:
            self.drives("velocity", time_s, None)
        else:
            self.drives(self.driven or "unknown", time_s, None)

    def stop_commanded(self, time_s: float) -> None:
        """The motor was told to stop, and the module has answered."""
        self.driven = "velocity"
        self.watch.stop_commanded(time_s)

    def mark_unknown(self, why: str) -> None:
        """A command that may have moved or stopped the motor failed: what the axis does is not known."""
        now_s = self._session.device_time_s()
        self.driven = None
        self.book.end(now_s, why)
        self.watch.began("unknown", now_s)

    def on_event(self, event: DeviceEvent) -> None:
        """`Session.listen`: the next motion clears the module's own flags too."""
        if isinstance(event, MotionCommanded):
            self.latched = 0

    def on_seen(self, register: Register, value: int) -> None:
        """`ModuleState.saw_hooks`: flags that a read clears, and a motion that another master began."""
        roles = self._state.roles
        if register is roles.extended_error_flags:
            self.latched |= value
        elif register is roles.actual_speed and value and self.watch.under_way is None:
            self.watch.began("unknown", self._session.port.last_exchange_s)

    def on_state(self, state: DeviceState, problem: BenchError | None) -> None:
        """`Session.state_hooks`: where the link failed, nobody knows what the axis does."""
        if state != "failed":
            return
        self.driven = None
        self.book.end(self._session.device_time_s(), "the link failed")
        if isinstance(problem, LinkDown | LinkTimeout):
            self.lose_sight(str(problem))

    def lose_sight(self, why: str) -> None:
        """What is under way, if anything is, nobody can follow any more."""
        if self.watch.under_way is not None:
            self.watch.end("lost_link", f"the link failed while it moved; what it did then is not known: {why}")

    # --- what is known --------------------------------------------------------------------------

    @property
    def moves(self) -> bool:
        """Whether a motion is under way, as far as this driver knows."""
        return self.watch.under_way is not None

    def reached(self, told: int | None, position: int, target: int | None = None) -> bool:
        """Whether the axis is at its target: as the module tells, else by where it is and where it was sent."""
        if told is not None:
            return bool(told)
        if target is None and self.watch.under_way is not None:
            target = self.watch.under_way.target
        return position == target

    # --- the ramp expected ----------------------------------------------------------------------

    async def predict(
        self, calls: Calls, started_s: float, position: int, at_rest: bool, target: int | None = None, speed: int = 0
    ) -> Prediction | None:
        """Begin the prediction of a motion that has begun at `position`; None where the parameters make none."""
        roles, v_pps = self._state.roles, 0.0
        if not at_rest:  # from rest the start is known exactly
            try:
                position, v = await calls.get_many((roles.actual_position, roles.actual_speed))
            except BenchError:
                self.book.end(started_s, "another command")
                return None
            started_s, v_pps = calls.time_s, v * self._state.speed_unit_pps
        return self.expect(started_s, position, v_pps, target, speed)

    def expect(
        self, started_s: float, position: int, v_pps: float, target: int | None, speed: int
    ) -> Prediction | None:
        """A motion from `position` at `v_pps` to a target, or to a speed where there is none."""
        plan: MotionPlan | None
        state = self._state
        ramp = ramp_of(state.roles, state.known, state.speed_unit_pps, state.acceleration_unit_pps2)
        if target is None:
            plan = turn_plan(ramp, speed * state.speed_unit_pps, v_pps)
        else:
            plan = move_plan(ramp, state.wrap.way(target, position), v_pps)
        if plan is None:
            self.book.end(started_s, "another command")
            return None
        return self.book.add(PlannedMotion(0, started_s, position, plan))

    async def expect_as_set(self, calls: Calls) -> None:
        """After a command that was not one of ours: what does the axis do now, and what is to be expected?"""
        roles = self._state.roles
        position, speed, target, target_speed = await calls.ask_many(
            (roles.actual_position, roles.actual_speed, roles.target_position, roles.target_speed)
        )
        if position is None or speed is None:
            self.book.end(calls.time_s, "another command")
            return
        v_pps = speed * self._state.speed_unit_pps
        if self.driven == "position" and target is not None and target != position:
            self.expect(calls.time_s, position, v_pps, target, 0)
        elif self.driven == "velocity" and target_speed is not None and (target_speed or speed):
            self.expect(calls.time_s, position, v_pps, None, target_speed)
        else:
            self.book.end(calls.time_s, "another command")

    # --- ends -----------------------------------------------------------------------------------

    def _began(self) -> None:
        for hook in self.began_hooks:
            hook()

    def _tell_end(self, end: MotionEnd) -> None:
        present = self.book.present()
        if present is not None and (end.reason != "target_reached" or not present.ends):
            self.book.end(end.time_s, end.detail)
        self._session.tell(end)
