"""The maximum acceleration (AP 5) that an immediate stop raises, until it is written back."""

from __future__ import annotations

import contextlib

from ...errors import BenchError, UnknownParameter
from ..core.background_tasks import BackgroundTasks
from ..core.session import Session
from ..core.tmcl_calls import Calls
from ..core.tmcl_link import TmclLink
from ..core.tmcl_refusals import limits
from .records import Records
from .state import ModuleState

SETTLE_S = 0.02
"""How often the motor is looked at after an immediate stop, until AP 5 goes back [s]."""
SETTLE_MAX_S = 5.0


class BorrowedAcceleration:
    """Raises the acceleration for a stop, and writes it back once the motor rests."""

    def __init__(
        self, session: Session, state: ModuleState, link: TmclLink, records: Records, tasks: BackgroundTasks
    ) -> None:
        self._session = session
        self._state = state
        self._link = link
        self._records = records
        self._tasks = tasks
        self._row = state.roles.max_acceleration
        self._own: int | None = None

    @property
    def own(self) -> int | None:
        """What the user has set, while it is raised; None while it is not."""
        return self._own

    async def raise_it(self, calls: Calls) -> BenchError | None:
        """The motor slows down already: let it do so as fast as it can. What went wrong, if anything did."""
        try:
            if self._own is None:
                self._own = await calls.get(self._row)
            await calls.put(self._row, limits(self._row, self._state.unit_mode)[1])
        except UnknownParameter:
            return None  # there is but one way to slow down, and the motor is on it
        except BenchError as error:
            return error
        finally:
            if self._own is not None:
                self._tasks.begin(self._settle(), f"after a stop of {self._session.id}")
        return None

    async def give_back(self, calls: Calls) -> None:
        """As it was, where it is raised. Raises BenchError."""
        if self._own is None:
            return
        own = self._own
        await calls.put(self._row, own)
        back = await calls.get(self._row)
        self._records.judge(self._row, own, back)
        self._own = None

    async def give_back_at_rest(self) -> None:
        """As it was, where it is raised and the motor was last seen to rest. Raises BenchError."""
        if self._own is not None and self._state.last(self._state.roles.actual_speed) == 0:
            async with self._link.calls() as calls:
                await self.give_back(calls)

    def forget(self) -> None:
        """The user has written the acceleration, and wants it so now."""
        self._own = None

    async def _settle(self) -> None:
        """Write AP 5 back once the motor rests; what fails here the next command or refresh does again."""
        left_s = SETTLE_MAX_S
        while self._own is not None and left_s > 0:
            await self._session.clock.sleep(SETTLE_S)
            left_s -= SETTLE_S
            with contextlib.suppress(BenchError):
                async with self._link.calls() as calls:
                    # Where no speed is told, the time that any stop takes has to do.
                    speed = (await calls.ask_many((self._state.roles.actual_speed,)))[0]
                    if speed == 0 or left_s <= 0:
                        await self.give_back(calls)
