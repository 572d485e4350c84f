"""Which procedure runs on which axis: one at a time, started, looked at and ended from here."""

from __future__ import annotations

import asyncio
from collections.abc import Collection, Sequence
from typing import TypeVar

from ..clock import Clock
from ..devices.core.capabilities import EncoderSetting
from ..devices.core.device import Device
from ..devices.core.results import Rotating
from ..errors import WrongState
from . import debugging, shuttle, straight_line, velocity_profile
from . import search as searches
from .closed_loop import NOT_CALIBRATED, NOT_RECORDED, Calibration, CalibrationState, Load, ResponseState
from .debugging import Debugging, DebugState
from .debugging import Mode as DebugMode
from .families import calibration_of, search_of
from .hold import Hold, check_hold
from .procedure import Procedure
from .search import ReferenceSearchState, Search, SearchWanted, Switch
from .shuttle import Shuttle, ShuttleState
from .stall_search import StallSearch, StallWanted
from .start_together import StartNet, TogetherMove, TogetherStart, start_together
from .step_response import USUAL_WINDOW, Disturbance, Response, Shape, StepResponse, Window
from .straight_line import LineAxis, LinePath, LineRun, LineState, plan_line
from .velocity_profile import ProfilePlay, ProfileState

P = TypeVar("P", bound=Procedure)


class Procedures:
    """All procedures of this server. `clock` is the server's."""

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._latest: dict[Device, dict[tuple[int, str], Procedure]] = {}
        self._line: LineRun | None = None

    def sync(self, devices: Sequence[Device]) -> None:
        """These are all devices now. What runs on another one ends with its next command, which is refused."""
        for device in self._latest.keys() - set(devices):
            del self._latest[device]

    def running(self, device: Device, axis: int | None = None) -> list[Procedure]:
        """What runs on that axis, or on any axis of the device."""
        return [
            procedure
            for (at, _), procedure in self._latest.get(device, {}).items()
            if procedure.running and axis in (None, at)
        ]

    async def cancel(self, device: Device, axis: int | None = None, why: str = "aborted") -> None:
        """End what runs on that axis, or on the device, and stop its motor."""
        await asyncio.gather(*(procedure.abort(why) for procedure in self.running(device, axis)))

    async def close(self) -> None:
        """End everything. For the end of the program."""
        await self.stop_line("the server ends")
        await asyncio.gather(*(self.cancel(device, why="the server ends") for device in list(self._latest)))

    def start(self, procedure: P) -> P:
        """Begin a procedure of another room. Raises WrongState while one runs on its axis, or it is not connected."""
        return self._start(procedure)

    # --- reference search -----------------------------------------------------------------------

    def start_search(
        self,
        device: Device,
        axis: int,
        switch: Switch = "reference",
        velocity_pps: float | None = None,
        max_travel: int | None = None,
        *,
        mode: int | None = None,
        search_speed_pps: float | None = None,
        switch_speed_pps: float | None = None,
    ) -> ReferenceSearchState:
        """For a chip `switch` at `velocity_pps`; for a module, which searches by itself, `mode` and its two speeds.

        Raises WrongState while another procedure runs there, OutOfRange for what cannot be.
        """
        if device.limiter is not None:
            device.limiter.require_target(device.axis(axis).index, 0, what="a search calls its reference 0")
        wanted = SearchWanted(switch, velocity_pps, max_travel, mode, search_speed_pps, switch_speed_pps)
        return self._start(search_of(device, axis, self._clock, wanted)).state

    def start_stall_search(self, device: Device, axis: int, wanted: StallWanted) -> ReferenceSearchState:
        """Search the end of the stage by stall. Raises what `start_search` raises."""
        if device.limiter is not None:
            device.limiter.require_target(device.axis(axis).index, 0, what="a search calls its reference 0")
        return self._start(StallSearch(device, axis, self._clock, wanted)).state

    def search_state(self, device: Device, axis: int) -> ReferenceSearchState:
        """The present search, or the latest. Raises UnknownThing for the axis."""
        latest = self._find(device, axis, Search)
        return searches.IDLE if latest is None else latest.state

    async def abort_search(self, device: Device, axis: int) -> ReferenceSearchState:
        """End it and stop the motor; the state afterwards."""
        await self._abort(device, axis, Search)
        return self.search_state(device, axis)

    # --- shuttle --------------------------------------------------------------------------------

    def start_shuttle(self, device: Device, axis: int, first: int, second: int, dwell_s: float = 0.3) -> ShuttleState:
        """Raises WrongState while another procedure runs there, OutOfRange for what cannot be."""
        begun = Shuttle(device, axis, self._clock, first, second, dwell_s)
        if device.limiter is not None:
            for target in (first, second):
                device.limiter.require_target(begun.axis, target)
        return self._start(begun).state

    def shuttle_state(self, device: Device, axis: int) -> ShuttleState:
        """The present shuttle, or the latest. Raises UnknownThing for the axis."""
        latest = self._find(device, axis, Shuttle)
        return shuttle.IDLE if latest is None else latest.state

    async def stop_shuttle(self, device: Device, axis: int) -> ShuttleState:
        """End it and stop the motor; the state afterwards."""
        await self._abort(device, axis, Shuttle, "stopped on request")
        return self.shuttle_state(device, axis)

    # --- velocity profile -----------------------------------------------------------------------

    async def start_profile(
        self, device: Device, axis: int, time_s: Sequence[float], velocity_pps: Sequence[float], rate_hz: float | None
    ) -> ProfileState:
        """Raises what `velocity_profile.judge` raises, and WrongState while another procedure runs there or where a
        stop comes first."""
        require_not_stopped = device.session.stop_guard([device.axis(axis).index])
        wanted = await velocity_profile.judge(device, axis, time_s, velocity_pps, rate_hz)
        require_not_stopped()
        return self._start(ProfilePlay(device, axis, self._clock, wanted)).state

    def profile_play(self, device: Device, axis: int) -> ProfilePlay | None:
        """The present velocity profile, or the latest. Raises UnknownThing for the axis."""
        return self._find(device, axis, ProfilePlay)

    def profile_state(self, device: Device, axis: int) -> ProfileState:
        """How that goes, or went."""
        latest = self.profile_play(device, axis)
        return velocity_profile.IDLE if latest is None else latest.state

    async def stop_profile(self, device: Device, axis: int) -> ProfileState:
        """End it and stop the motor; the state afterwards."""
        await self._abort(device, axis, ProfilePlay, "stopped on request")
        return self.profile_state(device, axis)

    # --- several devices ------------------------------------------------------------------------

    async def start_together(
        self, moves: Sequence[TogetherMove], nets: Sequence[StartNet], *, use_wires: bool = True
    ) -> TogetherStart:
        """Start axes of any devices together. Raises WrongState while a procedure runs on one of them, and what
        `start_together` raises."""
        for one in moves:
            for running in self.running(one.device, one.move.axis):
                raise WrongState(f"a {running.kind} runs on axis {one.move.axis} of {one.device.name}", "stop it first")
        return await start_together(moves, nets, self._clock, use_wires=use_wires)

    async def start_line(
        self,
        axes: Sequence[LineAxis],
        points: Sequence[Sequence[int]],
        nets: Sequence[StartNet],
        pace: float = 1.0,
        duration_s: float | None = None,
    ) -> LineState:
        """Go on straight lines to one point after another. Raises what `plan_line` raises, and WrongState while another
        line is under way, a procedure on one of these axes, or where a stop of one of them comes first."""
        if self._line is not None and self._line.running:
            raise WrongState("a straight line is under way", "stop it first")
        for one in axes:
            for running in self.running(one.device, one.axis):
                raise WrongState(f"a {running.kind} runs on axis {one.axis} of {one.device.name}", "stop it first")
        guards = [one.device.session.stop_guard([one.axis]) for one in axes]
        _, legs = await plan_line(axes, points, pace, duration_s)
        for require_not_stopped in guards:
            require_not_stopped()
        self._line = LineRun(axes, legs, nets, self._clock)
        self._line.start()
        return self._line.state

    @property
    def line_state(self) -> LineState:
        """The present straight line, or the latest."""
        return straight_line.IDLE if self._line is None else self._line.state

    @property
    def line_path(self) -> LinePath | None:
        """Where its axes were seen, beside its plan; None before the first."""
        return None if self._line is None else self._line.path

    async def stop_line(self, why: str = "stopped on request") -> LineState:
        """End it and stop its motors; the state afterwards."""
        if self._line is not None:
            await self._line.abort(why)
        return self.line_state

    # --- held rotation --------------------------------------------------------------------------

    async def rotate_held(self, device: Device, axis: int, velocity: float, unit: str, hold_s: float) -> Rotating:
        """Rotate, and stop by itself in `hold_s` [s] unless `keep_rotating` is called.

        Raises what `rotate` does, and WrongState where what ran on this axis is not over in that time: it gives its
        settings back only when the motor stands.
        """
        check_hold(hold_s)
        before = self._find(device, axis, Hold)
        if before is not None and before.running:
            before.keep(hold_s)  # the client is there: it must not end, and stop the motor, while this is on its way
        rotating = await device.motion.rotate(axis, velocity, unit)
        for ended in self.running(device, axis):  # by this very rotation; their last words must not stop it
            if not await ended.over_within(hold_s):
                await device.stop(axis)
                raise WrongState(
                    f"a {ended.kind} runs on axis {axis} of {device.name}", "it ends now: wait, and try again"
                )
        self._start(Hold(device, axis, self._clock, rotating, hold_s))
        return rotating

    def keep_rotating(self, device: Device, axis: int, hold_s: float) -> Rotating:
        """Let a held rotation go on; never begins one, so that it cannot overtake a stop. Raises WrongState."""
        held = self._find(device, axis, Hold)
        if held is None or not held.running:
            raise WrongState(f"nothing is held on axis {axis} of {device.name}", "begin with rotate and hold_s")
        return held.keep(hold_s)

    # --- closed loop ----------------------------------------------------------------------------

    def start_calibration(
        self,
        device: Device,
        axis: int,
        velocity_pps: float = 10_000.0,
        settle_s: float = 0.1,
        *,
        switch_on: bool = True,
    ) -> CalibrationState:
        """Raises WrongState where there is no closed loop or another procedure runs, OutOfRange."""
        calibration = calibration_of(device, axis, self._clock, velocity_pps, settle_s, switch_on=switch_on)
        return self._start(calibration).state

    def calibration_state(self, device: Device, axis: int) -> CalibrationState:
        """The present calibration, or the latest. Raises UnknownThing for the axis."""
        latest = self._find(device, axis, Calibration)
        return NOT_CALIBRATED if latest is None else latest.state

    async def abort_calibration(self, device: Device, axis: int) -> CalibrationState:
        """End it, regulation off, and stop the motor; the state afterwards."""
        await self._abort(device, axis, Calibration)
        return self.calibration_state(device, axis)

    def start_step_response(
        self,
        device: Device,
        axis: int,
        distance: int,
        shape: Shape = "ramp",
        window: Window = USUAL_WINDOW,
    ) -> ResponseState:
        """Raises WrongState where there is no encoder channel or another procedure runs, OutOfRange."""
        _require_encoder(device, axis)
        return self._start(StepResponse(device, axis, self._clock, distance, shape, window)).state

    def step_response_state(self, device: Device, axis: int) -> ResponseState:
        """The present step response, or the latest. Raises UnknownThing for the axis."""
        return self._response_state(device, axis, StepResponse)

    async def abort_step_response(self, device: Device, axis: int) -> ResponseState:
        """End it and stop the motor; the state afterwards."""
        return await self._abort_response(device, axis, StepResponse)

    def start_disturbance(
        self,
        device: Device,
        axis: int,
        load: Load | None,
        load_s: float | None = None,
        window: Window = USUAL_WINDOW,
    ) -> ResponseState:
        """Raises WrongState where there is no encoder channel or another procedure runs, OutOfRange."""
        _require_encoder(device, axis)
        return self._start(Disturbance(device, axis, self._clock, load, load_s, window)).state

    def disturbance_state(self, device: Device, axis: int) -> ResponseState:
        """The present disturbance, or the latest. Raises UnknownThing for the axis."""
        return self._response_state(device, axis, Disturbance)

    async def abort_disturbance(self, device: Device, axis: int) -> ResponseState:
        """End it and take the load away; the state afterwards."""
        return await self._abort_response(device, axis, Disturbance)

    # --- debugged program -----------------------------------------------------------------------

    def start_debugging(
        self, device: Device, mode: DebugMode, breakpoints: Collection[int], *, from_start: bool = False
    ) -> DebugState:
        """Raises WrongState where there is no program memory or another procedure runs, OutOfRange."""
        return self._start(Debugging(device, self._clock, mode, breakpoints, from_start)).state

    def debugging(self, device: Device) -> Debugging | None:
        """The present run by single steps, or the latest."""
        return self._find(device, 0, Debugging)

    def debug_state(self, device: Device) -> DebugState:
        """How that is."""
        latest = self.debugging(device)
        return debugging.IDLE if latest is None else latest.state

    async def pause_debugging(self, device: Device) -> DebugState:
        """End it before its next command; the motor goes on as it was told last."""
        latest = self.debugging(device)
        if latest is not None and latest.running:
            latest.pause()
            await latest.wait()
        return self.debug_state(device)

    # --- inside ---------------------------------------------------------------------------------

    def _response_state(self, device: Device, axis: int, kind: type[Response]) -> ResponseState:
        latest = self._find(device, axis, kind)
        return NOT_RECORDED if latest is None else latest.state

    async def _abort_response(self, device: Device, axis: int, kind: type[Response]) -> ResponseState:
        await self._abort(device, axis, kind)
        return self._response_state(device, axis, kind)

    def _start(self, procedure: P) -> P:
        device, axis = procedure.device, procedure.axis
        device.session.require_connected()
        others = self.running(device, axis)
        if others:
            raise WrongState(f"a {others[0].kind} runs on axis {axis} of {device.name}", "stop it first")
        self._latest.setdefault(device, {})[axis, procedure.kind] = procedure
        procedure.start()
        return procedure

    async def _abort(self, device: Device, axis: int, kind: type[P], why: str = "aborted on request") -> None:
        latest = self._find(device, axis, kind)
        if latest is not None:
            await latest.abort(why)

    def _find(self, device: Device, axis: int, kind: type[P]) -> P | None:
        found = self._latest.get(device, {}).get((device.axis(axis).index, kind.kind))
        return found if isinstance(found, kind) else None


def _require_encoder(device: Device, axis: int) -> None:
    """Raises WrongState where the way of that axis cannot be recorded."""
    index = device.axis(axis).index
    device.need(EncoderSetting).require_encoder(index)
