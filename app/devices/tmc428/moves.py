"""Moves and rotation: everything is read and judged first, then one datagram starts each axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from ...calc.units.tmc428 import pulse_rate_hz
from ...errors import UsageError, WriteRefused
from ...links.queue import Priority
from ...number_text import plain
from ...registers.model import to_raw
from ..core.axis_units import to_position
from ..core.capabilities import Motion
from ..core.events import MotionStarted
from ..core.prediction import Prediction
from ..core.register_io import RegisterIO
from ..core.register_link import RegisterLink
from ..core.results import AxisMove, MoveStarted, Rotating, StopMode, StopOutcome
from ..core.start_gate import ready_to_start
from .axis_roles import HOLD_MODE, POSITIONING_MODES, RAMP_MODE, VELOCITY_MODE, AxisRoles
from .memory import RampMemory
from .prediction import Origin, TickedBook, TickedPrediction
from .ramp_parameters import RampParameters, checked_target, distance
from .stops import RampStops
from .switching import Switching
from .velocity_units import one_chip_unit, to_chip_velocity

CLOCKS_PER_STEP = 32
"""The pulse generator makes a step in 32 clocks at the most: pulse_div 0, v_max 2047 of 2048 (DS-TMC428 8.14)."""


@dataclass(slots=True)
class _Prepared:
    """One axis of a move, ready to start."""

    axis: int
    rows: AxisRoles
    ramp: RampParameters
    x_actual: int
    v_actual: int
    target: int
    warnings: list[str] = field(default_factory=list)
    started_at_s: float = 0.0

    @property
    def positioning(self) -> bool:
        return self.ramp.mode in POSITIONING_MODES

    @property
    def mode(self) -> int:
        """The ramp mode that the move uses."""
        return self.ramp.mode if self.positioning else RAMP_MODE


class RampMotion(Motion):
    """Sends the axes of a ramp generator chip somewhere. `books` are the predictions by axis."""

    def __init__(
        self,
        link: RegisterLink,
        memory: RampMemory,
        switching: Switching,
        books: Sequence[TickedBook],
        stops: RampStops,
    ) -> None:
        self._link = link
        self._session = link.session
        self._memory = memory
        self._switching = switching
        self._books = books
        self._stops = stops

    def speed_limit_pps(self, axis: int) -> float:
        self._session.axis(axis)
        return self._session.clock_hz / CLOCKS_PER_STEP

    def prediction(self, axis: int) -> Prediction | None:
        self._session.axis(axis)
        return self._books[axis].present()

    async def stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        return await self._stops.stop_axes(axes, mode)

    # --- moves ----------------------------------------------------------------------------------

    async def move_together(self, moves: Sequence[AxisMove]) -> list[MoveStarted]:
        axes = [self._session.axis(move.axis).index for move in moves]
        if len(set(axes)) != len(axes):
            raise UsageError("an axis is named twice in one move")
        if not axes:
            raise UsageError("a move of no axis")
        self._session.require_connected()
        async with self._session.queue.turn(Priority.COMMAND, self._session.stop_guard(axes)) as turn:
            io = RegisterIO(turn)
            common = await self._switching.motion_warnings(io)
            prepared = [await self._prepare(io, move) for move in moves]
            self._allow_moves(prepared)
            await ready_to_start()
            for one in prepared:
                if not one.positioning:  # there x_target has no effect yet, and the mode starts the move
                    await io.put(one.rows.x_target, one.target)
            for one in prepared:
                await self._start(io, one)
            for one in prepared:
                await self._check_target(io, one)
        started = []
        for one in prepared:
            prediction = self._predict(one)
            started.append(
                MoveStarted(
                    one.axis,
                    one.x_actual,
                    one.target,
                    one.started_at_s,
                    prediction.duration_s if prediction.ends else None,
                    common + one.warnings,
                )
            )
            self._session.tell(MotionStarted(one.axis, one.started_at_s))
        return started

    async def retarget(self, axis: int, count_target: int) -> MoveStarted:
        """On the way to a target only the target is written: half the datagrams, and no ramp is worked out ahead."""
        self._session.axis(axis)
        self._session.require_connected()
        rows, ramp, not_stopped = (
            self._memory.rows[axis],
            self._memory.ramp(axis),
            self._session.stop_guard([axis]),
        )
        async with self._session.queue.turn(Priority.COMMAND, not_stopped) as turn:
            io = RegisterIO(turn)
            reference = await io.read(rows.reference)
            v_actual = await io.value(rows.v_actual)
            x_actual = await io.value(rows.x_actual)
            positioning = rows.mode.unpack(reference) in POSITIONING_MODES
            under_way = ramp is not None and positioning and v_actual and ramp.reference == reference
            if under_way:
                assert ramp is not None
                one = _Prepared(axis, rows, ramp, x_actual, v_actual, count_target)
                self._allow_moves([one])
                await self._start(io, one)
                await self._check_target(io, one)
                self._predict(one)
                self._session.tell(MotionStarted(axis, one.started_at_s))
                return MoveStarted(axis, x_actual, count_target, one.started_at_s, None, [])
        not_stopped()  # from here on a move looks out for itself
        return await super().retarget(axis, count_target)

    async def _prepare(self, io: RegisterIO, move: AxisMove) -> _Prepared:
        """Read what decides, and refuse what cannot go well. Nothing is written."""
        rows = self._memory.rows[move.axis]
        ramp = await self._memory.read_ramp(io, move.axis)
        ramp.require_motion(move.axis)
        ramp.require_proportionality(move.axis)
        warnings = ramp.proportionality_warnings()
        left, right = await self._switching.read(io, move.axis)
        v_actual = await io.value(rows.v_actual)
        x_actual = await io.value(rows.x_actual)
        wanted = to_position(self._memory.mechanics(move.axis), move.target, move.unit)
        if move.unit == "microsteps" and wanted != move.target:
            warnings.append(f"rounded to {wanted} microsteps")
        shown = "" if move.unit == "microsteps" else f"; {plain(move.target)} {move.unit} asked"
        target = x_actual + wanted if move.relative else wanted
        if not move.over_the_end:
            checked_target(move.axis, target, x_actual, shown)
        switch = ramp.blocked(rows, distance(target, x_actual), left, right)
        if switch:
            warnings.append(f"the {switch} switch is active and stops motion that way")
        return _Prepared(move.axis, rows, ramp, x_actual, v_actual, target, warnings)

    def _allow_moves(self, prepared: Sequence[_Prepared]) -> None:
        """Raises SoftLimit before anything of these moves is sent."""
        if self._session.limiter is None:
            return
        for one in prepared:
            self._session.limiter.require_target(one.axis, distance(one.target, 0), one.x_actual)
            mode = one.rows.with_mode(one.ramp.reference, one.mode)
            target = (one.rows.x_target.address, to_raw(one.target, one.rows.x_target.width))
            self._session.limiter.check_writes(
                [target] if one.positioning else [target, (one.rows.reference.address, mode)]
            )

    async def _start(self, io: RegisterIO, one: _Prepared) -> None:
        """Exactly one datagram, which sets the axis in motion."""
        if one.positioning:
            await io.put(one.rows.x_target, one.target)
        else:
            await io.write(one.rows.reference, one.rows.with_mode(one.ramp.reference, RAMP_MODE))
        one.started_at_s = io.time_s
        self._session.commanded(one.axis, "move", target=one.target)

    async def _check_target(self, io: RegisterIO, one: _Prepared) -> None:
        rows = one.rows
        back = await io.value(rows.x_target)
        mode = await io.read(rows.reference)
        self._memory.saw(rows.reference, mode)
        if back != one.target:
            raise WriteRefused(rows.x_target.name, one.target, back, f"axis {one.axis} may go there: stop it")
        if rows.mode.unpack(mode) != one.mode:
            raise WriteRefused(rows.reference.name, one.mode, mode, f"axis {one.axis} did not take RAMP_MODE")

    def _predict(self, one: _Prepared) -> TickedPrediction:
        return self._books[one.axis].begin(
            Origin(
                axis=one.axis,
                started_at_s=one.started_at_s,
                position=one.x_actual,
                distance=distance(one.target, one.x_actual),
                velocity=one.v_actual,
                parameters=one.ramp.parameters(self._session.clock_hz, one.mode),
            )
        )

    # --- rotation -------------------------------------------------------------------------------

    def _allow_rotation(self, axis: int, ramp: RampParameters, asked: float, chip: int, x_actual: int) -> int:
        """Raises SoftLimit before anything of a rotation is sent; the velocity in chip units, within the limit.

        `asked` is what was asked for, in chip units and not rounded.
        """
        limiter, rows = self._session.limiter, self._memory.rows[axis]
        assert limiter is not None
        unit_pps = pulse_rate_hz(1, ramp.pulse_div, self._session.clock_hz)
        limiter.require_velocity(axis, asked * unit_pps)
        limiter.require_way(axis, chip, x_actual)
        chip = limiter.rounded(axis, chip, unit_pps)
        target = (rows.v_target.address, to_raw(chip, rows.v_target.width))
        limiter.check_writes([target, (rows.reference.address, rows.with_mode(ramp.reference, VELOCITY_MODE))])
        return chip

    async def rotate(self, axis: int, velocity: float, unit: str = "pps") -> Rotating:
        self._session.axis(axis)
        self._session.require_connected()
        rows = self._memory.rows[axis]
        async with self._session.queue.turn(Priority.COMMAND, self._session.stop_guard([axis])) as turn:
            io = RegisterIO(turn)
            ramp = await self._memory.read_ramp(io, axis)
            ramp.require_motion(axis)
            chip, warnings = to_chip_velocity(
                self._memory.mechanics(axis), velocity, unit, ramp.pulse_div, self._session.clock_hz, ramp.v_max
            )
            warnings += await self._switching.motion_warnings(io)
            left, right = await self._switching.read(io, axis)
            switch = ramp.blocked(rows, chip, left, right)
            if switch:
                warnings.append(f"the {switch} switch is active and stops motion that way")
            x_actual = await io.value(rows.x_actual)
            if self._session.limiter is not None:
                asked = velocity / one_chip_unit(
                    self._memory.mechanics(axis), unit, ramp.pulse_div, self._session.clock_hz
                )
                chip = self._allow_rotation(axis, ramp, asked, chip, x_actual)
            v_actual = await io.value(rows.v_actual)
            if ramp.mode != VELOCITY_MODE:
                if ramp.mode == HOLD_MODE:
                    # HOLD_MODE ignores v_target, so an old one may still stand there: replace it first.
                    await io.put(rows.v_target, chip)
                await io.write(rows.reference, rows.with_mode(ramp.reference, VELOCITY_MODE))
            await io.put(rows.v_target, chip)
            started_at_s = io.time_s
            self._session.commanded(axis, "rotate", velocity=chip)
            back = await io.value(rows.v_target)
            reference = await io.read(rows.reference)
            self._memory.saw(rows.reference, reference)
        if back != chip:
            raise WriteRefused(rows.v_target.name, chip, back, f"axis {axis} may turn at another speed: stop it")
        if rows.mode.unpack(reference) != VELOCITY_MODE:
            raise WriteRefused(rows.reference.name, VELOCITY_MODE, reference, f"axis {axis} did not take VELOCITY_MODE")
        parameters = ramp.parameters(self._session.clock_hz, VELOCITY_MODE, v_target=chip)
        self._books[axis].begin(Origin(axis, started_at_s, x_actual, 0, v_actual, parameters))
        self._session.tell(MotionStarted(axis, started_at_s))
        return Rotating(axis, chip, pulse_rate_hz(chip, ramp.pulse_div, self._session.clock_hz), warnings)
