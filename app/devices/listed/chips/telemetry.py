"""Telemetry channels: the quantities of ramp generators, every register and field that reading does not change."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np

from ....registers.model import Field, Register
from ...core.motion_watch import MotionReading
from ...core.register_link import RegisterLink
from ...core.register_samples import Asked, field, number, words_plan
from ...core.row_telemetry import RowTelemetry
from ...core.sample_plan import FloatArray, IntArray, SamplePlan, Seen
from .ongoing import ChipMotions
from .state import ChipState


class ChipTelemetry(RowTelemetry):
    """Registers of the whole chip stand under axis 0; `REGISTER.FIELD.0` is a field."""

    def __init__(self, link: RegisterLink, state: ChipState, motions: ChipMotions) -> None:
        self._link = link
        self._state = state
        self._motions = motions
        self._places: dict[str, tuple[Register, Field | None]] = {}
        units: list[dict[str, str]] = [{} for _ in state.ramps or (None,)]
        for ramp in state.ramps:
            for quantity, row, unit in (
                ("position", ramp.position, "microsteps"),
                ("velocity", ramp.speed, ""),
                ("target_position", ramp.target, "microsteps"),
            ):
                units[ramp.axis][quantity] = unit
                self._places[f"{quantity}.{ramp.axis}"] = row, None
        for row in state.table:
            if row.access.readable and not row.read_clears and not row.when:
                self._add(units, row.name, row, None)
                for part in row.fields:
                    self._add(units, f"{row.name}.{part.name}", row, part)
        super().__init__(link.session, units)

    def _add(self, units: list[dict[str, str]], quantity: str, row: Register, part: Field | None) -> None:
        axis = row.axis or 0
        units[axis][quantity] = (part or row).unit
        self._places[f"{quantity}.{axis}"] = row, part

    def sample_plan(self, channels: Sequence[str]) -> SamplePlan:
        asked, chosen = Asked(), self.chosen(channels)
        columns = []
        for channel in chosen:
            row, part = self._places[channel.name]
            column = asked.column(row)
            columns.append(number(column, row) if part is None else field(column, part))
        return words_plan(self._link.access, asked, chosen, tuple(columns), self._watcher(asked))

    def _watcher(self, asked: Asked) -> Seen | None:
        """What these words tell of where the axes are, and of the end of a motion; None where nothing."""
        watched = [
            (ramp, number(asked.column(ramp.position), ramp.position), _speed_of(asked, ramp.speed))
            for ramp in self._state.ramps
            if ramp.position in asked.registers
        ]
        if not watched:
            return None

        def seen(times_s: FloatArray, words: IntArray, status: IntArray) -> None:
            for ramp, position_of, speed_of in watched:
                position = position_of(times_s, words, status)
                self._link.session.saw_position(ramp.axis, int(position[-1]), float(times_s[-1]))
                if speed_of is not None:
                    self._watch_rows(ramp.axis, times_s, position, speed_of(times_s, words, status))

        return seen

    def _watch_rows(self, axis: int, times_s: FloatArray, position: FloatArray, speed: FloatArray) -> None:
        """Polls out of telemetry: all of them while a motion is under way, else only those that see one."""
        watch = self._motions.watches[axis]
        for row in np.flatnonzero(speed != 0) if watch.under_way is None else range(len(times_s)):
            target = None if watch.under_way is None else watch.under_way.target
            reached = target is not None and speed[row] == 0 and position[row] == target
            watch.update(MotionReading(float(times_s[row]), int(position[row]), float(speed[row]), bool(reached)))


def _speed_of(asked: Asked, row: Register) -> Callable[[FloatArray, IntArray, IntArray], FloatArray] | None:
    return number(asked.column(row), row) if row in asked.registers else None
