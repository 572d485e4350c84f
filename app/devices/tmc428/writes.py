"""What writes to a ramp generator's registers do besides storing a word, and how motions are foreseen after them."""

from __future__ import annotations

from ...errors import BenchError, WriteRefused
from ...links.queue import Priority
from ...registers.model import Register
from ..core.device import MotionStarted
from ..core.motion import Setting, distance
from ..core.register_io import Words
from .axis_rows import HOLD_MODE, POSITIONING_MODES, RAMP_MODE, VELOCITY_MODE
from .moves import RampMoves
from .prediction import Origin


class RampWrites(RampMoves):
    """`RampChip` that knows the side effects of its registers."""

    async def _before_write(self, words: Words, register: Register, word: int) -> list[str]:
        axis = self._motion.get(register.address)
        if axis is None:
            return await super()._before_write(words, register, word)
        rows = self.rows[axis]
        x_actual, v_actual = await words.value(rows.x_actual), await words.value(rows.v_actual)
        self._before[axis] = (x_actual, v_actual, words.time_s)
        notes: list[str] = []
        if register is rows.v_actual:
            mode = rows.mode.unpack(await words.read(rows.reference))
            if mode != HOLD_MODE:
                raise WriteRefused(register.name, word, register.encode(v_actual), "writable in HOLD_MODE only")
        elif register is rows.x_actual:
            mode = rows.mode.unpack(await words.read(rows.reference))
            if mode in POSITIONING_MODES and await words.value(rows.x_target) != register.decode(word):
                notes.append(f"in {rows.mode.values[mode]} the motor now drives to {rows.x_target.name}")
        elif register is rows.dividers:
            notes += await self._divider_notes(words, axis, word)
        elif register is rows.a_max and register.decode(word) == 0 and v_actual:
            notes.append("the motor turns and cannot change its speed any more; only an immediate stop ends it")
        return notes

    async def _divider_notes(self, words: Words, axis: int, word: int) -> list[str]:
        rows = self.rows[axis]
        held = await words.read(rows.dividers)
        if rows.pulse_div.unpack(held) == rows.pulse_div.unpack(word):
            return []
        mode = rows.mode.unpack(await words.read(rows.reference))
        if mode == RAMP_MODE:
            return []
        return [f"pulse_div changed in {rows.mode.values[mode]}: it may have forced a microstep (DS-TMC428 8.14)"]

    async def _explain(self, words: Words, register: Register, word: int, back: int) -> str | None:
        axis = register.axis
        if axis is None:
            return await super()._explain(words, register, word, back)
        rows = self.rows[axis]
        if register is rows.x_latched:
            return "the latch is armed and waits for the reference switch; the value itself cannot be written"
        if register is rows.v_target:
            mode = rows.mode.unpack(await words.read(rows.reference))
            if mode == VELOCITY_MODE:
                return None  # there it has to stay as written
            return f"in {rows.mode.values[mode]} the ramp generator sets {register.name}; it is yours in VELOCITY_MODE"
        if register is rows.x_actual:
            if self._moving_now(await self._read_setting(words, axis), axis, await words.value(rows.v_actual)):
                return f"the motor moves: it is at {register.decode(back)} now"
            x_target = await words.value(rows.x_target)
            return f"the motor drove on to {x_target}" if register.decode(back) == x_target else None
        if register is rows.v_actual:
            return None  # in HOLD_MODE nobody else sets it
        return await super()._explain(words, register, word, back)

    @staticmethod
    def _moving_now(setting: Setting, axis: int, v_actual: int) -> bool:
        del axis
        return bool(v_actual) or (setting.mode in POSITIONING_MODES and bool(setting.v_max and setting.a_max))

    async def _after_write(self, register: Register) -> None:
        axis = self._motion.get(register.address)
        if axis is not None:
            try:
                await self._foresee(axis)
            except BenchError:
                # The write itself is done and verified; that the next read failed is not its failure.
                self._books[axis].end(self.port.last_exchange_s, f"{register.name} was written")

    async def _foresee(self, axis: int) -> None:
        """Begin the prediction for whatever the axis does now."""
        rows = self.rows[axis]
        x_before, v_before, sent_s = self._before.pop(axis, (0, 1, 0.0))
        async with self.queue.turn(Priority.COMMAND) as turn:
            words = Words(turn)
            setting = await self._read_setting(words, axis)
            x_target = await words.value(rows.x_target)
            v_target = await words.value(rows.v_target)
            v_actual = await words.value(rows.v_actual)
            x_actual = await words.value(rows.x_actual)
            time_s = words.time_s
        if v_before == 0 and x_actual == x_before:
            # From rest the start is known exactly: it was when the datagram went out.
            v_actual, time_s = 0, min(time_s, sent_s) or time_s
        book = self._books[axis]
        to_go = distance(x_target, x_actual)
        positioning = setting.mode in POSITIONING_MODES
        at_rest = v_actual == 0 and (
            not setting.v_max
            or not setting.a_max
            or (to_go == 0 if positioning else setting.mode == HOLD_MODE or v_target == 0)
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
                parameters=setting.parameters(
                    self.clock_hz, setting.mode, v_target=max(-2047, v_target), v_actual=max(-2047, v_actual)
                ),
            )
        )
        if v_before == 0:
            self._tell(MotionStarted(axis, time_s))
