"""The position counter of a ramp generator chip: 24 bits, and no flag that tells of a reset.

What tells of one is the setting: a chip that runs has a speed limit and an acceleration, and after power-on it has
neither. So a setting that reads as after power-on, and did not before, is a reset; as it is where it reads so at the
first look of a connection, since nobody who has set a chip up for moving leaves it like that.
"""

from __future__ import annotations

from dataclasses import replace

from ...clock import Clock
from ...links.port import FramePort
from ...links.queue import Priority
from ...registers.model import Register
from ..core.config import DeviceConfig
from ..core.counter import CounterLook
from ..core.register_io import Words
from ..core.results import AxisState
from ..core.signs import Signs
from .prediction import POSITION_BITS
from .stops import RampStops

CLOCKS_PER_STEP = 32
"""The pulse generator makes a step in 32 clocks at the most: pulse_div 0, v_max 2047 of 2048 (DS-TMC428 8.14)."""


class RampCounter(RampStops):
    """`RampChip` whose position counter can be followed."""

    COUNTER_WRITES = frozenset({"set_position", "x_actual", "X_ACTUAL"})

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> None:
        super().__init__(device_id, config, port, clock)
        self._unset: list[bool | None] = [None] * len(self.axes)
        """Per axis whether its setting was seen last as after power-on; None before it was seen."""
        self._reset_seen = [False] * len(self.axes)
        """Per axis whether a reset was seen that `look` has not told of."""
        self._resets = [0] * len(self.axes)
        """Per axis how often a reset was seen."""

    async def axis_state(self, axis: int, priority: Priority = Priority.COMMAND) -> AxisState:
        state = await super().axis_state(axis, priority)
        self._judge_setting(axis)
        return state

    def signs(self, axis: int, state: AxisState) -> Signs:
        return replace(super().signs(axis, state), resets=self._resets[axis])

    def counter_bits(self, axis: int) -> int | None:
        self.axis(axis)
        return POSITION_BITS

    def speed_limit_pps(self, axis: int) -> float:
        self.axis(axis)
        return self.clock_hz / CLOCKS_PER_STEP

    def latch_register(self, axis: int) -> str | None:
        return self.rows[self.axis(axis).index].x_latched.name

    def _power_on_rows(self, axis: int) -> tuple[Register, ...]:
        rows = self.rows[axis]
        return rows.v_max, rows.a_max, rows.proportionality, rows.dividers

    async def look(self, axis: int) -> CounterLook:
        self.axis(axis)
        self.require_connected()
        async with self.queue.turn(Priority.COMMAND) as turn:
            words = Words(turn)
            count = await words.value(self.rows[axis].x_actual)
            asked_at_s = words.asked_s
            for register in self._power_on_rows(axis):
                word = await words.read(register)
                self._saw_word(register, word)
                if word != register.reset:
                    break  # one is enough
        self._judge_setting(axis)
        reset_seen, self._reset_seen[axis] = self._reset_seen[axis], False
        self.saw_position(axis, count, asked_at_s)
        return CounterLook(count, asked_at_s, reset_seen)

    async def refresh(self) -> None:
        await super().refresh()
        for axis in range(len(self.axes)):
            self._judge_setting(axis)

    def _judge_setting(self, axis: int) -> None:
        """See in what is remembered of the setting whether the chip was reset."""
        unset = all(self._known.get(register.address) == register.reset for register in self._power_on_rows(axis))
        if unset and self._unset[axis] is not True:
            self._reset_seen[axis] = True
            self._resets[axis] += 1
        self._unset[axis] = unset
