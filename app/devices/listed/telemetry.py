"""Telemetry channels: the standard quantities of each axis, and every other parameter and port by its name."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np

from ...links.tmcl import FRAME_BYTES
from ...registers.listed.modules import Role, role_of
from ...registers.model import Register
from ..core.motion_watch import MotionReading
from ..core.row_telemetry import RowTelemetry
from ..core.sample_plan import FloatArray, SamplePlan, Taken
from ..core.session import Session
from ..core.tmcl_frames import reading
from ..core.tmcl_link import TmclLink
from ..core.tmcl_samples import PACE, TmclDecoder, TmclPlan, TmclSampler
from .ongoing import ListedMotions
from .state import ListedState

QUANTITIES: Mapping[Role, tuple[str, str]] = {
    "position": ("position", "microsteps"),
    "target_position": ("target_position", "microsteps"),
    "speed": ("velocity", ""),
    "target_speed": ("target_velocity", ""),
    "position_reached": ("position_reached", "0/1"),
}
"""What is called alike on every device, with its unit; that of speeds nobody here knows."""


class ListedTelemetry(RowTelemetry):
    """Samples of a module of which names are known. Global parameters and ports stand under axis 0."""

    def __init__(self, session: Session, state: ListedState, link: TmclLink, motions: ListedMotions) -> None:
        self._state = state
        self._link = link
        self._motions = motions
        self._sampler = TmclSampler(session)
        self._rows: dict[str, Register] = {}
        units: list[dict[str, str]] = [{} for _ in session.axes]
        for row in state.table:
            if row.access.readable and not row.read_clears and not row.when:
                role, axis = role_of(row), row.axis or 0
                quantity, unit = QUANTITIES.get(role, (row.name, "")) if role is not None else (row.name, "")
                units[axis][quantity] = unit
                self._rows[f"{quantity}.{axis}"] = row
        super().__init__(session, units, PACE)

    def sample_plan(self, channels: Sequence[str]) -> SamplePlan:
        chosen = self.chosen(channels)
        rows = {(row.space, row.axis, row.address): row for row in (self._rows[channel.name] for channel in chosen)}
        asked = list(rows.values())
        columns = tuple(_column(asked.index(self._rows[channel.name])) for channel in chosen)
        frames = tuple(reading(self._link.address, row).encode() for row in asked)
        return TmclPlan(frames, chosen, FRAME_BYTES, columns, self._watcher(asked))

    def rows_at_once(self, plan: SamplePlan, rate_hz: float) -> int:
        return self._sampler.rows_at_once(plan, rate_hz)

    async def take_samples(self, plan: SamplePlan, rows: int = 1) -> Taken:
        return await self._sampler.take_samples(plan, rows)

    def _watcher(self, asked: Sequence[Register]) -> Callable[[FloatArray, FloatArray], None] | None:
        """What these questions tell of where the axes are, and of the end of a motion; None where nothing."""
        watched = [
            (axis, asked.index(rows.position), asked.index(rows.speed) if rows.speed in asked else None)
            for axis, rows in enumerate(self._state.axes)
            if rows.position in asked
        ]
        if not watched:
            return None

        def seen(times_s: FloatArray, values: FloatArray) -> None:
            spread_s = self._sampler.row_spread_s()
            for axis, position, speed in watched:
                if np.isfinite(values[-1, position]):
                    self._session.saw_position(axis, int(values[-1, position]), float(times_s[-1]) - spread_s)
                if speed is not None:
                    self._watch_rows(axis, times_s, values[:, position], values[:, speed], spread_s)

        return seen

    def _watch_rows(
        self, axis: int, times_s: FloatArray, position: FloatArray, speed: FloatArray, spread_s: float
    ) -> None:
        """Polls out of telemetry: all of them while a motion is under way, else only those that see one."""
        watch = self._motions.axes[axis].watch
        known = np.isfinite(position) & np.isfinite(speed)
        for row in np.flatnonzero(known & (speed != 0) if watch.under_way is None else known):
            target = None if watch.under_way is None else watch.under_way.target
            reached = target is not None and speed[row] == 0 and position[row] == target
            watch.update(
                MotionReading(float(times_s[row]), int(position[row]), float(speed[row]), bool(reached)), spread_s
            )


def _column(index: int) -> TmclDecoder:
    return lambda _, values: values[:, index]
