"""Where recordings are started and looked after: readers of telemetry on one side, files on the other."""

from __future__ import annotations

import asyncio
import logging
import threading
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass
from typing import Any

from ..clock import Clock
from ..devices.core.device import Device
from ..errors import BenchError, UsageError, WrongState
from ..links.port import FramePort
from ..links.registry import Link, PortFactory
from ..procedures.replay import Plan, Progress, Replay, plan_of
from ..profiles.capture import capture
from ..store.recordings.head import Column, Head
from ..store.recordings.library import NAME_MAX, Label, Library
from ..store.recordings.marks import Mark
from ..store.recordings.readers import Readers
from ..store.recordings.sink import FileSink, megabytes
from ..telemetry.feed import Joined
from ..telemetry.frames import FloatArray
from ..telemetry.hub import TelemetryHub
from ..telemetry.recorder import Recorder, State, Trigger

log = logging.getLogger("stepscope.recordings")

RUNNING_MAX = 16
REPLAYS_MAX = 2
KEPT = 100
"""How many that are over are remembered with why they ended."""


@dataclass(frozen=True, slots=True)
class Outcome:
    """How a recording went that is over: as a recorder tells it while it runs."""

    state: State
    message: str
    rows: int


Course = Recorder | Outcome


def open_no_port(model: str, link: Link, clock: Clock) -> FramePort:
    """Of a service that was given no way to make emulators."""
    raise UsageError(f"no {model} can be emulated here")


class RecordingService:
    """All recordings of this server."""

    def __init__(
        self,
        library: Library,
        hub: TelemetryHub,
        clock: Clock,
        unix_s: Callable[[], float] = time.time,
        reserve_bytes: int = 0,
        ports: PortFactory = open_no_port,
    ) -> None:
        """`ports` makes emulators for replays.

        `reserve_bytes` of the disk are left to the rest of the system: a recording ends before it takes them.
        """
        self.library = library
        self.readers = Readers()
        self.reserve_bytes = reserve_bytes
        self._hub, self._clock, self._unix_s = hub, clock, unix_s
        self._recorders: dict[str, Recorder] = {}
        """Those that run: one that is over would keep its device."""
        self._outcomes: dict[str, Outcome] = {}
        self._ports = ports
        self._replays: dict[str, Progress] = {}
        self._replaying: set[asyncio.Task[None]] = set()
        self._reading: asyncio.Task[None] | None = None
        self._closing = threading.Event()

    def read_ahead(self) -> None:
        """Read the heads of all recordings beside everything else, so that a first search finds them read."""
        self._reading = asyncio.create_task(
            asyncio.to_thread(self.library.read_all, self._closing), name="recordings are read"
        )

    async def start(
        self,
        device: Device,
        channels: tuple[str, ...],
        rate_hz: float,
        trigger: Trigger,
        duration_s: float | None,
        label: Label,
        configuration: Mapping[str, Any] | None,
        axes: tuple[Mapping[str, Any], ...] = (),
    ) -> str:
        """Begin, and answer with the id.

        Raises UnknownThing, OutOfRange for what cannot be recorded; WrongState for too many at once, or a disk that
        takes nothing.
        """
        if not channels:
            raise UsageError("a recording of no channel")
        if len(self.library.running) >= RUNNING_MAX:
            raise WrongState(f"{RUNNING_MAX} recordings are running", "stop one of them")
        self._require_room()
        recorder = Recorder(self._hub, device, channels, rate_hz, trigger, duration_s, self._clock)
        joined = recorder.joined
        head = self._head(device, channels, joined, trigger, configuration, axes)
        try:
            writer = self.library.begin(head, label)
        except OSError as error:
            self._hub.leave(joined.reader)
            raise WrongState(f"nothing can be recorded: {error}", "make room, or choose another --data-dir") from error
        self._recorders[head.id] = recorder
        sink = FileSink(self.library, head.id, writer, lambda: self.room_bytes)
        recorder.start(sink, lambda: self._over(head.id))
        return head.id

    def _head(
        self,
        device: Device,
        channels: tuple[str, ...],
        joined: Joined,
        trigger: Trigger,
        configuration: Mapping[str, Any] | None,
        axes: tuple[Mapping[str, Any], ...],
    ) -> Head:
        now_s = self._unix_s()
        return Head(
            id=self.library.new_id(now_s),
            device=device.id,
            model=device.model,
            columns=tuple(Column(name, unit) for name, unit in zip(channels, joined.units, strict=True)),
            rate_hz=joined.rate_hz,
            started_unix_s=now_s,
            time_origin_unix_s=joined.time_origin_unix_s,
            chip_timed=joined.chip_timed,
            clock_hz=device.clock_hz,
            trigger={name: getattr(trigger, name) for name in trigger.__slots__},
            configuration=configuration,
            axes=axes,
            emulator=options_of(device),
        )

    def keep(
        self,
        device: Device,
        channels: tuple[str, ...],
        joined: Joined,
        rows: tuple[FloatArray, FloatArray],
        marks: Sequence[Mark],
        label: Label,
        configuration: Mapping[str, Any] | None,
        axes: tuple[Mapping[str, Any], ...],
    ) -> str:
        """Keep what another reader of `channels` has got already, and answer with the id. Blocks.

        Parameters
        ----------
        joined : as the reader was told when it joined
        rows : device time [s] [rows], and the samples [channels, rows]

        Raises WrongState for a disk that takes nothing.
        """
        self._require_room()
        head = self._head(device, channels, joined, Trigger(), configuration, axes)
        try:
            sink = FileSink(self.library, head.id, self.library.begin(head, label), lambda: self.room_bytes)
            try:
                sink.append(*rows)
                for mark in marks:
                    sink.mark(mark.time_s, mark.kind, mark.text, mark.axis, mark.detail)
            finally:
                sink.close()
                self.library.ended(head.id)
        except OSError as error:
            raise WrongState(f"nothing can be recorded: {error}", "make room, or choose another --data-dir") from error
        return head.id

    def _over(self, recording: str) -> None:
        recorder = self._recorders.pop(recording)
        self._outcomes[recording] = Outcome(recorder.state, recorder.message, recorder.rows)
        while len(self._outcomes) > KEPT:  # dicts keep their order: the oldest
            del self._outcomes[next(iter(self._outcomes))]
        self.library.ended(recording)

    def _require_room(self) -> None:
        if self.room_bytes <= 0:
            left, kept = megabytes(self.library.free_bytes), megabytes(self.reserve_bytes)
            raise WrongState(
                f"the disk has {left} left, of which {kept} are not for recordings",
                "delete recordings, or choose another --data-dir",
            )

    @property
    def room_bytes(self) -> int:
        """How much may still be recorded."""
        return self.library.free_bytes - self.reserve_bytes

    def course(self, recording: str) -> Course | None:
        """How it goes, or went, where it ran lately."""
        return self._recorders.get(recording) or self._outcomes.get(recording)

    async def stop(self, recording: str) -> None:
        """End it with what is there; one that is over stays so. Raises UnknownThing."""
        self.library.entry(recording)
        recorder = self._recorders.get(recording)
        if recorder is not None:
            await recorder.stop()
        for progress in self._replays.values():
            if progress.recording == recording:
                progress.cancelled.set()

    def delete(self, recording: str) -> None:
        """Gone for good. Blocks. Raises UnknownThing, WrongState while it is being written, StoreUnavailable."""
        self.library.delete(recording)
        self._outcomes.pop(recording, None)

    def note(self, recording: str, text: str) -> None:
        """Mark this moment. Raises UnknownThing, WrongState for one that is over."""
        recorder = self._recorders.get(self.library.entry(recording).id)
        if recorder is None or recording not in self.library.running:
            raise WrongState(f"recording {recording} is over", "change its note instead")
        recorder.mark(text)

    async def replay(self, recording: str, options: Mapping[str, Any] | None, name: str | None) -> Progress:
        """Begin to live through a recording once more, on an emulator with `options` (None: the recording's own).

        Raises UnknownThing, WrongState for one without rows, while another replay of it runs, or with a full disk.
        """
        running = self._replays.get(recording)
        if running is not None and running.state == "running":
            raise WrongState(f"recording {recording} is being replayed", "wait for it")
        if len(self._replaying) >= REPLAYS_MAX:
            raise WrongState(f"{REPLAYS_MAX} replays are running", "wait for one of them")
        self._require_room()

        def read() -> tuple[Label, Plan]:
            opened, marks = self.library.open(recording), self.library.marks(recording)
            return self.library.entry(recording).label, plan_of(opened.head, marks, opened.first_s, opened.last_s)

        label, plan = await self.readers.do(read)
        chosen = options if options is not None else plan.head.emulator or {}
        called = name if name is not None else f"replay of {label.name or recording}"[:NAME_MAX]
        made: list[str] = []

        def begin(device: Device, recorder: Recorder) -> FileSink:
            now_s, joined = self._unix_s(), recorder.joined
            source = plan.head
            head = Head(
                id=self.library.new_id(now_s),
                device=source.device,
                model=source.model,
                columns=tuple(map(Column, (column.name for column in source.columns), joined.units)),
                rate_hz=joined.rate_hz,
                started_unix_s=now_s,
                time_origin_unix_s=now_s - device.device_time_s(),
                chip_timed=joined.chip_timed,
                clock_hz=source.clock_hz,
                trigger={"kind": "now"},
                configuration=source.configuration,
                axes=source.axes,
                emulator=dict(chosen),
                replay_of=source.id,
            )
            writer = self.library.begin(head, Label(called))
            made.append(head.id)
            replay.progress.recording = head.id
            return FileSink(self.library, head.id, writer, lambda: self.room_bytes)

        replay = Replay(plan, chosen, self._ports, begin, lambda: self.library.ended(made[0]))
        self._replays.pop(recording, None)
        self._replays[recording] = replay.progress
        while len(self._replays) > KEPT:
            del self._replays[next(iter(self._replays))]
        task = asyncio.create_task(asyncio.to_thread(replay.run), name=f"replay of {recording}")
        self._replaying.add(task)
        task.add_done_callback(self._replaying.discard)
        return replay.progress

    def progress(self, recording: str) -> Progress | None:
        """How the latest replay of a recording goes; None where there was none. Raises UnknownThing."""
        return self._replays.get(self.library.entry(recording).id)

    async def close(self) -> None:
        """End all of them: the server goes."""
        self._closing.set()
        if self._reading is not None:
            await asyncio.gather(self._reading, return_exceptions=True)
        for progress in self._replays.values():
            progress.cancelled.set()
        await asyncio.gather(*(recorder.stop() for recorder in self._recorders.values()))
        await asyncio.gather(*self._replaying, return_exceptions=True)
        self.readers.close()


async def axes_of(device: Device) -> tuple[dict[str, Any], ...]:
    """Settings of each axis, and where it is now, for the head of a recording; without the place where it is silent."""
    found = []
    for axis in device.axes:
        told: dict[str, Any] = {"settings": asdict(axis.settings), "position": None, "velocity_pps": None}
        told["microsteps_per_full_step"] = axis.microsteps_per_full_step  # the twin draws it without its device
        try:
            state = await device.monitor.axis_state(axis.index)
            told |= {"position": state.position, "velocity_pps": state.velocity_pps}
        except BenchError as error:
            log.warning("where axis %d of %s is, is not in the recording: %s", axis.index, device.id, error)
        found.append(told)
    return tuple(found)


def options_of(device: Device) -> dict[str, Any] | None:
    """An emulator's options; None of a device that is none. An address or a port is nobody's business later."""
    if not device.session.emulated:
        return None
    return {name: value for name, value in device.link.items() if name not in ("kind", "eeprom")}


async def configuration_of(device: Device) -> dict[str, Any] | None:
    """The device's profile for the head of a recording; None where it cannot be read now."""
    try:
        document = await capture(device)
    except BenchError as error:
        log.warning("the configuration of %s is not in the recording: %s", device.id, error)
        return None
    return document.model_dump(mode="json")
