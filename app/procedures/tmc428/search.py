"""Reference search: both edges of a switch by the position latch, and zero in the middle (DS-TMC428 9.9).

Three switches are meant. "left" and "right" are end switches: the motor runs into the switch, which
stops it, and comes back out; the two edges differ by the switch's hysteresis. A contact that is gone as soon as the
motor stands, as DIAG of a driver is, has one edge. "reference" is the
switch between them that shares the left input (wired or, DS-TMC428 9.8), and is crossed.

Which of the two switches on the shared input is active, the chip cannot tell. Going right it can
only be the reference switch that becomes active, and coming from the right end it is the first one
met. So with a right switch the search goes right first, and turns at the right end if it met
nothing. Without a right switch it goes left at once, as the sheet does, and trusts the caller that
the carriage stands right of the reference switch.
"""

from __future__ import annotations

from ...clock import Clock
from ...devices.core.device import Device
from ...errors import OutOfRange, WrongState
from ..procedure import Failed
from ..search import PHASES, SLACK_S, ReferenceSearchState, Search, Switch, check_figures
from .edges import EdgeFinder

MAX_TRAVEL = 1 << 22
"""Default way after which a phase is given up [microsteps]."""
TOLERANCE_MAX = 4095
TOLERANCE_MARGIN = 8
"""The range that dx_ref_tolerance excludes reaches so far beyond the edges [microsteps]."""


class ReferenceSearch(Search):
    """Searches `switch` at `velocity_pps` (None: a quarter of v_max), `max_travel` microsteps a phase at the most.

    At the end position zero is in the middle of the switch and the motor stands there. After a
    search for "reference", dx_ref_tolerance covers the switch, so that it stops the motor no more.
    """

    def __init__(
        self,
        device: Device,
        axis: int,
        clock: Clock,
        switch: Switch = "reference",
        velocity_pps: float | None = None,
        max_travel: int | None = None,
    ) -> None:
        super().__init__(device, axis, clock)
        check_figures(velocity_pps, max_travel, 23)
        self.switch = switch
        self._finder = EdgeFinder(device, self.axis, clock, switch, max_travel or MAX_TRAVEL)
        self._velocity_pps = velocity_pps
        self._phase = PHASES[0]
        self._edges: list[int] = []
        self._centre: int | None = None
        self._offset: int | None = None
        self._tolerance_before: int | None = None

    @property
    def state(self) -> ReferenceSearchState:
        progress = 1.0 if self._how == "done" else PHASES.index(self._phase) / len(PHASES)
        return ReferenceSearchState(
            self._how, self._phase, progress, list(self._edges), self._centre, self._offset, self.message
        )

    async def _run(self) -> None:
        await self._prepare()
        if self.switch == "reference":
            await self._cross()
        else:
            await self._touch(-1 if self.switch == "left" else 1)
        await self._finish()

    async def _prepare(self) -> None:
        finder = self._finder
        if (await finder.state()).moving:
            await finder.halt()
        ramp = await finder.ramp()
        ramp.require_motion(self.axis)
        ramp.require_proportionality(self.axis)
        problem = finder.switching.problem()
        if problem:
            raise WrongState(*problem)
        # Twice, for two samples: the first may have begun before the switches were set up.
        await finder.pass_time(2 * finder.switching.latency_s())
        switches = (await finder.state()).switches
        if (switches.right if self.switch == "right" else switches.left) is None:
            side = "right" if self.switch == "right" else "left"
            raise WrongState(f"axis {self.axis} has no {side} switch", "see refmux and mot1r (DS-TMC428 Table 9-3)")
        one_pps = self.device.clock_hz / (2**ramp.pulse_div * 2048 * 32)
        wanted = ramp.v_max / 4 if self._velocity_pps is None else self._velocity_pps / one_pps
        if wanted > ramp.v_max:
            raise OutOfRange("velocity", self._velocity_pps, one_pps, ramp.v_max * one_pps, "pps; v_max is the limit")
        finder.speed = max(1, round(wanted))
        # The switch has to stop the motor while it is searched, whatever it is used for otherwise.
        for field, value in (("ref_RnL", int(self.switch == "right")), ("disable_stop_l", 0), ("disable_stop_r", 0)):
            await finder.borrow(field, value)
        await finder.borrow("soft_stop", 0)
        if self.switch == "reference":
            self._tolerance_before = (await self.device.registers.read("dx_ref_tolerance", self.axis)).value
            await finder.set_tolerance(0)

    async def _touch(self, way: int) -> None:
        """An end switch: into it and out again. `way` is the direction in which it lies."""
        finder = self._finder
        if finder.active(await finder.state()):
            self._phase = "leave"
            await finder.leave(-way)
        self._phase = "first edge"
        self._edges.append(await finder.edge(way, stopped_by_switch=True))
        self._phase = "second edge"
        self._edges.append(self._edges[0] if finder.momentary else await finder.edge(-way))
        await finder.halt()

    async def _cross(self) -> None:
        """The switch in between: over it, from one side to the other."""
        finder = self._finder
        state = await finder.state()
        if finder.active(state):
            self._phase = "leave"
            await finder.leave(1)
        self._phase = "first edge"
        left_edge = await finder.edge_or_end(1) if state.switches.right is not None else None
        if left_edge is not None:
            self._edges.append(left_edge)
            self._phase = "second edge"
            if finder.active(await finder.state()):
                self._edges.append(await finder.edge(1))
            else:  # so narrow that it was passed between two looks: its other edge is found coming back
                self._edges.append(await finder.edge(-1, stopped_by_switch=True))
        else:
            self._edges.append(await finder.edge(-1, stopped_by_switch=True))
            self._phase = "second edge"
            self._edges.append(await self._over_active_range())
        await finder.halt()

    async def _over_active_range(self) -> int:
        """Left across the active switch, under the protection of dx_ref_tolerance (DS-TMC428 8.15, 9.9).

        The tolerance lies around position zero and has 12 bits, so zero is put where the range
        reaches as far to the left as it can. A wider switch stops the motor again at the range's
        end, still active: then the range is moved along.
        """
        finder = self._finder
        await finder.set_tolerance(TOLERANCE_MAX)
        gone = 0
        while gone < finder.max_travel:
            await finder.halt()
            await finder.call_here(TOLERANCE_MAX)
            edge = await finder.edge_or_end(-1)
            if edge is not None:
                return edge
            gone += 2 * TOLERANCE_MAX
        raise Failed(f"the switch stays active over {gone} microsteps: is it the left end switch?")

    async def _finish(self) -> None:
        finder = self._finder
        self._phase = "to the centre"
        first, second = sorted(self._edges)
        self._centre = (first + second) // 2
        position = (await finder.state()).position
        await finder.call_here(position - finder.shift - self._centre)
        notes = [f"edges {first} and {second}, zero at {self._centre}"]
        if self.switch == "reference":
            half = (second - first + 1) // 2 + TOLERANCE_MARGIN
            await finder.set_tolerance(min(half, TOLERANCE_MAX))
            self._tolerance_before = None
            if half > TOLERANCE_MAX:
                notes.append(f"dx_ref_tolerance ends at {TOLERANCE_MAX} and does not cover the whole switch")
        # The last way may lead into the active switch, where it has to be allowed to end.
        await finder.borrow("disable_stop_r" if self.switch == "right" else "disable_stop_l", 1)
        started = await self.device.motion.move(self.axis, 0)
        await finder.wait(
            lambda state: state.position_reached and not state.moving,
            (started.predicted_duration_s or 0.0) + SLACK_S,
            "the centre was not reached",
        )
        self._offset = -finder.shift
        self.message = "; ".join(notes)

    async def _give_back(self) -> None:
        if self._tolerance_before is not None:
            await self._finder.set_tolerance(self._tolerance_before)
        await self._finder.give_back()
