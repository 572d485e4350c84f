"""What the calculators expect of the commands in a recording, by the settings that it tells of.

A motion starts when its command reached the chip, from where the axis stood: measured, or where the motion before
leads. Where the recording does not tell how the axis was set, or what moved it, nothing is predicted, and a note says
why.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from ..devices.core.planned_motion import PlannedMotion
from ..devices.core.prediction import Prediction
from ..errors import BenchError
from ..procedures.replay import DOING, done_s, is_write_of
from ..profiles.document import FORMAT, ProfileDocument, parse
from ..profiles.families import rules_of
from ..profiles.items import Key, items_by_key, key_of
from ..profiles.physical import UnitContext
from ..profiles.register_bits import bits_of
from ..profiles.rules import MotionStart
from ..registers.catalog import MODELS
from ..registers.model import Register, to_raw
from ..store.recordings.file import FloatArray, Rows
from ..store.recordings.head import Head
from ..store.recordings.marks import Mark

NOTES_MAX = 20
MOTIONS_MAX = 1000
"""Each is a ramp to be worked out."""
STANDS_PPS = 0.5
"""Slower than that an axis stands: a chip counts in larger units."""
STOPPED_FROM_OUTSIDE = frozenset(
    {"left_switch", "right_switch", "stall", "deviation", "driver_error", "lost_link", "unknown"}
)
"""Ends of a motion that no command tells of."""


@dataclass(frozen=True, slots=True)
class Expected:
    """Position [microsteps] and velocity [pps] at the rows' times, NaN where nothing is predicted.

    bits : of the position counter, which comes round; notes : what is not predicted, and why
    """

    position: FloatArray
    velocity_pps: FloatArray
    bits: int
    motions: int
    notes: tuple[str, ...]

    def residual(self, measured: FloatArray) -> FloatArray:
        """Measured less predicted position, the shorter way round."""
        half = 2.0 ** (self.bits - 1)
        return np.asarray((measured - self.position + half) % (2 * half) - half)


def expect(
    head: Head,
    marks: Sequence[Mark],
    rows: Rows,
    axis: int,
    settings: ProfileDocument | None = None,
    zero_s: float = 0.0,
) -> Expected:
    """What was to be expected of `axis`, at the times of `rows`: all of them, from the first.

    Parameters
    ----------
    settings : by which it is worked out instead of those that the recording tells of; then its writes change nothing
    zero_s : device time that notes call 0 [s]
    """
    forecast = _Forecast(head, rows, axis, settings, zero_s)
    forecast.follow(marks)
    return forecast.told()


class _Forecast:
    def __init__(
        self,
        head: Head,
        rows: Rows,
        axis: int,
        settings: ProfileDocument | None,
        zero_s: float,
    ) -> None:
        self._head, self._rows, self._axis, self._zero_s = head, rows, axis, zero_s
        self._by_profile = settings is not None
        self._rules = rules_of(head.model) if head.model in MODELS else None
        self._expected = None if self._rules is None else self._rules.expected
        self._predictions: list[Prediction] = []
        self._present: Prediction | None = None
        self._goal: tuple[int | None, int] = (None, 0)
        self._notes: list[str] = []
        self._more = 0
        self._commanded = False
        names = [column.name for column in head.columns]
        self._position, self._velocity = (
            rows.columns[names.index(name)] if (name := f"{quantity}.{axis}") in names else None
            for quantity in ("position", "velocity")
        )
        self._held = self._settings(settings)

    def _settings(self, settings: ProfileDocument | None) -> UnitContext | None:
        head = self._head
        if self._expected is None:
            self._note(None, f"nobody can work out here how a {head.model} moves")
            return None
        if settings is None:
            kept = head.configuration
            if kept is None or kept.get("format") != FORMAT:
                why = "were not read" if kept is None else "are in a form of before profiles"
                self._note(None, f"the settings at the start {why}: choose a profile that they are like")
                return None
            try:
                settings = parse(kept)
            except BenchError as error:
                self._note(None, f"the settings at the start cannot be read: {error}")
                return None
        words: dict[Key, int | None] = {key: want.word for key, want in bits_of(settings).items()}
        return UnitContext(head.model, head.clock_hz, tuple(settings.axes), words)

    # --- through the marks ----------------------------------------------------------------------

    def follow(self, marks: Sequence[Mark]) -> None:
        if self._held is None:
            return
        writes = [mark for mark in marks if mark.kind == "write"]
        commands = [mark for mark in marks if mark.kind == "command" and mark.axis == self._axis]
        starts: dict[int | None, list[float]] = {
            self._axis: [mark.time_s for mark in marks if mark.kind == "move" and mark.axis == self._axis]
        }
        for mark in marks:
            if mark.kind == "write":
                moving = any(is_write_of(mark, command) and not command.detail for command in commands)
                self._written(mark, moving=moving)
            elif mark.axis != self._axis:
                continue
            elif mark.kind == "stopped" and (mark.detail or {}).get("reason") in STOPPED_FROM_OUTSIDE:
                if self._present is not None:
                    self._end(mark.time_s, f"it was stopped: {mark.text}; nothing is predicted until the next command")
            elif mark.kind == "command":
                detail = mark.detail or {}
                if not detail and any(is_write_of(write, mark) for write in writes):
                    continue
                self._command(mark, detail, done_s(mark, starts))

    def _command(self, mark: Mark, detail: Mapping[str, object], at_s: float) -> None:
        first, self._commanded = not self._commanded, True
        do = detail.get("do")
        match do:
            case "move":
                self._begin(at_s, int(str(detail["target"])), 0, first=first)
            case "rotate":
                self._begin(at_s, None, int(str(detail["velocity"])), first=first)
            case "stop" if detail.get("mode") == "immediate":
                self._end(at_s, None)
            case "stop" if self._present is not None:
                self._begin(at_s, None, 0, first=first)
            case "stop":
                self._end(at_s, None)
            case "set_position":
                self._end(at_s, None)
            case _:
                assert do not in DOING
                self._end(at_s, f"{mark.text}: the recording does not tell what that makes it do")

    def _written(self, mark: Mark, *, moving: bool) -> None:
        assert self._held is not None
        detail = mark.detail or {}
        found = MODELS[self._head.model].table.find(str(detail.get("register")), mark.axis)
        if found is None:
            return
        row, new = found[0], detail.get("new")
        if not self._by_profile:
            words = {**self._held.words, key_of(row): None if new is None else to_raw(int(new), row.width)}
            self._held = UnitContext(self._held.model, self._held.clock_hz, self._held.axes, words)
        if not moving or mark.axis != self._axis:
            return
        self._commanded = True
        assert self._expected is not None
        under_way = self._present is not None and not self._rests(mark.time_s)
        if self._sets_off(row) or (under_way and row.fields):
            self._end(mark.time_s, f"{row.name} was written by hand: what that makes it do is not predicted")
        elif under_way and not self._by_profile:
            self._begin(mark.time_s, *self._goal, first=False)

    def _sets_off(self, row: Register) -> bool:
        """Whether a write to it is a command: a target or a mode, and nothing that a profile holds."""
        assert self._rules is not None
        mode = None if self._rules.positioning is None else self._rules.positioning[0]
        return row.name == mode or key_of(row) not in items_by_key(self._head.model)

    # --- motions --------------------------------------------------------------------------------

    def _begin(self, at_s: float, target: int | None, velocity: int, *, first: bool) -> None:
        assert self._held is not None
        assert self._expected is not None
        if len(self._predictions) >= MOTIONS_MAX:
            self._end(at_s, f"only the first {MOTIONS_MAX} motions are predicted")
            return
        start = self._start(at_s, first=first)
        if start is None:
            self._end(at_s, "where it was and how fast is not recorded: what follows is not predicted")
            return
        try:
            prediction = self._expected(self._held, start, target, velocity)
            prediction.at(np.array([at_s]))  # the curve is worked out now: what no formula allows is told here
        except (ValueError, ZeroDivisionError) as error:
            self._end(at_s, f"not predicted: {error}")
            return
        self._end(at_s, None)
        self._present, self._goal = prediction, (target, velocity)
        self._predictions.append(prediction)

    def _end(self, at_s: float, why: str | None) -> None:
        if self._present is not None:
            self._present.ended_at_s, self._present = at_s, None
        if why is not None:
            self._note(at_s, why)

    def _rests(self, at_s: float) -> bool:
        assert self._present is not None
        return self._present.ends and at_s >= self._present.started_at_s + self._present.duration_s

    def _start(self, at_s: float, *, first: bool) -> MotionStart | None:
        """How the axis was at that time; None where nobody knows."""
        position: int | None = None
        if self._present is not None:
            expected, velocity = (float(each[0]) for each in self._present.at(np.array([at_s])))
            position = round(expected)
            if abs(velocity) >= STANDS_PPS:
                acceleration = 0.0  # a ramp in ticks has none to go on from: it changes in steps
                if isinstance(self._present, PlannedMotion):
                    acceleration = float(self._present.acceleration_at(np.array([at_s]))[0])
                return MotionStart(self._axis, at_s, position, velocity, acceleration)
        row = int(np.searchsorted(self._rows.time_s, at_s, side="right")) - 1
        if row >= 0 and self._position is not None and np.isfinite(self._position[row]):
            velocity = self._measured_velocity(row)
            if not np.isfinite(velocity):
                return None
            if abs(velocity) >= STANDS_PPS:
                self._note(at_s, "it turned already, and not as predicted: it begins with its measured velocity")
                place = self._position[row] + velocity * (at_s - self._rows.time_s[row])
                return MotionStart(self._axis, at_s, round(place), velocity)
            return MotionStart(self._axis, at_s, round(self._position[row]))
        if position is not None:
            return MotionStart(self._axis, at_s, position)
        kept = self._head.axes[self._axis] if self._axis < len(self._head.axes) else {}
        if first and kept.get("position") is not None and not kept.get("velocity_pps"):
            return MotionStart(self._axis, at_s, int(kept["position"]))
        return None

    def _measured_velocity(self, row: int) -> float:
        """Velocity at a row [pps]; NaN where nobody knows."""
        if self._velocity is not None:
            return float(self._velocity[row])
        assert self._position is not None
        before = self._position[max(0, row - 1) : row + 1]
        return 0.0 if before[0] == before[-1] else float("nan")

    # --- what comes of it -----------------------------------------------------------------------

    def told(self) -> Expected:
        time_s = self._rows.time_s
        position, velocity = np.full(time_s.shape, np.nan), np.full(time_s.shape, np.nan)
        for each in self._predictions:
            last_s = np.inf if each.ended_at_s is None else each.ended_at_s
            part = slice(*np.searchsorted(time_s, [each.started_at_s, last_s]))
            position[part], velocity[part] = each.at(time_s[part])
        if self._held is not None and not self._predictions and not self._notes:
            self._note(None, f"nothing told axis {self._axis} to move while this was recorded")
        notes = list(dict.fromkeys(self._notes))
        if self._more:
            notes.append(f"and {self._more} more")
        bits = self._predictions[0].bits if self._predictions else 32
        return Expected(position, velocity, bits, len(self._predictions), tuple(notes))

    def _note(self, at_s: float | None, text: str) -> None:
        if len(self._notes) < NOTES_MAX:
            self._notes.append(text if at_s is None else f"at {at_s - self._zero_s:.3f} s: {text}")
        else:
            self._more += 1
