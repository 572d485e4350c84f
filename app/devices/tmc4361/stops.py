"""Stops, ahead of everything that waits for the link; and setting the position of an axis that stands.

Writing VMAX 0 alone is not allowed while an S-ramp is positioning (DS-TMC4361 8.2.2, case 2). So "ramp" writes the
least VMAX that is not 0, which the same section offers for a way out, then velocity mode, then VMAX 0. "immediate" does
the same with velocity mode on hold ramps, in which VACTUAL is VMAX at once (DS-TMC4361 8.2). Should the link fail in
between, the axis is left at a pulse in four minutes: the other order, mode first, would leave it turning at its speed
limit for good.

A START_CONF that makes VMAX or RAMPMODE wait for a start signal would make the stop wait too: its bits go first, and
stay cleared.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

from ...errors import BenchError, LinkDown, LinkTimeout, OutOfRange, WriteRefused, WrongState
from ...links.queue import Priority
from ...registers.model import to_raw
from ..core.register_io import Held, Words, Write
from ..core.results import StopMode, StopOutcome
from . import prediction as foresight
from . import rows
from .moves import Moves
from .setting import Setting

LOWEST, HIGHEST = -(1 << 31), (1 << 31) - 1
STATE = (rows.XACTUAL, rows.VACTUAL, rows.AACTUAL)
ELECTRICAL_TURN = 1024
GATES = rows.GATE_VMAX.mask | rows.GATE_RAMPMODE.mask


class Stops(Moves):
    """A TMC4361 that can be stopped."""

    # --- stops ----------------------------------------------------------------------------------

    async def _stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        began = time.perf_counter()
        outcomes = []
        for axis in axes:
            self.stops[axis] += 1  # before anything waits: what is under way for this axis gives up
            self.commanded(axis, "stop", mode=mode)
            async with self.queue.turn(Priority.STOP) as turn:
                problem = await self._stop(self.words(turn), mode)
            outcomes.append(StopOutcome(self.id, axis, problem is None, (time.perf_counter() - began) * 1e3, problem))
        return outcomes

    async def _stop(self, words: Words, mode: StopMode) -> BenchError | None:
        problem: BenchError | None = None
        for attempt in (1, 2):  # a stop moves nothing, so it may be sent again
            try:
                stands = attempt == 1 and await self._look_before_stop(words)
                return await self._send_stop(words, mode, stands=stands)
            except LinkDown as error:
                return error
            except (LinkTimeout, BenchError) as error:
                # The second time nothing is asked before: what was last seen has to do.
                problem = error
        self._motion_uncertain(str(problem))
        return problem

    async def _look_before_stop(self, words: Words) -> bool:
        """Whether the axis stands; the ramp is read along."""
        asked = (*STATE, *rows.RAMP)
        held = Held(asked, await words.read_many(asked))
        self._saw(held)
        return held.word(rows.VACTUAL) == held.word(rows.AACTUAL) == 0

    async def _send_stop(self, words: Words, mode: StopMode, *, stands: bool) -> BenchError | None:
        setting = self.setting()
        at_once = mode == "immediate" or (setting is not None and setting.never_slows())
        shape = rows.HOLD if at_once else self.cruise.shape
        slow, to_mode, to_zero = Write(rows.VMAX, 1), Write(rows.RAMPMODE, shape), Write(rows.VMAX, 0)
        gates = 0 if setting is None else setting.value(rows.START_CONF) & GATES
        ungate = [Write(rows.START_CONF, setting.value(rows.START_CONF) & ~GATES)] if setting and gates else []
        self.cruise.overwrite_mode(shape)
        self.cruise.overwrite_vmax(0)
        checked = (rows.RAMPMODE, rows.VMAX, *STATE)
        order = (to_zero, to_mode) if stands else (slow, to_mode, to_zero)
        held = Held(checked, (await words.chain(*ungate, *order, checked))[0])
        self._watch.stop_commanded(words.time_s)
        if held.value(rows.RAMPMODE) != shape or held.value(rows.VMAX) != 0:
            # One flipped bit on the way back looks like a refused write; a stop may be sent twice.
            held = Held(checked, (await words.chain(*ungate, *order, checked, again=True))[0])
        self._saw(held)
        for register, wanted in ((rows.RAMPMODE, shape), (rows.VMAX, 0)):
            if held.value(register) != wanted:
                return WriteRefused(register.name, wanted, held.word(register), "stop again, or cut the power")
        self._expect_stop(words.time_s, setting, shape, held)
        return None

    def _expect_stop(self, time_s: float, setting: Setting | None, shape: int, held: Held) -> None:
        plan = None
        velocity = held.value(rows.VACTUAL)
        if setting is not None and velocity:
            plan = foresight.to_velocity(setting, shape, 0.0, velocity, held.value(rows.AACTUAL))
        self._expect(time_s, held.value(rows.XACTUAL), plan)

    # --- setting the position -------------------------------------------------------------------

    async def set_position(self, axis: int, position: int, *, with_encoder: bool = True) -> int:
        """Call the place where the motor stands `position`; XTARGET and the encoder follow. Returns the difference.

        Without `with_encoder` ENC_POS stays as it is: where the encoder is absolute, it alone knows its place.

        The axis is in velocity mode with VMAX 0 afterwards, as after a stop. Regulation is off for the moment in which
        position and encoder disagree, and CL_OFFSET turns with the encoder, so that the field stays where it is.
        Raises WrongState while the motor turns, OutOfRange outside 32 bits.
        """
        self.axis(axis)
        if not LOWEST <= position <= HIGHEST:
            raise OutOfRange("position", position, LOWEST, HIGHEST, "microsteps")
        self.require_connected()
        if self.limiter is not None:
            self.limiter.require_target(axis, position)
        # No guard: a stop that comes between changes nothing here, and nothing here sets the motor in motion.
        async with self.queue.turn(Priority.COMMAND) as turn:
            words = self.words(turn)
            asked = (*STATE, rows.ENC_POS, rows.ENC_IN_CONF, rows.CL_OFFSET, rows.GENERAL_CONF, rows.RAMPMODE)
            read = Held(asked, await words.read_many(asked))
            if read.word(rows.VACTUAL) or read.word(rows.AACTUAL):
                raise WrongState(f"axis {axis} moves", "stop it first")
            before = read.value(rows.XACTUAL)
            shift = before - position
            turned = -shift if rows.REVERSED.unpack(read.word(rows.GENERAL_CONF)) else shift
            offset = read.value(rows.CL_OFFSET) + turned
            enc_in_conf, mode = read.word(rows.ENC_IN_CONF), read.word(rows.RAMPMODE) & 3
            regulated = rows.REGULATION.unpack(enc_in_conf) != 0
            self.commanded(axis, "set_position", position=position)
            self.cruise.overwrite_mode(mode)
            self.cruise.overwrite_vmax(0)
            steps = [
                Write(rows.VMAX, 0),
                Write(rows.RAMPMODE, mode),
                *([Write(rows.ENC_IN_CONF, rows.REGULATION.pack(0, enc_in_conf))] if regulated else []),
                Write(rows.XACTUAL, to_raw(position, 32)),
                Write(rows.XTARGET, to_raw(position, 32)),
                *(
                    [
                        Write(rows.ENC_POS, to_raw(read.value(rows.ENC_POS) - shift, 32)),
                        Write(rows.CL_OFFSET, to_raw(_half_turn(offset), 32)),
                    ]
                    if with_encoder
                    else []
                ),
                *([Write(rows.ENC_IN_CONF, enc_in_conf)] if regulated else []),
            ]
            checked = (rows.XACTUAL, rows.XTARGET, rows.RAMPMODE, rows.VMAX)
            back = Held(checked, (await words.chain(*steps, checked))[0])
            self._saw(back)
            self._book.end(words.time_s, "the position was set")
        for register in (rows.XACTUAL, rows.XTARGET):
            if back.value(register) != position:
                raise WriteRefused(
                    register.name, to_raw(position, 32), back.word(register), f"{rows.XACTUAL.name} was {before}"
                )
        return shift

    async def position_from_encoder(self, axis: int) -> int:
        """Call the place where the motor stands what its encoder shows; the difference. Raises WrongState."""
        if not self.known(rows.ENC_CONST):
            raise WrongState("no encoder counts on this axis", "write ENC_IN_RES first")
        encoder = (await self.read(rows.ENC_POS.name, axis)).value
        return await self.set_position(axis, encoder, with_encoder=False)

    async def clear_flags(self, axis: int) -> None:
        """Take notice of EVENTS, as reading it does: an axis that an event holds goes on to its target."""
        self.axis(axis)
        await self.read(rows.EVENTS.name, axis)


def _half_turn(offset: int) -> int:
    """An electrical angle as -512..511."""
    return (offset + ELECTRICAL_TURN // 2) % ELECTRICAL_TURN - ELECTRICAL_TURN // 2
