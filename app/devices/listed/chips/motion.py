"""Moves, rotations and stops by a ramp generator that names of registers tell. Nothing is sent twice but a stop.

VMAX is the greatest speed of a move and the speed of a rotation, so that a rotation and a stop write over it: what the
user wants there comes back with the next move.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from ....errors import BadReply, BenchError, CannotMove, LinkDown, LinkError, OutOfRange, UsageError, WriteRefused
from ....links.queue import Priority
from ....registers.listed.ramp import BACKWARD, FORWARD, POSITION, Ramp
from ....registers.model import Register, to_raw
from ...core.axis_units import CHIP, to_position
from ...core.capabilities import Motion
from ...core.events import MotionStarted
from ...core.prediction import Prediction
from ...core.register_io import RegisterIO, Snapshot, Write
from ...core.register_link import RegisterLink
from ...core.results import AxisMove, MoveStarted, Rotating, StopMode, StopOutcome
from ...core.session import Session
from ...core.start_gate import ready_to_start
from ...core.stop_each import stop_each
from .ongoing import ChipMotions
from .state import ChipState

PPS = "pps"
OWN_UNIT = "sent as a number: nobody here knows what the speeds of this chip count in"
UNDER_WAY = "the axis may be under way: stop it"


@dataclass(eq=False)
class ChipMotion(Motion):
    """Of every axis that has a ramp generator; of none where the chip has none."""

    session: Session
    link: RegisterLink
    state: ChipState
    motions: ChipMotions

    # --- moves ----------------------------------------------------------------------------------

    async def move_together(self, moves: Sequence[AxisMove]) -> list[MoveStarted]:
        """One axis right after the other."""
        for move in moves:
            self.session.axis(move.axis)
        if len({move.axis for move in moves}) != len(moves):
            raise UsageError("an axis is named twice")
        self.session.require_connected()
        return [await self._move(move) for move in moves]

    async def _move(self, move: AxisMove) -> MoveStarted:
        ramp, warnings = self.state.ramps[move.axis], list[str]()
        async with self.link.command(move.axis) as turn:
            io = self.link.io(turn)
            reading = await self.motions.poll(io, ramp)
            target = self._target(move, ramp, reading.position, warnings)
            settings = [self._setting(ramp, row) for row in (ramp.acceleration, ramp.max_speed)]
            if self.session.limiter is not None:
                self.session.limiter.require_target(move.axis, target, reading.position)
            to_target, to_mode = _put(ramp.target, target), self._mode(ramp, POSITION)
            if reading.speed or reading.moves:
                writes = [to_target, *settings, to_mode]
            else:  # until the last word the target is where the axis stands, and nothing moves
                writes = [_put(ramp.target, reading.position), to_mode, *settings, to_target]
            await ready_to_start()
            self.session.commanded(move.axis, "move", target=target)
            back = await self._set_off(io, ramp, writes)
            self.motions.watches[move.axis].began("position", io.time_s, target)
            self._require_back(ramp, back, POSITION)
            if back.value(ramp.target) != target:
                held = back.word(ramp.target)
                raise WriteRefused(ramp.target.name, to_raw(target, ramp.target.width), held, UNDER_WAY)
        self.session.tell(MotionStarted(move.axis, io.time_s))
        return MoveStarted(move.axis, reading.position, target, io.time_s, None, warnings)

    def _target(self, move: AxisMove, ramp: Ramp, position: int, warnings: list[str]) -> int:
        wanted = to_position(self.state.mechanics(move.axis), move.target, move.unit)
        if move.unit != "microsteps":
            warnings.append(
                f"{move.unit} are reckoned with 256 counts a full step: nobody here knows how many there are"
            )
        elif wanted != move.target:
            warnings.append(f"rounded to {wanted} microsteps")
        target, row = position + wanted if move.relative else wanted, ramp.target
        if move.over_the_end:
            return row.decode(to_raw(target, row.width))
        if not row.minimum <= target <= row.maximum:
            raise OutOfRange(f"target of axis {move.axis}", target, row.minimum, row.maximum, "microsteps")
        if abs(target - position) > row.maximum:
            distance, most = target - position, row.maximum
            raise OutOfRange(f"distance of axis {move.axis}", distance, -most, most, "microsteps: go in two moves")
        return target

    def _setting(self, ramp: Ramp, row: Register) -> Write:
        """Speed or acceleration of a move, as the user has set it. Raises CannotMove for 0, and where nobody knows."""
        wanted = self.state.wanted(row)
        if not wanted:
            why = "is 0" if wanted == 0 and row.access.readable else "is 0, or cannot be read"
            raise CannotMove(f"the axis would not move: {row.name} {why}", f"write {row.name}", ramp.axis)
        return Write(row, wanted)

    # --- rotation -------------------------------------------------------------------------------

    async def rotate(self, axis: int, velocity: float, unit: str = PPS) -> Rotating:
        ramp = self.state.ramps[self.session.axis(axis).index]
        if unit not in (CHIP, PPS):
            raise UsageError(f"{unit} is no unit of this chip's speeds, {OWN_UNIT}; say {CHIP}")
        most = ramp.max_speed.maximum
        if not -most <= velocity <= most:
            raise OutOfRange("velocity", velocity, -most, most, OWN_UNIT)
        speed = round(velocity)
        if speed == 0 and velocity:
            raise OutOfRange("velocity", velocity, 1, most, "less than one is a standstill")
        self.session.require_connected()
        async with self.link.command(axis) as turn:
            io = self.link.io(turn)
            reading = await self.motions.poll(io, ramp)
            acceleration = [self._setting(ramp, ramp.acceleration)] if speed else []
            if self.session.limiter is not None:
                self.session.limiter.require_velocity(axis, speed)
                self.session.limiter.require_way(axis, speed, reading.position)
            mode = FORWARD if speed >= 0 else BACKWARD
            writes = [*acceleration, Write(ramp.max_speed, abs(speed)), self._mode(ramp, mode)]
            if reading.mode in (FORWARD, BACKWARD) and reading.mode != mode:
                writes = [*acceleration, self._mode(ramp, mode), Write(ramp.max_speed, abs(speed))]
            self.session.commanded(axis, "rotate", velocity=speed)
            back = await self._set_off(io, ramp, writes)
            self.motions.watches[axis].began("velocity", io.time_s)
            if speed == 0:
                self.motions.watches[axis].stop_commanded(io.time_s)
            self._require_back(ramp, back, mode)
        self.session.tell(MotionStarted(axis, io.time_s))
        return Rotating(axis, speed, float(speed), [OWN_UNIT] if unit == PPS else [])

    # --- stops ----------------------------------------------------------------------------------

    async def stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        """Ahead of everything that waits for this link: VMAX 0 in a velocity mode."""

        async def stop(axis: int) -> BenchError | None:
            async with self.session.queue.turn(Priority.STOP) as turn:
                return await self._stop(self.link.io(turn), self.state.ramps[axis], mode)

        return await stop_each(self.session, axes, mode, stop)

    async def _stop(self, io: RegisterIO, ramp: Ramp, mode: StopMode) -> BenchError | None:
        problem: BenchError | None = None
        for _ in (1, 2):  # a stop moves nothing, so it may be sent again
            try:
                problem = await self._send_stop(io, ramp, mode)
            except LinkDown as error:
                problem = error
                break
            except BenchError as error:
                problem = error
            if problem is None:
                return None
        self.motions.mark_unknown(ramp.axis)
        return problem

    async def _send_stop(self, io: RegisterIO, ramp: Ramp, mode: StopMode) -> BenchError | None:
        writes = [Write(ramp.max_speed, 0)]
        if mode == "immediate" or self.state.wanted(ramp.acceleration) == 0:
            writes.append(Write(ramp.acceleration, ramp.acceleration.maximum))
        for write in writes:
            self.state.overwrite(write.register, write.word)
        # The mode may stand in one word with those of other axes, which has to be read; VMAX 0 brakes meanwhile.
        register = ramp.mode.register
        ((held,),) = await io.chain(*writes, (register,))
        arrived = io.arrived
        checked = (register, ramp.position, ramp.speed)
        back = Snapshot(checked, (await io.chain(Write(register, ramp.mode.pack(FORWARD, held)), checked))[0])
        self.motions.watches[ramp.axis].stop_commanded(io.time_s)
        for row in checked:
            self.state.saw(row, back.word(row))
        self.session.saw_position(ramp.axis, back.value(ramp.position), io.asked_s)
        if not (arrived and io.arrived):
            return BadReply(self.session.port.name, "the stop may have arrived otherwise", b"")
        if ramp.mode.unpack(back.word(register)) != FORWARD:
            return WriteRefused(register.name, FORWARD, back.word(register), "stop again, or cut the power")
        return None

    # --- the rest -------------------------------------------------------------------------------

    def speed_limit_pps(self, axis: int) -> float:
        return float(self.state.ramps[self.session.axis(axis).index].max_speed.maximum)

    def prediction(self, axis: int) -> Prediction | None:
        """None: what its numbers count in is not known."""
        self.session.axis(axis)
        return None

    def _mode(self, ramp: Ramp, mode: int) -> Write:
        """Right after a poll, which has read the word."""
        return Write(ramp.mode.register, ramp.mode.pack(mode, self.state.word(ramp.mode.register) or 0))

    async def _set_off(self, io: RegisterIO, ramp: Ramp, writes: Sequence[Write]) -> Snapshot:
        """Send what sets an axis in motion, once; mode, target and position as they are then."""
        self.link.allow(writes)
        for write in writes:
            if write.register in (ramp.max_speed, ramp.acceleration):
                self.state.overwrite(write.register, write.word)
        checked = (ramp.mode.register, ramp.target, ramp.position)
        try:
            back = Snapshot(checked, (await io.chain(*writes, checked))[0])
        except LinkError:
            self.motions.mark_unknown(ramp.axis)
            raise
        for row in checked:
            self.state.saw(row, back.word(row))
        return back

    def _require_back(self, ramp: Ramp, back: Snapshot, mode: int) -> None:
        register = ramp.mode.register
        if ramp.mode.unpack(back.word(register)) != mode:
            raise WriteRefused(register.name, mode, back.word(register), UNDER_WAY)


def _put(register: Register, value: int) -> Write:
    return Write(register, to_raw(value, register.width))
