"""What writes to a ramp generator's registers do besides storing a word, and how motions are predicted after them."""

from __future__ import annotations

from collections.abc import Sequence

from ...errors import BenchError, WriteRefused
from ...registers.model import Register
from ..core.events import MotionStarted
from ..core.register_file import RegisterRules, changes_by_itself
from ..core.register_io import RegisterIO
from ..core.register_link import RegisterLink
from .axis_roles import HOLD_MODE, POSITIONING_MODES, RAMP_MODE, VELOCITY_MODE
from .interrupts import Interrupts
from .memory import RampMemory
from .prediction import Origin, TickedBook
from .ramp_parameters import RampParameters, distance


class RampWrites(RegisterRules):
    """The side effects of the registers of a ramp generator chip."""

    def __init__(
        self, link: RegisterLink, memory: RampMemory, books: Sequence[TickedBook], interrupts: Interrupts
    ) -> None:
        self._link = link
        self._session = link.session
        self._memory = memory
        self._books = books
        self._interrupts = interrupts
        self._motion = {
            register.address: axis
            for axis, rows in enumerate(memory.rows)
            for register in (
                *RampParameters.rows(rows),
                rows.x_target,
                rows.x_actual,
                rows.v_target,
                rows.v_actual,
                rows.tolerance,
            )
        }
        """Registers whose write may move or stop an axis."""
        self._before: dict[int, tuple[int, int, float]] = {}
        """Per axis: x_actual and v_actual just before a write, and when the write went out."""

    def remembers(self, register: Register) -> bool:
        return self._memory.remembers(register)

    def saw(self, register: Register, word: int) -> None:
        self._memory.saw(register, word)

    def shown(self, register: Register, word: int) -> int:
        return self._interrupts.shown(register, word)

    def sent(self, register: Register, word: int) -> None:
        self._interrupts.sent(register, word)
        axis = self._motion.get(register.address)
        if axis is not None:
            x_actual, v_actual, _ = self._before.get(axis, (0, 1, 0.0))
            self._before[axis] = (x_actual, v_actual, self._session.port.last_exchange_s)
            self._session.commanded(axis, register.name)

    async def before_write(self, io: RegisterIO, register: Register, word: int) -> list[str]:
        axis = self._motion.get(register.address)
        if axis is None:
            return []
        rows = self._memory.rows[axis]
        x_actual, v_actual = await io.value(rows.x_actual), await io.value(rows.v_actual)
        self._before[axis] = (x_actual, v_actual, io.time_s)
        notes: list[str] = []
        if register is rows.v_actual:
            mode = rows.mode.unpack(await io.read(rows.reference))
            if mode != HOLD_MODE:
                raise WriteRefused(register.name, word, register.encode(v_actual), "writable in HOLD_MODE only")
        elif register is rows.x_actual:
            mode = rows.mode.unpack(await io.read(rows.reference))
            if mode in POSITIONING_MODES and await io.value(rows.x_target) != register.decode(word):
                notes.append(f"in {rows.mode.values[mode]} the motor now drives to {rows.x_target.name}")
        elif register is rows.dividers:
            notes += await self._divider_notes(io, axis, word)
        elif register is rows.a_max and register.decode(word) == 0 and v_actual:
            notes.append("the motor turns and cannot change its speed any more; only an immediate stop ends it")
        return notes

    async def _divider_notes(self, io: RegisterIO, axis: int, word: int) -> list[str]:
        rows = self._memory.rows[axis]
        held = await io.read(rows.dividers)
        if rows.pulse_div.unpack(held) == rows.pulse_div.unpack(word):
            return []
        mode = rows.mode.unpack(await io.read(rows.reference))
        if mode == RAMP_MODE:
            return []
        return [f"pulse_div changed in {rows.mode.values[mode]}: it may have forced a microstep (DS-TMC428 8.14)"]

    async def explain(self, io: RegisterIO, register: Register, word: int, back: int) -> str | None:
        axis = register.axis
        if axis is None:
            return changes_by_itself(register, back)
        rows = self._memory.rows[axis]
        if register is rows.x_latched:
            return "the latch is armed and waits for the reference switch; the value itself cannot be written"
        if register is rows.v_target:
            mode = rows.mode.unpack(await io.read(rows.reference))
            if mode == VELOCITY_MODE:
                return None  # there it has to stay as written
            return f"in {rows.mode.values[mode]} the ramp generator sets {register.name}; it is yours in VELOCITY_MODE"
        if register is rows.x_actual:
            if self._moving_now(await self._memory.read_ramp(io, axis), axis, await io.value(rows.v_actual)):
                return f"the motor moves: it is at {register.decode(back)} now"
            x_target = await io.value(rows.x_target)
            return f"the motor drove on to {x_target}" if register.decode(back) == x_target else None
        if register is rows.v_actual:
            return None  # in HOLD_MODE nobody else sets it
        return changes_by_itself(register, back)

    @staticmethod
    def _moving_now(ramp: RampParameters, axis: int, v_actual: int) -> bool:
        del axis
        return bool(v_actual) or (ramp.mode in POSITIONING_MODES and bool(ramp.v_max and ramp.a_max))

    async def settle(self, io: RegisterIO, register: Register, *, read_back: bool) -> None:
        axis = self._motion.get(register.address)
        if axis is not None:
            try:
                await self._predict(io, axis, register if read_back else None)
            except BenchError:
                # The write itself is done and verified; that the next read failed is not its failure.
                self._books[axis].end(self._session.port.last_exchange_s, f"{register.name} was written")

    async def _predict(self, io: RegisterIO, axis: int, written: Register | None) -> None:
        """Begin the prediction for whatever the axis does now; `written` was read back in this turn."""
        rows = self._memory.rows[axis]
        x_before, v_before, sent_s = self._before.pop(axis, (0, 1, 0.0))
        ramp = await self._memory.read_ramp(io, axis, () if written is None else (written,))

        async def value(register: Register) -> int:
            if register is written and self._memory.remembers(register):
                return register.decode(self._memory.word(register))
            return await io.value(register)

        x_target, v_target = await value(rows.x_target), await value(rows.v_target)
        if v_before == 0 and written not in (None, rows.x_actual, rows.v_actual):
            # From rest the start is known exactly: it was where the axis stood, when the datagram went out.
            v_actual, x_actual, time_s = 0, x_before, sent_s or io.time_s
        else:
            v_actual, x_actual, time_s = await value(rows.v_actual), await value(rows.x_actual), io.time_s
            if v_before == 0 and x_actual == x_before:
                v_actual, time_s = 0, min(time_s, sent_s) or time_s
        book = self._books[axis]
        to_go = distance(x_target, x_actual)
        positioning = ramp.mode in POSITIONING_MODES
        at_rest = v_actual == 0 and (
            not ramp.v_max or not ramp.a_max or (to_go == 0 if positioning else ramp.mode == HOLD_MODE or v_target == 0)
        )
        if at_rest or abs(to_go) >= 1 << 23:
            book.end(time_s, "a register was written")
            return
        book.begin(
            Origin(
                axis=axis,
                started_at_s=time_s,
                position=x_actual,
                distance=to_go if positioning else 0,
                velocity=max(-2047, v_actual),
                parameters=ramp.parameters(
                    self._session.clock_hz, ramp.mode, v_target=max(-2047, v_target), v_actual=max(-2047, v_actual)
                ),
            )
        )
        if v_before == 0:
            self._session.tell(MotionStarted(axis, time_s))
