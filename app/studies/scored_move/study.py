"""The move itself: there and back with the settings as they are, and its figures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...number_text import plain
from ..document import ScoredMove
from ..moves import MeasuredMoves, MoveFigures, Sampled, worst_of
from ..proof import mean_interval
from ..record import Figures, StudyRecord, Trial
from ..run import StudyRun
from .found import Scored
from .plan import Ground, look


@dataclass(frozen=True, slots=True)
class SeenMove:
    """Of one move, in full steps; overshoot, vibration, rest : None where there was none to be seen; reached : share of
    the way; stalled_at : where a stall ended it [microsteps], None where none did."""

    figures: MoveFigures
    overshoot: float | None
    vibration: float | None
    rest: float | None
    load_min: float | None
    reached: float = 1.0
    stalled_at: int | None = None


class ScoredMoveStudy(StudyRun):
    """Moves, and keeps what it saw with the settings in force. It sets nothing."""

    _ground: Ground

    @property
    def wanted(self) -> ScoredMove:
        """What is asked for."""
        return self.record.document.wanted(ScoredMove)

    async def _study(self) -> None:
        record, wanted = self.record, self.wanted
        self.tell("preconditions", 0.0, "looking at the axis")
        ground = self._ground = (await look(self.device, self.axis, wanted)).required()
        load = f"load_value.{self.axis}"
        beside = [load] if load in {channel.name for channel in self.device.telemetry.channels()} else []
        moves = MeasuredMoves(self.device, self.axis, self.clock, ground.full_step, wanted.band_fullsteps, beside)
        record.runs, record.trials, record.best, record.scored = 0, [], None, None
        await self.keeper.save(record)
        made: list[SeenMove] = []
        many = 2 * wanted.repeats
        for index in range(many):
            self.tell("look", index / many, f"move {index + 1} of {many}")
            target = ground.start + (wanted.distance if index % 2 == 0 else 0)
            figures = await moves.measured(target, stalls=True)
            assert moves.last is not None
            made.append(seen(figures, moves.last, target, ground.full_step, moves.stalled_at))
            record.runs, record.way_fullsteps = record.runs + 1, moves.way_fullsteps
            if moves.stalled_at is not None:
                break
        tell(record, ground, scored(wanted.distance, made, ground.stall_level))
        if moves.stalled_at is not None and target != ground.start:  # away from what may have stopped it
            await moves.go(ground.start)


def tell(record: StudyRecord, ground: Ground, found: Scored) -> None:
    """Put what was found into the record, with the setting that it was found with."""
    record.scored = found
    lost, stalled = found.lost_fullsteps > 0, found.stalls > 0
    record.trials = [
        Trial(
            number=1,
            setting=ground.setting,
            registers=ground.registers,
            state="infeasible" if lost or stalled else "feasible",
            figures=Figures(
                time_s=found.time_s,
                deviation_fullsteps=found.peak_fullsteps,
                lost_fullsteps=found.lost_fullsteps,
                runs=found.moves,
            ),
            why="steps were lost" if lost else "a stall stopped it" if stalled else "",
        )
    ]
    record.best = 1
    record.verdict = _verdict(found)


def _verdict(found: Scored) -> str:
    lost = f"lost {plain(found.lost_fullsteps)} full steps" if found.lost_fullsteps > 0 else ""
    if found.stalls:
        where = f"a stall stopped it at {found.stalled_at}, after {plain(100 * found.reached, 3)} % of its way"
        load = "" if found.load_min is None else f"; least load value {plain(found.load_min, 3)}"
        return f"{where}{load}{'; ' if lost else ''}{lost}"
    if lost or found.vibration_fullsteps is None:
        return lost
    time = "did not come to rest in its band" if found.time_s is None else f"{plain(found.time_s, 4)} s"
    peak, vibration = plain(found.peak_fullsteps, 3), plain(found.vibration_fullsteps, 3)
    return f"{time}, {peak} full steps off at most, vibrating by {vibration} under way"


def seen(
    figures: MoveFigures, sampled: Sampled, target: int, full_step: int, stalled_at: int | None = None
) -> SeenMove:
    """What the encoder showed of one move to `target`; `stalled_at`: where a stall ended it [microsteps]."""
    counts = (sampled.time_s >= 0) & np.isfinite(sampled.position) & np.isfinite(sampled.encoder)
    position, encoder = sampled.position[counts], sampled.encoder[counts]
    deviation = (encoder - position) / full_step
    way = deviation[position != target]
    rest = deviation[position == target]
    ahead = 1 if target > sampled.start else -1
    # Beyond where it rests in the end: where the encoder's zero lies does not matter.
    beyond = ahead * (encoder - target - sampled.deviation) / full_step
    # A load value means something at speed alone: on the middle half of the way.
    middle = np.abs(position - (sampled.start + target) / 2) < abs(target - sampled.start) / 4
    if stalled_at is not None:
        middle = (ahead * (position - sampled.start) > abs(target - sampled.start) / 4) & (position != stalled_at)
    load = sampled.beside[counts][middle]
    told = load[np.isfinite(load)]
    load_min = float(told.min()) if told.size else None
    if stalled_at is not None:
        reached = abs(stalled_at - sampled.start) / abs(target - sampled.start)
        return SeenMove(figures, None, None, None, load_min, reached, stalled_at)
    return SeenMove(
        figures,
        float(max(beyond.max(initial=0.0), 0.0)),
        float(way.std()) if len(way) > 1 else 0.0,
        float(rest.std()) if len(rest) > 1 else None,
        load_min,
    )


def scored(distance: int, moves: Sequence[SeenMove], stall_level: float | None) -> Scored:
    """The figures of all moves together; `stall_level`: the load value that is a stall."""
    times = [move.figures.time_s for move in moves if move.figures.time_s is not None]
    overshoots = [move.overshoot for move in moves if move.overshoot is not None]
    vibrations = [move.vibration for move in moves if move.vibration is not None]
    rests = [move.rest for move in moves if move.rest is not None]
    loads = [move.load_min for move in moves if move.load_min is not None]
    stalls = [move.stalled_at for move in moves if move.stalled_at is not None]
    load_min = min(loads, default=None)
    return Scored(
        distance=distance,
        moves=len(moves),
        time_s=float(np.mean(times)) if len(times) == len(moves) else None,
        interval_s=mean_interval(times) if len(times) == len(moves) > 1 else None,
        overshoot_fullsteps=max(overshoots, default=None),
        peak_fullsteps=worst_of(move.figures for move in moves) or 0.0,
        vibration_fullsteps=float(np.mean(vibrations)) if vibrations else None,
        rest_fullsteps=float(np.mean(rests)) if rests else None,
        lost_fullsteps=max(move.figures.lost_fullsteps for move in moves),
        load_min=load_min,
        load_margin=None if stalls or load_min is None or stall_level is None else load_min - stall_level,
        stalls=len(stalls),
        stalled_at=stalls[-1] if stalls else None,
        reached=min(move.reached for move in moves),
    )
