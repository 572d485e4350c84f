"""Breakpoints for devices that have none of their own: the program is done one command at a time until it is there.

That is slower than real time, and what runs in real time meanwhile (the motor, the device's timers) does not wait.
Whether a device serves interrupts while it is stepped is its own affair: an emulated module does not.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Collection
from dataclasses import dataclass
from typing import Literal

from ..calc.tmcl.flow import Flow, flow_of, may_move
from ..calc.tmcl.instructions import Command
from ..clock import Clock
from ..devices.core.capabilities import ProgramMemory
from ..devices.core.device import Device
from ..devices.core.results import ProgramEvent
from ..errors import OutOfRange, UsageError
from .procedure import POLL_S, Ended, Procedure, State

BREAKPOINTS_MAX = 64
TRACE_MAX = 1000
"""Addresses that are kept of a run."""
STEP_S = 0.001
"""From one step to the next at least [s]: others want the server, too."""
LINK_SHARE = 0.5
"""How much of the wire's time the steps may take."""
Mode = Literal["run", "over", "out"]

_WORDS = {
    "run": "by single steps",
    "over": "one command, or one subroutine",
    "out": "to the end of the subroutine",
}


@dataclass(frozen=True, slots=True)
class DebugState:
    """A run by single steps, or how the latest one ended."""

    state: State
    mode: Mode
    breakpoints: tuple[int, ...]
    halted_at: int | None
    """Address of the breakpoint that ended it."""
    steps: int
    steps_per_s: float | None
    message: str


IDLE = DebugState("idle", "run", (), None, 0, None, "")


class Debugging(Procedure):
    """Steps from where the program is until a breakpoint, its end, or a command.

    "over" steps once, and through the whole subroutine where the command calls one; "out" steps until the subroutine
    that it is in has returned.
    """

    kind = "debugged program"

    def __init__(
        self, device: Device, clock: Clock, mode: Mode, breakpoints: Collection[int], from_start: bool = False
    ) -> None:
        """`from_start` resets the program first: a device can go to no other address without running from there."""
        super().__init__(device, 0, clock)
        self._program = device.need(ProgramMemory)
        self._memory = self._program.instructions.memory
        self.mode: Mode = mode
        self.breakpoints = self._checked(breakpoints)
        self._from_start = from_start
        self.halted_at: int | None = None
        self.steps = 0
        self.trace: deque[int] = deque(maxlen=TRACE_MAX)
        """Addresses of the commands that were done, the latest last."""
        self._at: int | None = None
        self._pausing = False
        self._began_s = clock.now()
        self._took_s = 0.0
        self._commands: dict[int, Command] = {}

    def set_breakpoints(self, breakpoints: Collection[int]) -> None:
        """From the next step on. Raises OutOfRange, UsageError."""
        self.breakpoints = self._checked(breakpoints)

    def pause(self) -> None:
        """End before the next command. The motor goes on as it was told last."""
        self._pausing = True

    @property
    def state(self) -> DebugState:
        took_s = self.clock.now() - self._began_s if self.running else self._took_s
        rate = self.steps / took_s if took_s > 0 and self.steps else None
        return DebugState(
            self._how, self.mode, tuple(sorted(self.breakpoints)), self.halted_at, self.steps, rate, self.message
        )

    def _checked(self, breakpoints: Collection[int]) -> frozenset[int]:
        if len(breakpoints) > BREAKPOINTS_MAX:
            raise UsageError(f"{len(breakpoints)} breakpoints; at most {BREAKPOINTS_MAX}")
        for address in breakpoints:
            if not 0 <= address < self._memory:
                raise OutOfRange("address of a breakpoint", address, 0, self._memory - 1)
        return frozenset(breakpoints)

    async def _run(self) -> None:
        if self._from_start:
            await self._program.reset_program()
        words = _WORDS[self.mode]
        where = f" until {', '.join(map(str, sorted(self.breakpoints)))}" if self.breakpoints else ""
        steps = self._program.stepping(f"debug program: {words}{where}")
        at = self._at = await steps.counter()
        if self.mode == "run":
            self._mark(f"program by single steps from {at}")
        depth, back = 0, None
        while True:
            command = await self._command(at)
            began_s = self.clock.now()
            after = await steps.step(may_move(command))
            self.steps += 1
            self.trace.append(at)
            flow = flow_of(command)
            while flow is Flow.WAITS and after == at and not self._pausing:
                await self.clock.sleep(POLL_S)  # stepping it again would begin the wait anew
                after = await steps.counter()
            if flow is Flow.CALLS and after == command.value:
                depth += 1
                if back is None:
                    back = at + 1
            elif flow is Flow.RETURNS:
                depth -= 1
            if after == at and flow in (Flow.ENDS, Flow.GOES_ON):
                await self._ended(flow, at)
                return
            at = self._at = after
            if (self.mode == "over" and depth <= 0 and (back is None or at == back)) or (
                self.mode == "out" and depth < 0
            ):
                self.message = f"at {at}"
                return
            if at in self.breakpoints:
                self.halted_at = at
                self.message = f"halted at {at}, a breakpoint"
                return
            if self._pausing:
                self.message = f"paused at {at}"
                return
            took_s = self.clock.now() - began_s
            await self.clock.sleep(max(STEP_S, took_s * (1 / LINK_SHARE - 1)))

    async def _command(self, at: int) -> Command:
        if at not in self._commands:
            if not 0 <= at < self._memory:
                return Command(0)  # beyond the end: the device says what it thinks of it
            self._commands[at] = (await self._program.read_program(at, 1))[0]
        return self._commands[at]

    async def _ended(self, flow: Flow, at: int) -> None:
        """The counter has not moved: the program has ended, or the device refused the command."""
        state = await self._program.program_state()
        told = f", status {state.error}" if state.error and flow is not Flow.ENDS else ""
        self.message = f"the program ended at {at}{told}"

    def _over(self, how: Ended) -> None:
        self._how = how
        self._took_s = self.clock.now() - self._began_s
        self.message = self.message or how
        if self._at is not None:
            self._mark(f"program {self.message.removeprefix('the program ')}")

    def _mark(self, text: str) -> None:
        """A mark on the time axis of the scope and of recordings."""
        session = self.device.session
        session.tell(ProgramEvent(self.axis, session.port.last_exchange_s, self._at, text))

    async def _give_back(self) -> None:
        """It borrows nothing."""
