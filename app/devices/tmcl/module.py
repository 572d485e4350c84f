"""The module behind the link: whether it is the right one, and what the driver keeps in mind of it."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Coroutine, Iterable
from contextlib import asynccontextmanager
from itertools import cycle
from typing import Any

from ...calc.units.mechanics import Mechanics
from ...clock import Clock
from ...errors import BadReply, DownloadMode, LinkError, OtherModel, WrongState
from ...links.download import DownloadHold, Downloads
from ...links.port import FramePort
from ...links.queue import FrameHold, Priority
from ...links.serial_line import LinePort
from ...links.tmcl import Request, is_retriable, module_version
from ...links.wire_budget import WireBudget
from ...registers.model import Register, Space
from ...registers.tmcl.commands import Opcode, Status
from ...registers.tmcl.pd42 import MODULE
from ..core.background_tasks import OwnTasks
from ..core.config import DeviceConfig
from ..core.device import Device
from ..core.lookup import Lookup
from ..core.signs import Remedy
from ..limits.parts import COORDINATES
from . import rows, units
from .calls import Calls, Lacking

FIRMWARE = "1.44"
"""The version whose manual the table follows."""
NOISE_S = 0.05
"""How long a garbled answer may be the latest news of the link before it counts as failed [s]."""
REFRESHED = 4
"""How many of the remembered parameters each `refresh` reads again."""
DOWNLOADING = 129
"""The global parameter that is 1 in download mode, where it cannot be read: the question is stored, status 101."""
ADDRESS = 1
"""Of a module as it comes (GP 0, 66)."""


LEAVE_DOWNLOAD = Remedy("leave download mode", "POST", "tmcl", {"command": 133, "type": 0, "motor": 0, "value": 0})


class Module(Device):
    """A TMCL module, without what it does."""

    def __init__(self, device_id: str, config: DeviceConfig, port: FramePort, clock: Clock) -> None:
        super().__init__(device_id, config, port, clock)
        self.table = self.family.table
        self.find = Lookup(self.table, self.family.axes)
        self.address = _address(config)
        self.firmware = ""
        """As the module tells it, e.g. "1.44"; empty before it was asked."""
        self._known: dict[int, int] = {}
        """Axis parameters as last seen, by number; forgotten when the link fails."""
        self.lacking = Lacking()
        """Rows that this module's firmware has answered not to have; forgotten when the link fails."""
        self._next_look = cycle(rows.REMEMBERED)
        self._tasks = OwnTasks()
        self.download = self._hold_of(port)
        """Whether the module is in download mode; then nothing goes out but what its user sends, and stops."""
        self.queue.holds = self._holds()

    # --- turns ----------------------------------------------------------------------------------

    @asynccontextmanager
    async def calls(self, axis: int | None = None, priority: Priority = Priority.COMMAND) -> AsyncIterator[Calls]:
        """Commands in one turn; with `axis` they give up when a stop of that axis overtakes them."""
        guard = None if axis is None else self.stop_guard([axis])
        async with self.queue.turn(priority, guard) as turn:
            calls = Calls(turn, self.port.name, self.address, self._saw, self.lacking)
            calls.unit_mode = self.unit_mode
            yield calls

    # --- who it is ------------------------------------------------------------------------------

    async def probe(self) -> str:
        async with self.calls() as calls:
            reply = await calls.do(Request(self.address, Opcode.GET_VERSION, 1))
            number, version = module_version(reply.value)
            if number != MODULE:
                raise OtherModel(
                    f"this is a module {number}, firmware {version}, not a {self.family.title} (module {MODULE})",
                    self.model,
                )
            # Alone: where the module is in download mode already, this one question tells, and is stored.
            told = await calls.reply(Request(self.address, Opcode.GGP, DOWNLOADING))
        if told.status == Status.OK and told.value:
            self.download.downloads.begin(self.download.address, f"global parameter {DOWNLOADING} is {told.value}")
        if (problem := self.download.problem) is not None:
            raise problem
        self.firmware = version
        found = f"{self.family.title}, firmware {version}, address {self.address}"
        return found if version == FIRMWARE else f"{found}; stepscope knows {FIRMWARE}, so parameters may differ"

    async def refresh(self) -> None:
        unknown = [row for row in rows.REMEMBERED if row.address not in self._known and not self.lacking.has(row)]
        wanted = unknown or [next(self._next_look) for _ in range(REFRESHED)]
        async with self.calls() as calls:
            await calls.ask_many((*rows.ALWAYS_FRESH, *wanted))

    @property
    def shortcomings(self) -> tuple[str, ...]:
        names = ", ".join(f"{row.name} ({row.alias})" for row in self.lacking.rows)
        if not names:
            return ()
        return (f"its firmware {self.firmware} does not have {names}: what needs that is missing or refused",)

    # --- what is kept in mind -------------------------------------------------------------------

    @property
    def unit_mode(self) -> int | None:
        """AP 255; None where not seen yet."""
        return self._known.get(rows.UNIT_MODE.address)

    @property
    def speed_unit_pps(self) -> float:
        """What a speed of 1 is as the module is set [pps]."""
        return units.speed_unit_pps(self.clock_hz, self.unit_mode)

    @property
    def acceleration_unit_pps2(self) -> float:
        """What an acceleration of 1 is as the module is set [pps^2]."""
        return units.acceleration_unit_pps2(self.clock_hz, self.unit_mode)

    @property
    def microsteps(self) -> int:
        """Microsteps per full step, of AP 140; as it comes from the factory while not seen."""
        return 1 << min(8, max(0, self._known.get(rows.MICROSTEPS.address, 8)))

    def mechanics(self, axis: int) -> Mechanics:
        """Conversions of an axis as the module is set: full steps are the module's own (AP 202) where it knows them.

        Gear and travel come from the connection's settings of the axis, as for any other device.
        """
        settings = self.axes[axis].settings
        full_steps = self._known.get(rows.FULL_STEPS.address) or settings.full_steps_per_rev
        return Mechanics(full_steps, self.microsteps, settings.gear_ratio, travel_mm_per_rev=settings.travel_mm_per_rev)

    def _saw(self, register: Register, value: int) -> None:
        """The module was seen to hold `value`."""
        if self.limiter is not None and register.space in (Space.AXIS, Space.COORDINATE):
            base = 0 if register.space is Space.AXIS else COORDINATES
            self.limiter.saw(base + register.address, value)
        if register.space is Space.AXIS:
            self._known[register.address] = value
            if register is rows.MICROSTEPS:
                self.axes[0].microsteps_per_full_step = self.microsteps

    def remembered_word(self, address: int) -> int | None:
        """An axis parameter as last seen."""
        return self._known.get(address)

    def forget_parameters(self, numbers: Iterable[int]) -> None:
        """Axis parameters of which nobody knows any more what they are."""
        for number in numbers:
            self._known.pop(number, None)

    def only_reads(self, frame: bytes) -> bool:
        return is_retriable(frame)

    def _holds(self) -> tuple[FrameHold, ...]:
        return (self.download,)

    # --- download mode --------------------------------------------------------------------------

    def _hold_of(self, port: FramePort) -> DownloadHold:
        if isinstance(port, LinePort):
            return DownloadHold(port.line.downloads, port.address, port.address_of, self._download_changed)
        return DownloadHold(Downloads(), self.address, lambda frame: frame[0], self._download_changed)

    @property
    def held_back(self) -> WrongState | None:
        return super().held_back or self.download.problem

    def ways_out(self, why: WrongState) -> tuple[Remedy, ...]:
        return (LEAVE_DOWNLOAD,) if isinstance(why, DownloadMode) else super().ways_out(why)

    def _download_changed(self) -> None:
        why = self.download.problem
        if self.sampling_port is not None:
            self.sampling_port.paused = why
        if self.state == "disconnected":
            return
        if why is not None:
            self.set_state("failed", why)
        elif isinstance(self.problem, DownloadMode):
            self.set_state("connecting")  # what was not learnt while nothing could be asked, the watch asks now

    # --- the link -------------------------------------------------------------------------------

    @property
    def calls_per_s_possible(self) -> float | None:
        wire = self._wire
        return None if wire is None else wire.calls_per_s_possible

    @property
    def calls_per_s(self) -> float:
        wire = self._wire
        return super().calls_per_s if wire is None else wire.calls_per_s

    @property
    def _wire(self) -> WireBudget | None:
        """What the wire can carry, where the port knows of one."""
        wire = getattr(self.port, "wire", None)
        return wire if isinstance(wire, WireBudget) else None

    def _link_result(self, error: LinkError | None) -> None:
        # A garbled answer on a line that works is asked again at once: only where that fails too the link has failed.
        if isinstance(error, BadReply) and self.state == "connected":
            self._begin(self._noise(), "noise")
            return
        super()._link_result(error)

    async def _noise(self) -> None:
        await self.clock.sleep(NOISE_S)
        if self.queue.error is not None and self.state == "connected":
            super()._link_result(self.queue.error)

    def _begin(self, work: Coroutine[Any, Any, None], what: str) -> asyncio.Task[None]:
        """A task of this driver, ended by `let_go` at the latest."""
        return self._tasks.begin(work, f"{what} {self.id}")

    async def let_go(self) -> None:
        await self._tasks.end()


def _address(config: DeviceConfig) -> int:
    address = config.link.get("address", ADDRESS)
    return address if isinstance(address, int) else ADDRESS
