"""A setting of an own search tried: all moves there and back with it; what is lost is mended after it."""

from __future__ import annotations

from collections.abc import Callable, Sequence

from ...clock import Clock
from ...devices.core.capabilities import PositionFromEncoder
from ...devices.core.device import Device
from ...procedures.procedure import Failed
from ..document import CustomSearch
from ..moves import PERIOD_FULLSTEPS, MeasuredMoves, deviation_of
from ..record import Held
from ..scored_move.found import Scored
from ..scored_move.study import SeenMove, scored, seen
from ..set_once import Apply, SetOnce
from .plan import Ground

BEFORE = "the setting before the study"


class CustomTrials:
    """Makes all moves of the document with a setting."""

    def __init__(
        self, device: Device, axis: int, clock: Clock, wanted: CustomSearch, ground: Ground, apply: Apply
    ) -> None:
        self._device, self._axis, self._wanted, self._ground = device, axis, wanted, ground
        self._apply = SetOnce(apply)
        beside = [f"load_value.{axis}"] if ground.load else []
        self.moves = MeasuredMoves(device, axis, clock, ground.full_step, wanted.band_fullsteps, beside)
        self._zero = 0.0
        """Encoder less position at rest, as nothing was lost [microsteps]."""
        self.ran: Callable[[], None] = lambda: None
        """Called after all moves from a place."""
        self.losing: Callable[[], None] = lambda: None
        """Called where steps were lost, before that is mended."""

    async def begin(self) -> None:
        """The rotor falls into step, and where its encoder stands then is what nothing lost is. Raises Failed,
        BenchError."""
        await self.moves.fall_into_step(self._ground.start, 1 if self._wanted.distances[0] > 0 else -1)
        self._zero = await self.moves.deviation()

    async def measure(self, registers: Sequence[Held], what: str, places: Sequence[int]) -> Scored:
        """All moves with a setting, from these places of the electrical period; the first that loses steps ends it,
        and that is mended. Raises Failed, BenchError."""
        await self._apply(registers, what)
        made: list[SeenMove] = []
        for place in places:
            await self._run(place, made)
            self.ran()
            if made[-1].figures.lost_fullsteps:
                self.losing()
                await self.home()
                break
        # Where a stall begins may be what is searched.
        return scored(self._wanted.distances[0], made, stall_level=None)

    async def _run(self, place: int, made: list[SeenMove]) -> None:
        """All moves from one place, until one loses steps."""
        ground = self._ground
        for distance in self._wanted.distances:
            begin = ground.start + (place if distance > 0 else -place)
            await self.moves.go(begin)
            if await self._lost():
                raise Failed("steps were lost on the way to where its moves begin")
            for target in (begin + distance, begin):
                figures = await self.moves.measured(target)
                assert self.moves.last is not None
                made.append(seen(figures, self.moves.last, target, ground.full_step))
                if figures.lost_fullsteps:
                    return

    async def _lost(self) -> float:
        """How far encoder and position have parted since nothing was lost [full steps], in whole periods."""
        off = (deviation_of(await self.moves.state()) - self._zero) / self._ground.full_step
        return PERIOD_FULLSTEPS * round(off / PERIOD_FULLSTEPS)

    async def home(self) -> None:
        """With the setting before to where the study began, the position as the encoder has it where steps were lost.
        Raises Failed, BenchError."""
        await self._apply(self._ground.space.before, BEFORE)
        await self.moves.deviation()  # until it rests
        if await self._lost():
            await self._device.need(PositionFromEncoder).position_from_encoder(self._axis)
            self._zero = await self.moves.deviation()
        await self.moves.go(self._ground.start)
