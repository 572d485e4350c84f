"""What a write by hand does to a motion, besides storing a word; and what is expected after it."""

from __future__ import annotations

from ...errors import BenchError, LinkError
from ...links.queue import Priority
from ...registers.model import Register
from ..core.device import MotionStarted
from ..core.register_io import Held, Words
from ..core.sixpoint_plans import move_plan, turn_plan
from . import rows as r
from .moves import _signed
from .rows import AxisRows
from .stops import Stops


class Writes(Stops):
    """A TMC5xxx that knows the side effects of its registers."""

    _before_it: tuple[int, int, float] = (0, 1, 0.0)
    """XACTUAL and VACTUAL right before a write, and when the write went out."""

    def _moved_by(self, register: Register) -> AxisRows | None:
        """The axis that a write to `register` may move."""
        for rows in self.chip.axes:
            if register.axis == rows.axis and register.access.writable and register.address in rows.moving:
                return rows
        return None

    async def _before_write(self, words: Words, register: Register, word: int) -> list[str]:
        notes = self._notes(register, word)
        rows = self._moved_by(register)
        if rows is None:
            if register is self.chip.gconf and await self._turns_round(words, word):
                notes.append("a motor that moves now turns the other way at once")
            return notes
        asked = (rows.xactual, rows.vactual, rows.rampmode, rows.xtarget)
        held = Held(asked, await words.read_many(asked))
        self._saw(held)
        self._saw_positions(held, words.asked_s)
        position, target = held.value(rows.xactual), held.value(rows.xtarget)
        self._before_it = (position, held.word(rows.vactual), words.time_s)
        positioning = held.value(rows.rampmode) == r.POSITION
        if register is rows.xactual and positioning and register.decode(word) != target:
            notes.append("while positioning the motor now drives to XTARGET")
        elif register is rows.rampmode and word == r.POSITION and not positioning and target != position:
            notes.append(f"the motor now drives to XTARGET, {target}")
        return notes

    def _notes(self, register: Register, word: int) -> list[str]:
        """What a word does by itself."""
        for rows in self.chip.axes:
            if register is rows.chopconf and not r.part(register, "toff").unpack(word):
                return ["toff is 0: the driver is off"]
            if register is rows.ramp.get("VSTOP") and word < (self.word(rows.ramp["VSTART"]) or 0):
                return ["VSTOP is below VSTART: a short move may not end"]
            if register is rows.ramp.get("D1") and word == 0:
                return ["positioning must not have D1 0, even with V1 0"]
        return []

    async def _turns_round(self, words: Words, word: int) -> bool:
        """Whether GCONF `word` has another shaft direction than the chip's."""
        held = await words.read(self.chip.gconf)
        shafts = sum(part.mask for part in self.chip.gconf.fields if part.name.startswith("shaft"))
        return bool((held ^ word) & shafts)

    def _sent(self, register: Register, word: int) -> None:
        super()._sent(register, word)
        if self._moved_by(register) is not None:
            position, velocity, _ = self._before_it
            self._before_it = (position, velocity, self.port.last_exchange_s)

    async def _explain(self, words: Words, register: Register, word: int, back: int) -> str | None:
        for rows in self.chip.axes:
            if register is rows.xactual:
                velocity = await words.value(rows.vactual)
                return f"the motor moves: it is at {register.decode(back)} now" if velocity else None
        encoder = register.name == "ENCMODE" and r.part(register, "clr_once", "clr_cont").mask
        if encoder and not (word ^ back) & register.mask & ~encoder:
            return "clr_once has returned to 0 by itself"
        return await super()._explain(words, register, word, back)

    async def _after_write(self, register: Register) -> None:
        rows = self._moved_by(register)
        if rows is None:
            return
        try:
            await self._foresee(rows)
        except BenchError:
            # The write itself is done and judged; that the next reading failed is not its failure.
            self._books[rows.axis].end(self.port.last_exchange_s, f"{register.name} was written")

    async def _foresee(self, rows: AxisRows) -> None:
        """Begin the prediction for whatever the axis does now."""
        axis = rows.axis
        before_position, before_velocity, sent_s = self._before_it
        asked = (rows.rampmode, rows.sw_mode, rows.xactual, rows.vactual, rows.xtarget)
        async with self.queue.turn(Priority.COMMAND) as turn:
            words = self.words(turn)
            held = Held(asked, await words.read_many(asked))
            time_s = words.time_s
        self._saw(held)
        self._saw_positions(held, words.asked_s)
        position, velocity, target = (held.value(row) for row in (rows.xactual, rows.vactual, rows.xtarget))
        if before_velocity == 0 and position == before_position:
            # From rest the start is known exactly: it was when the datagram went out.
            velocity, time_s = 0, min(time_s, sent_s) or time_s
        mode, vmax, amax = held.value(rows.rampmode), self.word(rows.vmax), self.word(rows.amax)
        moves = target != position and vmax != 0 if mode == r.POSITION else vmax != 0 or velocity != 0
        if not moves or (mode == r.HOLD and not velocity):
            self._books[axis].end(time_s, "a register was written")
            return
        ramp = self.ramp(axis)
        unit = ramp.velocity_unit_pps
        if mode == r.POSITION:
            plan = move_plan(ramp.sixpoint(vmax, amax), _signed(target - position), velocity * unit)
            self._watches[axis].began("position", time_s, target)
        else:
            way = -1 if mode == r.BACKWARD else 1
            wanted = velocity if mode == r.HOLD else way * (vmax or 0)
            known = None if vmax is None else ramp.sixpoint(vmax or 1, amax)
            plan = turn_plan(known, wanted * unit, velocity * unit)
            self._watches[axis].began("velocity", time_s)
        self._expect(axis, time_s, position, plan)
        if before_velocity == 0:
            self._tell(MotionStarted(axis, time_s))

    async def _foresee_by_hand(self, rows: AxisRows) -> None:
        """A raw datagram has written something that may move the axis."""
        self._before_it = (0, 1, self.port.last_exchange_s)
        try:
            await self._foresee(rows)
        except LinkError as error:
            self._motion_uncertain(rows.axis, str(error))
