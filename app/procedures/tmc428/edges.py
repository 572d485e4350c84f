"""What a reference search is made of: go until the latch has an edge, stop, count positions on, borrow settings.

Positions that go in or out are counted as before the search; where the search moves the chip's zero,
`shift` knows by how much.
"""

from __future__ import annotations

from collections.abc import Callable

from ...clock import Clock
from ...devices.core.device import Device
from ...devices.core.results import AxisState
from ...devices.tmc428.memory import RampMemory
from ...devices.tmc428.ramp_parameters import RampParameters
from ...devices.tmc428.stops import RampStops
from ...devices.tmc428.switching import Switching
from ...errors import WrongState
from ..procedure import POLL_S, Failed
from ..search import SLACK_S, Switch

STOPPED_PART = 0.9
"""What is slower than this part of the fastest that was seen, and has an edge in its latch, was stopped by it [-]."""


class EdgeFinder:
    """One axis on its search for the edges of one switch, at `speed` chip units, `max_travel` microsteps a phase."""

    def __init__(self, device: Device, axis: int, clock: Clock, switch: Switch, max_travel: int) -> None:
        memory, switching, stops = device.part(RampMemory), device.part(Switching), device.part(RampStops)
        if memory is None or switching is None or stops is None:
            raise WrongState(f"a {device.family.title} has no position latch to search with")
        self.device = device
        self.switching = switching
        self._memory = memory
        self._stops = stops
        self.axis = axis
        self.switch = switch
        self.max_travel = max_travel
        self.speed = 1
        self.momentary = False
        """Whether the contact has stopped the motor and was gone by that, as DIAG of a driver is after a stall."""
        self.shift = 0
        """What was added to positions of before the search to get those of now."""
        self._clock = clock
        self._rows = memory.rows[axis]
        self._borrowed: dict[str, tuple[int, int]] = {}
        """Fields of the reference register that were changed: what they were, what they are."""

    async def state(self) -> AxisState:
        return await self.device.monitor.axis_state(self.axis)

    def active(self, state: AxisState) -> bool:
        """Whether the switch is active; reference and left switch share an input."""
        return bool(state.switches.right if self.switch == "right" else state.switches.left)

    async def ramp(self) -> RampParameters:
        """The axis's registers, read now."""
        await self.device.identity.refresh()
        ramp = self._memory.ramp(self.axis)
        assert ramp is not None  # refresh has just read all of it
        return ramp

    # --- going ----------------------------------------------------------------------------------

    async def edge(self, way: int, *, stopped_by_switch: bool = False) -> int:
        """Go `way` until the latch has caught an edge; its position. Raises Failed where none comes.

        `stopped_by_switch`: the edge is one that stops the motor; what was latched before, on the way
        over a range that the tolerance excludes, does not count.
        """
        found, state = await self._go(way, stopped_by_switch=stopped_by_switch)
        if found is None:
            raise Failed(f"the motor stands at {state.position} and the switch has shown no edge: {_blocker(state)}")
        return found

    async def edge_or_end(self, way: int) -> int | None:
        """Go `way` until the latch has caught an edge; None where a switch stops the motor before."""
        return (await self._go(way, stopped_by_switch=False))[0]

    async def _go(self, way: int, *, stopped_by_switch: bool) -> tuple[int | None, AxisState]:
        await self._arm()
        state = await self.state()
        began = state.position
        await self.device.motion.rotate(self.axis, way * self.speed, "chip")
        deadline_s = self._deadline(self._seconds_for(self.max_travel))
        rises_s = self._seconds_to_first_unit()
        stands_since_s: float | None = None
        fastest_pps = 0.0
        while True:
            await self._clock.sleep(POLL_S)
            state = await self.state()
            fastest_pps = max(fastest_pps, abs(state.velocity_pps))
            latched = not state.flags[self._rows.latch_waiting.name]
            if state.moving:
                stands_since_s = None
            elif stands_since_s is None:
                stands_since_s = state.time_s
            # v_actual reads 0 for a while at the start of a motion too.
            stands = stands_since_s is not None and state.time_s - stands_since_s > rises_s
            if latched and (stands or not stopped_by_switch):
                return (
                    await self.device.registers.read(self._rows.x_latched.name, self.axis)
                ).value - self.shift, state
            if latched and not self.active(state):
                if stopped_by_switch and abs(state.velocity_pps) < STOPPED_PART * fastest_pps:
                    # Its chip stops for as long as the contact is there: it goes on already.
                    self.momentary = True
                    edge = (await self.device.registers.read(self._rows.x_latched.name, self.axis)).value
                    await self.halt()
                    return edge - self.shift, state
                await self._arm()
            if stands:
                return None, state
            if abs(state.position - began) > self.max_travel or self.device.device_time_s() > deadline_s:
                raise Failed(f"no edge of the {self.switch} switch within {abs(state.position - began)} microsteps")

    async def leave(self, way: int) -> None:
        """Go `way` until the switch is released, and stop. Raises Failed where it is not."""
        began = (await self.state()).position
        await self.device.motion.rotate(self.axis, way * self.speed, "chip")

        def released(state: AxisState) -> bool:
            if not self.active(state):
                return True
            if not state.moving:
                raise Failed(f"cannot leave the active switch: {_blocker(state)}")
            if abs(state.position - began) > self.max_travel:
                raise Failed(f"the switch is still active after {self.max_travel} microsteps")
            return False

        await self.wait(released, self._seconds_for(self.max_travel), "the switch stays active")
        await self.halt()

    async def halt(self) -> None:
        """Stop by the ramp and wait for rest: a latched edge is exact however far the motor runs on."""
        await self.device.stop(self.axis)
        ramp = await self.ramp()
        seconds = 256 * ramp.v_max / max(1, ramp.a_max) * 32 * 2**ramp.ramp_div / self.device.clock_hz
        await self.wait(lambda state: not state.moving, seconds + SLACK_S, "the motor did not come to rest")

    async def wait(self, done: Callable[[AxisState], bool], timeout_s: float, failure: str) -> None:
        """Look until `done`. Raises Failed with `failure` after `timeout_s` of device time."""
        deadline_s = self._deadline(timeout_s)
        while True:
            await self._clock.sleep(POLL_S)
            if done(await self.state()):
                return
            if self.device.device_time_s() > deadline_s:
                raise Failed(f"{failure} within {timeout_s:.1f} s")

    async def pass_time(self, seconds: float) -> None:
        """Return when so much device time has passed."""
        until_s = self._deadline(seconds)
        while self.device.device_time_s() < until_s:
            await self._clock.sleep(POLL_S)

    async def call_here(self, position: int) -> None:
        """Call the place where the motor rests `position`."""
        self.shift -= await self._stops.set_position(self.axis, position)

    # --- settings -------------------------------------------------------------------------------

    async def set_tolerance(self, tolerance: int) -> None:
        await self.device.registers.write(self._rows.tolerance.name, self.axis, value=tolerance)

    async def borrow(self, field: str, value: int) -> None:
        """Set a field of the reference register until `give_back`."""
        register = self._rows.reference
        part = register.field_named(field)
        assert part is not None
        held = (await self.device.registers.read(register.name, self.axis)).fields[part.name]
        if held != value:
            await self.device.registers.write(register.name, self.axis, fields={part.name: value})
        before = self._borrowed.get(part.name, (held, value))[0]
        self._borrowed[part.name] = (before, value)

    async def give_back(self) -> None:
        """Put borrowed fields back; what is not as we left it another client has set meanwhile, and stays."""
        if not self._borrowed:
            return
        register = self._rows.reference.name
        held = (await self.device.registers.read(register, self.axis)).fields
        restored: dict[str, int | str] = {
            name: before for name, (before, ours) in self._borrowed.items() if held[name] == ours != before
        }
        if restored:
            await self.device.registers.write(register, self.axis, fields=restored)

    async def _arm(self) -> None:
        await self.device.registers.write(self._rows.x_latched.name, self.axis, value=0)

    # --- times ----------------------------------------------------------------------------------

    def _deadline(self, seconds: float) -> float:
        return self.device.device_time_s() + seconds

    def _known(self) -> RampParameters:
        ramp = self._memory.ramp(self.axis)
        assert ramp is not None  # the search begins with reading it
        return ramp

    def _seconds_for(self, travel: int) -> float:
        """More than a way takes at the search speed [s]."""
        pps = self.speed * self.device.clock_hz / (2 ** self._known().pulse_div * 2048 * 32)
        return float(1.5 * travel / pps + SLACK_S)

    def _seconds_to_first_unit(self) -> float:
        """More than the velocity takes from 0 to one chip unit: meanwhile v_actual reads 0 [s]."""
        ramp = self._known()
        return float(2 * 256 / max(1, ramp.a_max) * 32 * 2**ramp.ramp_div / self.device.clock_hz) + POLL_S / 2


def _blocker(state: AxisState) -> str:
    active = [side for side in ("left", "right") if getattr(state.switches, side)]
    return f"the {' and '.join(active)} switch is active" if active else "nothing says why it stopped"
