"""Reference search by a TMCL module itself: told how, started, followed, and asked what it found (FM-PD42-1241 7.1).

The module tells no more than that it searches. Which part of the search it is in shows in its speed:
the search speed until a switch was found, the switch speed for finding the edges.
"""

from __future__ import annotations

from ...clock import Clock
from ...devices.core.device import Device
from ...devices.tmcl.searches import Searches, SearchState
from ...errors import BadReply, OutOfRange
from ...registers.tmcl.commands import HOME_INVERTED, SWAPPED, reference_modes
from ..procedure import Failed
from ..search import ReferenceSearchState, Search

PHASES = ("prepare", "search", "find the edges", "finish")
LOOKS_S = 0.05
"""How often the search is looked at [s]; less often where a look takes long on the link."""
STANDS_S = 3.0
"""A motor that stands so long in the middle of a search has come to where nothing goes on [s]: a ramp wait time lasts
2.1 s at the most, and a search for a switch that is not there ends at a stop switch without saying so."""
MAX_TRAVEL = 1 << 23
"""Default way after which the search is given up [microsteps]: 163 turns at 256 microsteps."""
TWO_SWITCHES = (2, 3)
"""Modes that measure the distance between the stop switches."""


class ModuleSearch(Search):
    """Mode `mode` of AP 193 (None: as the module is set), at speeds [pps] of their own (None: as it is set).

    `max_travel` [microsteps] is how far from the start it may get before it is given up.
    """

    def __init__(
        self,
        device: Device,
        axis: int,
        clock: Clock,
        mode: int | None = None,
        search_speed_pps: float | None = None,
        switch_speed_pps: float | None = None,
        max_travel: int | None = None,
    ) -> None:
        super().__init__(device, axis, clock)
        if mode is not None and mode not in reference_modes():
            raise OutOfRange("mode", mode, 1, 136, f"there are {', '.join(map(str, reference_modes()))}")
        for name, speed in (("search_speed_pps", search_speed_pps), ("switch_speed_pps", switch_speed_pps)):
            if speed is not None and not 0 < speed <= 8e6:
                raise OutOfRange(name, speed, 0, 8e6, "above 0, in pps")
        if max_travel is not None and not 1 <= max_travel < 1 << 31:
            raise OutOfRange("max_travel", max_travel, 1, (1 << 31) - 1)
        searches = device.part(Searches)
        assert searches is not None  # no other device is searched by this
        self._searches = searches
        self._mode = mode
        self._speeds = {"ap194": search_speed_pps, "ap195": switch_speed_pps}
        self._max_travel = max_travel or MAX_TRAVEL
        self._switch_speed_pps = 0.0
        self._phase = PHASES[0]
        self._detail = ""
        self._distance: int | None = None
        self._last_position: int | None = None

    @property
    def state(self) -> ReferenceSearchState:
        progress = 1.0 if self._how == "done" else PHASES.index(self._phase) / len(PHASES)
        phase = f"{self._phase} {self._detail}".strip()
        return ReferenceSearchState(
            self._how,
            phase,
            progress,
            [],
            self._last_position,
            self._last_position,
            self.message,
            self._mode,
            self._distance,
            self._last_position,
        )

    async def _run(self) -> None:
        await self._prepare()
        await self._searches.start()
        await self._follow()
        await self._finish()

    async def _prepare(self) -> None:
        """What the search goes by is written and read back; it stays so, for it says nothing else."""
        registers = self.device.registers
        if self._mode is not None:
            await registers.write("ap193", self.axis, self._mode)
        self._mode = (await registers.read("ap193", self.axis)).value
        await self._searches.read_units()
        for name, speed_pps in self._speeds.items():
            if speed_pps is not None:
                await registers.write(name, self.axis, max(1, round(speed_pps / self._searches.speed_unit_pps)))
        switch_speed = (await registers.read("ap195", self.axis)).value
        self._switch_speed_pps = switch_speed * self._searches.speed_unit_pps

    async def _follow(self) -> None:
        """Until the module says that it searches no more."""
        first: SearchState | None = None
        moved: SearchState | None = None
        while True:
            began_s = self.clock.now()
            try:
                look = await self._searches.poll()
            except BadReply:
                await self.clock.sleep(LOOKS_S)
                continue  # noise on the line; the search goes on without us
            if not look.running:
                return
            first = first or look
            if moved is None or look.position != moved.position:
                moved = look
            self._phase, self._detail = self._seen(look)
            if self._searches.apart(look.position, first.position) > self._max_travel:
                raise Failed(f"nothing was found within {self._max_travel} microsteps")
            if look.time_s - moved.time_s > STANDS_S:
                raise Failed(f"the motor stands at {look.position} in the middle of the search: {self._stuck(look)}")
            took_s = self.clock.now() - began_s
            await self.clock.sleep(max(LOOKS_S, 4 * took_s))

    def _seen(self, look: SearchState) -> tuple[str, str]:
        """Phase, and which way it goes."""
        if not look.speed_pps:
            return (self._phase if self._phase != PHASES[0] else PHASES[1]), self._detail
        # A ramp up to the search speed passes the switch speed too: once slow after fast, it stays with the edges.
        fast = abs(look.speed_pps) > self._switch_speed_pps * 1.02 + 2
        way = "to the right" if look.speed_pps > 0 else "to the left"
        switches = [name for name, on in (("left", look.left), ("home", look.home), ("right", look.right)) if on]
        found = bool(switches) or self._phase == PHASES[2]
        phase = PHASES[1] if fast or not found else PHASES[2]
        return phase, f"{way}{', on the ' + ' and '.join(switches) + ' switch' if switches else ''}"

    def _stuck(self, look: SearchState) -> str:
        switches = [name for name, on in (("left", look.left), ("right", look.right)) if on]
        where = f"the {' and the '.join(switches)} stop switch is active" if switches else "no stop switch is active"
        return f"{where}, and the module still searches; is the switch there that mode {self._mode} looks for?"

    async def _finish(self) -> None:
        self._phase, self._detail = PHASES[3], ""
        result = await self._searches.result()
        state = await self.device.monitor.axis_state(self.axis)
        # After a search the counter is 0 where the reference is, and the motor stands there.
        if abs(result.position) > self._slack() or state.moving:
            raise Failed(f"the search ended at {result.position} without a reference: something else stopped it")
        self._last_position = result.last_position
        was = "an unknown place" if result.last_position is None else f"{result.last_position}"
        base = (self._mode or 0) % HOME_INVERTED % SWAPPED
        if base in TWO_SWITCHES:
            self._distance = result.distance
            apart = "an unknown distance" if result.distance is None else f"{result.distance}"
            self.message = f"zero at {was} of the old counting, stop switches {apart} apart"
        else:
            self.message = f"zero at {was} of the old counting"

    def _slack(self) -> float:
        """How far from zero the motor may stand after a search: the way in which it stops from the switch speed."""
        return 2 + self._switch_speed_pps * LOOKS_S

    async def _give_back(self) -> None:
        """It borrows nothing."""
