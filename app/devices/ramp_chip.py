"""The ramp generator that TMC428 and TMC4210 share: state, moves, rotation, stops, predictions."""

from __future__ import annotations

import time
from abc import abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, field

from app.calc.mechanics import Mechanics
from app.calc.units import acceleration_hz_s, pulse_rate_hz
from app.devices.axis_rows import HOLD_MODE, POSITIONING_MODES, RAMP_MODE, VELOCITY_MODE, AxisRows
from app.devices.axis_units import to_chip_velocity, to_position
from app.devices.config import DeviceConfig
from app.devices.device import MotionStarted
from app.devices.motion import Setting, checked_target, distance
from app.devices.prediction import Origin, Prediction, PredictionBook
from app.devices.register_chip import RegisterChip
from app.devices.results import (
    AxisMove,
    AxisState,
    MoveStarted,
    Rotating,
    StopMode,
    StopOutcome,
    Switches,
)
from app.devices.words import Words
from app.links.datagram32 import status_flags
from app.links.errors import BenchError, LinkDown, LinkTimeout, UsageError, WriteRefused
from app.links.port import FramePort
from app.links.queue import Priority
from app.registers.model import Access, Register


@dataclass(slots=True)
class _Prepared:
    """One axis of a move, ready to start."""

    axis: int
    rows: AxisRows
    setting: Setting
    x_actual: int
    v_actual: int
    target: int
    warnings: list[str] = field(default_factory=list)
    started_at_s: float = 0.0

    @property
    def positioning(self) -> bool:
        return self.setting.mode in POSITIONING_MODES

    @property
    def mode(self) -> int:
        """The ramp mode that the move uses."""
        return self.setting.mode if self.positioning else RAMP_MODE


class RampChip(RegisterChip):
    """A chip whose axes are ramp generators of this kind."""

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort) -> None:
        super().__init__(device_id, config, port)
        self.rows = tuple(self._axis_rows(axis) for axis in range(self.family.axes))
        self._books = tuple(PredictionBook() for _ in self.rows)
        self._known: dict[int, int] = {}
        """What the chip was last seen to hold, by address, of the registers that decide a motion."""
        self._remembered = frozenset(
            register.address for rows in self.rows for register in (*Setting.rows(rows), rows.x_target, rows.v_target)
        )
        self._motion = {
            register.address: axis
            for axis, rows in enumerate(self.rows)
            for register in (
                *Setting.rows(rows),
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

    # --- what differs ---------------------------------------------------------------------------

    @abstractmethod
    def _axis_rows(self, axis: int) -> AxisRows:
        """The registers of `axis`."""

    @abstractmethod
    def _microsteps(self, axis: int) -> int | None:
        """Microsteps per full step as the chip is set; None where not known yet."""

    @abstractmethod
    async def _switches(self, words: Words, axis: int) -> tuple[bool | None, bool | None]:
        """Left and right switch; None where there is none."""

    @abstractmethod
    def _reached(self, status: int, axis: int) -> bool:
        """Whether the status bits say that `axis` is at its target (xEQt)."""

    async def _motion_warnings(self, words: Words) -> list[str]:
        """Why steps may not get to the motor although the ramp generator runs."""
        return []

    # --- what is remembered ---------------------------------------------------------------------

    async def refresh(self) -> None:
        registers = [register for rows in self.rows for register in Setting.rows(rows)]
        for register in registers:
            async with self.queue.turn(Priority.COMMAND) as turn:
                self._saw_word(register, await Words(turn).read(register))

    def _saw_word(self, register: Register, word: int) -> None:
        if register.address not in self._remembered:
            return
        self._known[register.address] = word
        axis = register.axis
        if axis is not None and register is self.rows[axis].dividers:
            rows, known = self.rows[axis], self.axes[axis]
            known.pulse_div = min(rows.pulse_div.unpack(word), 13)
            known.ramp_div = min(rows.ramp_div.unpack(word), 13)
            known.microsteps_per_full_step = self._microsteps(axis)

    def _sent(self, register: Register, word: int) -> None:
        axis = self._motion.get(register.address)
        if axis is not None:
            x_actual, v_actual, _ = self._before.get(axis, (0, 1, 0.0))
            self._before[axis] = (x_actual, v_actual, self.port.last_exchange_s)
            self.commanded(axis, register.name)

    def setting(self, axis: int) -> Setting | None:
        """The setting of an axis as last seen; None before everything of it was seen once."""
        rows = self.rows[axis]
        if any(register.address not in self._known for register in Setting.rows(rows)):
            return None
        return Setting.of(rows, self._known)

    def mechanics(self, axis: int) -> Mechanics:
        """Conversions of an axis as the chip is set now."""
        return self.axes[axis].settings.mechanics(self._microsteps(axis) or 1)

    # --- state ----------------------------------------------------------------------------------

    async def axis_state(self, axis: int) -> AxisState:
        self.axis(axis)
        self.require_connected()
        rows = self.rows[axis]
        async with self.queue.turn(Priority.COMMAND) as turn:
            words = Words(turn)
            setting = await self._read_setting(words, axis)
            interrupts = await words.read(rows.interrupts)
            left, right = await self._switches(words, axis)
            x_target = await words.value(rows.x_target)
            v_target = await words.value(rows.v_target)
            a_actual = await words.value(rows.a_actual)
            v_actual = await words.value(rows.v_actual)
            x_actual = await words.value(rows.x_actual)
            time_s, status = words.time_s, words.status
        reached = self._reached(status, axis)
        flags = status_flags(status, self.status_names)
        flags |= {
            part.name: bool(part.unpack(interrupts)) for part in rows.interrupts.fields if part.access is Access.R_W1C
        }
        flags[rows.latch_waiting.name] = bool(rows.latch_waiting.unpack(setting.reference))
        to_go = distance(x_target, x_actual)
        home = right if rows.reference_right.unpack(setting.reference) else left
        return AxisState(
            position=x_actual,
            target_position=x_target,
            velocity_pps=pulse_rate_hz(v_actual, setting.pulse_div, self.clock_hz),
            target_velocity_pps=pulse_rate_hz(v_target, setting.pulse_div, self.clock_hz),
            acceleration_pps2=self._acceleration(a_actual, setting),
            position_reached=reached,
            moving=self._moving(rows, setting, v_actual, v_target, to_go, left, right),
            mode=rows.mode.values[setting.mode],
            switches=Switches(left, right, home),
            flags=flags,
            time_s=time_s,
        )

    def _acceleration(self, a_actual: int, setting: Setting) -> float:
        # a_actual is drawn with 12 signed bits; its extreme -2048 is no value that a_max can make.
        return acceleration_hz_s(max(-2047, a_actual), setting.pulse_div, setting.ramp_div, self.clock_hz)

    @staticmethod
    def _moving(
        rows: AxisRows,
        setting: Setting,
        v_actual: int,
        v_target: int,
        to_go: int,
        left: bool | None,
        right: bool | None,
    ) -> bool:
        """v_actual reads 0 below one chip unit too, so 0 alone does not say that the motor rests (001, 8.6)."""
        if v_actual:
            return True
        if not setting.v_max or not setting.a_max or setting.mode == HOLD_MODE:
            return False
        wanted = to_go if setting.mode in POSITIONING_MODES else v_target
        return bool(wanted) and not setting.blocked(rows, 1 if wanted > 0 else -1, left, right)

    async def _read_setting(self, words: Words, axis: int) -> Setting:
        rows = self.rows[axis]
        for register in Setting.rows(rows):
            self._saw_word(register, await words.read(register))
        return Setting.of(rows, self._known)

    # --- moves ----------------------------------------------------------------------------------

    async def move_together(self, moves: Sequence[AxisMove]) -> list[MoveStarted]:
        axes = [self.axis(move.axis).index for move in moves]
        if len(set(axes)) != len(axes):
            raise UsageError("an axis is named twice in one move")
        if not axes:
            raise UsageError("a move of no axis")
        self.require_connected()
        async with self.queue.turn(Priority.COMMAND, self._guard(axes)) as turn:
            words = Words(turn)
            common = await self._motion_warnings(words)
            prepared = [await self._prepare(words, move) for move in moves]
            for one in prepared:
                if not one.positioning:  # there x_target has no effect yet, and the mode starts the move
                    await words.put(one.rows.x_target, one.target)
            for one in prepared:
                await self._start(words, one)
            for one in prepared:
                await self._check_target(words, one)
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
            self._tell(MotionStarted(one.axis, one.started_at_s))
        return started

    async def _prepare(self, words: Words, move: AxisMove) -> _Prepared:
        """Read what decides, and refuse what cannot go well. Nothing is written."""
        rows = self.rows[move.axis]
        setting = await self._read_setting(words, move.axis)
        setting.require_motion(move.axis)
        setting.require_proportionality(move.axis)
        warnings = setting.proportionality_warnings()
        left, right = await self._switches(words, move.axis)
        v_actual = await words.value(rows.v_actual)
        x_actual = await words.value(rows.x_actual)
        wanted = to_position(self.mechanics(move.axis), move.target, move.unit)
        if move.unit == "microsteps" and wanted != move.target:
            warnings.append(f"rounded to {wanted} microsteps")
        shown = "" if move.unit == "microsteps" else f"; {move.target:g} {move.unit} asked"
        target = checked_target(move.axis, x_actual + wanted if move.relative else wanted, x_actual, shown)
        switch = setting.blocked(rows, target - x_actual, left, right)
        if switch:
            warnings.append(f"the {switch} switch is active and stops motion that way")
        return _Prepared(move.axis, rows, setting, x_actual, v_actual, target, warnings)

    async def _start(self, words: Words, one: _Prepared) -> None:
        """Exactly one datagram, which sets the axis in motion."""
        if one.positioning:
            await words.put(one.rows.x_target, one.target)
        else:
            await words.write(one.rows.reference, one.rows.with_mode(one.setting.reference, RAMP_MODE))
        one.started_at_s = words.time_s
        self.commanded(one.axis, "move")

    async def _check_target(self, words: Words, one: _Prepared) -> None:
        rows = one.rows
        back = await words.value(rows.x_target)
        mode = await words.read(rows.reference)
        self._saw_word(rows.reference, mode)
        if back != one.target:
            raise WriteRefused(rows.x_target.name, one.target, back, f"axis {one.axis} may go there: stop it")
        if rows.mode.unpack(mode) != one.mode:
            raise WriteRefused(rows.reference.name, one.mode, mode, f"axis {one.axis} did not take RAMP_MODE")

    def _predict(self, one: _Prepared) -> Prediction:
        return self._books[one.axis].begin(
            Origin(
                axis=one.axis,
                started_at_s=one.started_at_s,
                position=one.x_actual,
                distance=one.target - one.x_actual,
                velocity=one.v_actual,
                parameters=one.setting.parameters(self.clock_hz, one.mode),
            )
        )

    # --- rotation -------------------------------------------------------------------------------

    async def rotate(self, axis: int, velocity: float, unit: str = "pps") -> Rotating:
        self.axis(axis)
        self.require_connected()
        rows = self.rows[axis]
        async with self.queue.turn(Priority.COMMAND, self._guard([axis])) as turn:
            words = Words(turn)
            setting = await self._read_setting(words, axis)
            setting.require_motion(axis)
            chip, warnings = to_chip_velocity(
                self.mechanics(axis), velocity, unit, setting.pulse_div, self.clock_hz, setting.v_max
            )
            warnings += await self._motion_warnings(words)
            left, right = await self._switches(words, axis)
            switch = setting.blocked(rows, chip, left, right)
            if switch:
                warnings.append(f"the {switch} switch is active and stops motion that way")
            x_actual = await words.value(rows.x_actual)
            v_actual = await words.value(rows.v_actual)
            if setting.mode != VELOCITY_MODE:
                if setting.mode == HOLD_MODE:
                    # HOLD_MODE ignores v_target, so an old one may still stand there: replace it first.
                    await words.put(rows.v_target, chip)
                await words.write(rows.reference, rows.with_mode(setting.reference, VELOCITY_MODE))
            await words.put(rows.v_target, chip)
            started_at_s = words.time_s
            self.commanded(axis, "rotate")
            back = await words.value(rows.v_target)
            reference = await words.read(rows.reference)
            self._saw_word(rows.reference, reference)
        if back != chip:
            raise WriteRefused(rows.v_target.name, chip, back, f"axis {axis} may turn at another speed: stop it")
        if rows.mode.unpack(reference) != VELOCITY_MODE:
            raise WriteRefused(rows.reference.name, VELOCITY_MODE, reference, f"axis {axis} did not take VELOCITY_MODE")
        parameters = setting.parameters(self.clock_hz, VELOCITY_MODE, v_target=chip)
        self._books[axis].begin(Origin(axis, started_at_s, x_actual, 0, v_actual, parameters))
        self._tell(MotionStarted(axis, started_at_s))
        return Rotating(axis, chip, pulse_rate_hz(chip, setting.pulse_div, self.clock_hz), warnings)

    # --- stops ----------------------------------------------------------------------------------

    async def stop_axes(self, axes: Sequence[int], mode: StopMode = "ramp") -> list[StopOutcome]:
        began = time.perf_counter()
        for axis in axes:
            self.stops[axis] += 1  # before anything waits: what is under way for these axes gives up
            self.commanded(axis, "stop")
        outcomes: list[StopOutcome] = []
        lost: BenchError | None = None
        async with self.queue.turn(Priority.STOP) as turn:
            words = Words(turn)
            sent: dict[int, bool | BenchError] = {}
            for axis in axes:  # all motors first, all checks afterwards
                how = lost if lost is not None else await self._stop(words, axis, mode)
                sent[axis] = how
                if isinstance(how, LinkDown):
                    lost = how  # the next axis would only wait for the same dead link
            for axis, how in sent.items():
                problem = how if isinstance(how, BenchError) else await self._check_stop(words, axis, how)
                took_ms = (time.perf_counter() - began) * 1e3
                outcomes.append(StopOutcome(self.id, axis, problem is None, took_ms, problem))
        return outcomes

    async def _stop(self, words: Words, axis: int, mode: StopMode) -> bool | BenchError:
        """Send one axis its stop: whether at once (True) or by the ramp (False), or what went wrong."""
        rows = self.rows[axis]
        for attempt in (1, 2):  # a stop moves nothing, so it may be sent again
            try:
                reference = await words.read(rows.reference)
                at_once = mode == "immediate" or await words.value(rows.a_max) == 0  # else it would never slow down
                if at_once:
                    await words.write(rows.reference, rows.with_mode(reference, HOLD_MODE))
                    await words.put(rows.v_actual, 0)
                else:
                    await words.write(rows.reference, rows.with_mode(reference, VELOCITY_MODE))
                    await words.put(rows.v_target, 0)
            except LinkTimeout as error:
                if attempt == 2:
                    return error
            except BenchError as error:
                return error
            else:
                self._books[axis].end(words.time_s, "stop")
                return at_once
        raise AssertionError("unreachable")

    async def _check_stop(self, words: Words, axis: int, at_once: bool) -> BenchError | None:
        rows = self.rows[axis]
        wanted_mode, register = (HOLD_MODE, rows.v_actual) if at_once else (VELOCITY_MODE, rows.v_target)
        try:
            reference = await words.read(rows.reference)
            self._saw_word(rows.reference, reference)
            if rows.mode.unpack(reference) != wanted_mode:
                sent = rows.with_mode(reference, wanted_mode)
                return WriteRefused(rows.reference.name, sent, reference, "stop again, or cut the power")
            value = await words.value(register)
            if value != 0:
                return WriteRefused(register.name, 0, value, "stop again, or cut the power")
        except BenchError as error:
            return error
        return None

    # --- predictions ----------------------------------------------------------------------------

    def prediction(self, axis: int) -> Prediction | None:
        self.axis(axis)
        return self._books[axis].present()

    def predictions(self, axis: int) -> PredictionBook:
        """For sample plans: what was expected at any recent time."""
        return self._books[axis]
