"""Reference search by a stop switch: both edges as the chip latches them, and zero in the middle.

The motor runs into the switch, which stops it, and comes back out; the latch has both edges. A contact that is gone
before anybody looks, as the output of a driver that tells of stalls, is known by the latch alone. What the chips call
the bits that this takes is in `Latching`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Protocol

from ..clock import Clock
from ..devices.core.device import Device
from ..devices.core.results import AxisState
from ..errors import CannotMove, OutOfRange
from .procedure import POLL_S, Failed
from .search import PHASES, SLACK_S, ReferenceSearchState, Search, Switch, check_figures

MAX_TRAVEL = 1 << 23
"""Default way after which a phase is given up [microsteps]: 163 turns at 256 microsteps."""


@dataclass(frozen=True, slots=True)
class Latching:
    """What a chip calls its latch and the register that says what its switches do."""

    latch: str
    switches: str
    sides: Mapping[str, tuple[str, str, str]]
    """Fields of `switches` by side: whether it stops, whether its active and its inactive edge latch."""
    off: tuple[str, ...]
    """Fields of `switches` that have to be 0 while it searches."""


class LatchingChip(Protocol):
    """What such a search asks of a driver besides being a Device."""

    def cruise_pps(self, axis: int) -> float | None:
        """The speed limit that the user has set [pps]; None where nobody knows it."""
        ...

    async def set_position(self, axis: int, position: int) -> int:
        """Call the place where the motor stands `position`; the difference."""
        ...


class StopSearch(Search):
    """Searches `switch` at `velocity_pps` (None: a quarter of the limit), `max_travel` microsteps a phase at the most.

    At the end position zero is in the middle of the switch and the motor stands there, its target too.
    """

    latching: Latching

    def __init__(
        self,
        device: Device,
        chip: LatchingChip,
        axis: int,
        clock: Clock,
        switch: Switch,
        velocity_pps: float | None = None,
        max_travel: int | None = None,
    ) -> None:
        super().__init__(device, axis, clock)
        check_figures(velocity_pps, max_travel, 31)
        self.switch = switch
        self._latching_chip = chip
        self._velocity_pps = velocity_pps
        self._max_travel = max_travel or MAX_TRAVEL
        self._speed_pps = 1.0
        self._phase = PHASES[0]
        self._edges: list[int] = []
        self._centre: int | None = None
        self._offset: int | None = None
        self._before: dict[str, int] = {}
        """Fields of the switches' register that were changed, as they were."""

    @property
    def state(self) -> ReferenceSearchState:
        progress = 1.0 if self._how == "done" else PHASES.index(self._phase) / len(PHASES)
        return ReferenceSearchState(
            self._how, self._phase, progress, list(self._edges), self._centre, self._offset, self.message
        )

    async def _run(self) -> None:
        await self._prepare()
        await self._find()
        await self._finish()

    async def _find(self) -> None:
        """Find both edges."""
        await self._touch(self.switch)

    async def _prepare(self) -> None:
        await self._halt()
        limit_pps = self._latching_chip.cruise_pps(self.axis)
        if not limit_pps:
            told = "VMAX is 0" if limit_pps == 0 else "nobody knows VMAX"
            raise CannotMove(f"the axis cannot move: {told}", "write VMAX", self.axis)
        wanted = limit_pps / 4 if self._velocity_pps is None else self._velocity_pps
        if wanted > limit_pps:
            raise OutOfRange("velocity", wanted, 0, limit_pps, "pps; VMAX is the limit")
        self._speed_pps = wanted

    async def _touch(self, side: Switch) -> None:
        latching = self.latching
        enable, active, inactive = latching.sides[side]
        # It has to stop the motor while it is searched, whatever it is used for otherwise.
        await self._borrow({enable: 1, active: 1, inactive: 1, **dict.fromkeys(latching.off, 0)})
        await self.clock.sleep(POLL_S)  # switched on, the flag of the switch follows its pin behind the input filter
        way = -1 if side == "left" else 1

        def met(state: AxisState) -> bool:
            return bool(state.switches.left if side == "left" else state.switches.right)

        if met(await self._read_axis()):
            self._phase = "leave"
            await self._go(-way, lambda state: not met(state), f"the {side} switch stays active")
        self._phase = "first edge"
        await self._go(way, met, f"no edge of the {side} switch", latched=True)
        self._edges.append(await self._latch())
        self._phase = "second edge"
        await self._go(-way, lambda state: not met(state), f"the {side} switch stays active")
        self._edges.append(await self._latch())

    async def _go(self, way: int, done: Callable[[AxisState], bool], failure: str, *, latched: bool = False) -> None:
        """Go `way` until `done`, or with `latched` until the latch has another edge, and stop.

        Raises Failed where that does not come.
        """
        began = (await self._read_axis()).position
        before = await self._latch() if latched else 0
        await self.device.motion.rotate(self.axis, way * self._speed_pps)
        deadline_s = self._deadline()
        while True:
            await self.clock.sleep(POLL_S)
            state = await self._read_axis()
            if done(state) or (latched and await self._latch() != before):
                break
            if not state.moving:
                raise Failed(f"{failure}: the motor stands at {state.position}, {_blocker(state)}")
            if abs(state.position - began) > self._max_travel or self.device.device_time_s() > deadline_s:
                raise Failed(f"{failure} within {abs(state.position - began)} microsteps")
        await self._halt()

    async def _latch(self) -> int:
        return (await self.device.registers.read(self.latching.latch, self.axis)).value

    async def _finish(self) -> None:
        self._phase = "to the centre"
        first, second = sorted(self._edges)
        self._centre = (first + second) // 2
        position = (await self._read_axis()).position
        self._offset = await self._latching_chip.set_position(self.axis, position - self._centre)
        notes = [f"edges {first} and {second}, zero at {self._centre}", *await self._at_zero(second - first)]
        started = await self.device.motion.move(self.axis, 0)
        deadline_s = self.device.device_time_s() + (started.predicted_duration_s or 0.0) + SLACK_S
        while not ((state := await self._read_axis()).position_reached and not state.moving):
            if self.device.device_time_s() > deadline_s:
                raise Failed(f"the centre was not reached: the motor is at {state.position}, {_blocker(state)}")
            await self.clock.sleep(POLL_S)
        self.message = "; ".join(notes)

    async def _at_zero(self, width: int) -> list[str]:
        """The centre is position 0 now, and the switch `width` microsteps wide; what there is to tell of that."""
        del width
        # The last way leads into the active switch, where it has to be allowed to end.
        await self._borrow({self.latching.sides[self.switch][0]: 0})
        return []

    # --- together -------------------------------------------------------------------------------

    async def _halt(self) -> None:
        """Stop by the ramp and wait for rest: a latched edge is exact however far the motor runs on."""
        await self.device.stop(self.axis)
        deadline_s = self._deadline()
        while (await self._read_axis()).moving:
            if self.device.device_time_s() > deadline_s:
                raise Failed("the motor did not come to rest")
            await self.clock.sleep(POLL_S)

    async def _read_axis(self) -> AxisState:
        return await self.device.monitor.axis_state(self.axis)

    def _deadline(self) -> float:
        """More than a way takes at the search speed, device time [s]."""
        return self.device.device_time_s() + 1.5 * self._max_travel / self._speed_pps + SLACK_S

    async def _borrow(self, wanted: dict[str, int]) -> None:
        """Set fields of the switches' register until `_give_back`."""
        held = (await self.device.registers.read(self.latching.switches, self.axis)).fields
        for name in wanted:
            self._before.setdefault(name, held[name])
        await self.device.registers.write(self.latching.switches, self.axis, fields=dict(wanted))

    async def _give_back(self) -> None:
        if self._before:
            await self.device.registers.write(self.latching.switches, self.axis, fields=dict(self._before))


def _blocker(state: AxisState) -> str:
    active = [side for side in ("left", "right") if getattr(state.switches, side)]
    return f"the {' and '.join(active)} switch is active" if active else "nothing says why it stopped"
