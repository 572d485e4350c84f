"""Polls of the last minutes to hours, in bounded memory: the older they are, the fewer are kept."""

from __future__ import annotations

from typing import NamedTuple

KEPT = 4096
"""Points; a thinning takes every second of the older half away."""
SPACING_S = 0.05
"""Polls closer together than this are one point [s]."""


class Point(NamedTuple):
    time_s: float
    position: int
    encoder: int | None
    """Where the encoder said that the axis was, extended; None where it was not read along."""


class History:
    """One axis. Where nothing changes only the first and the last look of it are kept."""

    def __init__(self) -> None:
        self._points: list[Point] = []

    def add(self, time_s: float, position: int, encoder: int | None) -> None:
        """A look at `time_s`, not before the latest one [s]."""
        points, point = self._points, Point(time_s, position, encoder)
        if len(points) > 1:
            latest, before = points[-1], points[-2]
            rests = latest[1:] == before[1:] == point[1:]
            # The latest may still move on; the one before it has to be a spacing away.
            if rests or time_s - before.time_s < SPACING_S:
                if encoder is None and not rests and latest.encoder is not None:
                    return  # a look with the encoder is worth more
                points[-1] = point
                return
        points.append(point)
        if len(points) > KEPT:
            half = KEPT // 2
            self._points = points[:half:2] + points[half:]

    def since(self, time_s: float) -> list[Point]:
        """Points at or after `time_s` [s], oldest first, and the one before: what held at the beginning."""
        first = next((index for index, point in enumerate(self._points) if point.time_s >= time_s), len(self._points))
        return self._points[max(0, first - 1) :]
