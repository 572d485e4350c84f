"""What interpreters of programs do, looked at for as long as a reader wants to know: once for all readers of a device.

Nobody is asked while nobody listens. Looks have the priority of samples, so that commands and stops go before them; in
download mode, and while a device is not connected, none goes out.
"""

from __future__ import annotations

import asyncio
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import cast

from ...clock import BackgroundClock
from ...devices.core.background_tasks import BackgroundTasks
from ...devices.core.capabilities import ProgramMemory
from ...devices.core.device import Device
from ...devices.core.results import ProgramState
from ...emulators.core.family import Emulator
from ...emulators.core.ground_truth import ProgramGroundTruth
from ...errors import BenchError, UsageError, WrongState
from ...links.emulator import EmulatorPort
from ...links.queue import Priority, SampleDropped
from ...procedures.debugging import DebugState
from ...procedures.procedures import Procedures

POLL_HZ = 20.0
"""How often a device is looked at, at most."""
WIRE_SHARE = 0.25
"""How much of a wire's time polling may take: on a slow one they come less often."""
READERS_MAX = 16
"""Of one device."""
VARIABLES_MAX = 64
"""That all readers of one device watch together."""
TRACE_MAX = 200
"""Addresses that one message tells; of more the latest."""


@dataclass(frozen=True, slots=True)
class ProgramSample:
    """One sample. `ground_truth`: of emulators alone; `trace`: the commands done by single steps since the last one."""

    time_s: float
    state: ProgramState
    ground_truth: ProgramGroundTruth | None
    debug: DebugState
    trace: tuple[int, ...]


News = ProgramSample | BenchError
"""A look, or why there is none."""


class Reader:
    """What one client has not been told yet: the latest look alone, so that a slow one costs no more."""

    def __init__(self, variables: tuple[int, ...]) -> None:
        self.variables = variables
        self._latest: News | None = None
        self._trace: tuple[int, ...] = ()
        self._arrived = asyncio.Event()

    def tell(self, news: News) -> None:
        """Replaces what waits; addresses of commands are kept, the latest of them."""
        self._latest = news
        if isinstance(news, ProgramSample):
            self._trace = (*self._trace, *news.trace)[-TRACE_MAX:]
        self._arrived.set()

    async def next(self) -> tuple[News, tuple[int, ...]]:
        """Wait for news; with it the commands that were done by single steps since the news before."""
        await self._arrived.wait()
        self._arrived.clear()
        assert self._latest is not None
        latest, trace, self._trace = self._latest, self._trace, ()
        return latest, trace


@dataclass(slots=True)
class _Watched:
    readers: list[Reader]
    polling: asyncio.Task[None]
    traced: tuple[object, int] = (None, 0)
    """Whose trace was told, and how far."""


class ProgramWatch:
    """Of all devices."""

    def __init__(self, clock: BackgroundClock, procedures: Procedures) -> None:
        self._clock = clock
        self._procedures = procedures
        self._watched: dict[Device, _Watched] = {}
        self._tasks = BackgroundTasks()

    def rate_hz(self, device: Device, variables: int) -> float:
        """About how often the device is looked at."""
        possible = device.session.calls_per_s_possible
        if possible is None:
            return POLL_HZ
        questions = device.need(ProgramMemory).state_questions(variables)
        return float(min(POLL_HZ, WIRE_SHARE * possible / questions))

    def join(self, device: Device, variables: Iterable[int]) -> tuple[Reader, Callable[[], None]]:
        """A reader from now on, and the function that ends it. Raises WrongState, UsageError for too many."""
        device.need(ProgramMemory)
        reader = Reader(tuple(variables))
        watched = self._watched.get(device)
        if watched is None:
            _require_few([reader])
            polling = self._tasks.begin(self._keep_polling(device), f"program of {device.id}")
            watched = self._watched[device] = _Watched([], polling)
        elif len(watched.readers) >= READERS_MAX:
            raise WrongState(f"{READERS_MAX} clients watch the program of {device.name} already", "close one of them")
        else:
            _require_few([*watched.readers, reader])
        watched.readers.append(reader)

        def end() -> None:
            watched.readers.remove(reader)
            if not watched.readers:
                watched.polling.cancel()
                del self._watched[device]

        return reader, end

    def choose(self, device: Device, reader: Reader, variables: Iterable[int]) -> None:
        """Watch these variables instead. Raises UsageError where all readers want too many."""
        others = [other for other in self._watched[device].readers if other is not reader]
        wanted = tuple(variables)
        _require_few([*others, Reader(wanted)])
        reader.variables = wanted

    async def close(self) -> None:
        """Look at nothing any more."""
        await self._tasks.end()

    async def _keep_polling(self, device: Device) -> None:
        while True:
            began_s = self._clock.now()
            news = await self._poll(device)
            if news is not None:
                for reader in tuple(self._watched[device].readers):
                    reader.tell(news)
            took_s = self._clock.now() - began_s
            # An emulator in this process has no wire that a look would take from others.
            rest_s = 0.0 if device.session.chip_timed else took_s * (1 / WIRE_SHARE - 1)
            await self._clock.sleep(max(1 / POLL_HZ - took_s, rest_s, 0.001))

    async def _poll(self, device: Device) -> News | None:
        """None where the link is too busy for it just now."""
        if device.state != "connected":
            return device.problem or WrongState(f"{device.name} is not connected", "connect it first")
        watched = self._watched[device]
        variables = sorted({number for reader in watched.readers for number in reader.variables})
        try:
            state = await device.need(ProgramMemory).program_state(variables, Priority.SAMPLE)
            ground_truth = _ground_truth(device)
        except SampleDropped:
            return None
        except BenchError as error:
            return error
        run = self._procedures.debugging(device)
        trace: tuple[int, ...] = ()
        if run is not None:
            told = watched.traced[1] if watched.traced[0] is run else 0
            trace = tuple(run.trace)[-max(0, run.steps - told) :] if run.steps > told else ()
            watched.traced = (run, run.steps)
        time_s = device.session.port.last_exchange_s
        return ProgramSample(time_s, state, ground_truth, self._procedures.debug_state(device), trace[-TRACE_MAX:])


def _require_few(readers: Iterable[Reader]) -> None:
    wanted = {number for reader in readers for number in reader.variables}
    if len(wanted) > VARIABLES_MAX:
        raise UsageError(f"{len(wanted)} variables are to be watched; at most {VARIABLES_MAX}")


def _ground_truth(device: Device) -> ProgramGroundTruth | None:
    """What only an emulator can tell, of the moment of its latest answer."""
    port = device.session.port
    if not isinstance(port, EmulatorPort):
        return None
    return cast("Emulator", port.wire).ground_truth(0, port.last_exchange_s).program
