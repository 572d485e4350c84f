"""Studies of this server: planned, started, looked at, ended, gone on with, and what they found taken or put back."""

from __future__ import annotations

import asyncio
import contextlib
import logging
import time
from collections.abc import Awaitable, Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Literal

from ..clock import Clock, WallClock
from ..devices.core.capabilities import EncoderSetting
from ..devices.core.device import Device
from ..errors import BenchError, WrongState
from ..procedures.procedures import Procedures
from ..profiles.capture import capture
from ..profiles.service import ProfileService
from ..recording.service import RecordingService, axes_of, configuration_of
from ..store.profiles import ProfileStore, SavedProfile
from ..store.recordings.library import NAME_MAX, Label
from ..store.recordings.marks import Mark
from ..telemetry.feed import Joined
from ..telemetry.hub import TelemetryHub
from ..telemetry.recorder import Trigger
from .custom_search.found import Searchable
from .custom_search.space import searchable
from .document import ScoredMove, StudyDocument
from .kinds import KINDS
from .moves import figures_of
from .plan import StudyPlan, axis_now, pressed_told
from .ramp_settings import document_of, held_of, value_now
from .record import Held, StudyRecord, Taken
from .run import StudyRun
from .scored_move.in_force import as_in_a_move
from .scored_move.noticed import NoticedMove
from .scored_move.study import scored, seen, tell
from .scored_move.watch import MoveWatch, Setting
from .store import StudyStore
from .table_settings import with_registers
from .twins.executor import Executor
from .twins.identified import with_its_twin

log = logging.getLogger("stepscope.studies")

RECORD_HZ = 200.0
NOTICED_MAX = 100
"""So many noticed moves of an axis are kept; nobody has asked for each of them."""
WATCHES_MAX = 8
"""Axes whose moves are noticed at the same time."""
Ready = Callable[[], Awaitable[None]]
"""Returns when the server can run a study. Raises WrongState where that takes too long."""
Which = Literal["best", "baseline"]
"""What a study found, or what was before it."""


def _import_scipy() -> None:
    """What studies calculate with: it takes a second, for which the first calculation would hold up everything."""
    from scipy import linalg, optimize, special, stats  # noqa: F401


@dataclass(slots=True)
class _Kept:
    """Where one study leaves what came of it."""

    store: StudyStore
    study: str
    note: Callable[[str, str], None]
    recording: str | None

    @property
    def folder(self) -> Path:
        return self.store.folder(self.study)

    async def save(self, record: StudyRecord) -> None:
        await self.store.save(record)

    def mark(self, text: str) -> None:
        if self.recording is not None:
            self.note(self.recording, text)


class StudyService:
    """All studies of this server."""

    def __init__(
        self,
        data_dir: Path,
        clock: Clock,
        device_of: Callable[[str], Device],
        procedures: Procedures,
        profiles: ProfileService,
        recordings: RecordingService,
        profile_store: ProfileStore,
        executor: Callable[[], Executor],
        hub: TelemetryHub,
    ) -> None:
        """`executor` makes what runs twins, for one search; moves by hand are noticed in the samples of `hub`."""
        self._clock, self._device_of = clock, device_of
        self._procedures, self._profiles = procedures, profiles
        self._recordings, self._profile_store = recordings, profile_store
        self._executor, self._hub = executor, hub
        self._watches: dict[tuple[str, int], MoveWatch] = {}
        self._store = StudyStore(data_dir, aside=isinstance(clock, WallClock))
        self._runs: dict[str, StudyRun] = {}
        self._ending: set[asyncio.Task[None]] = set()

    # --- looking --------------------------------------------------------------------------------

    def load(self) -> None:
        """For the start: read what is there, and tell of what was cut off. Nothing is done about it. Blocks."""
        for record in self._store.load():
            if record.state == "interrupted":
                log.warning("study %s of %s was cut off: GET /studies/%s", record.id, record.document.device, record.id)

    def all(self) -> list[StudyRecord]:
        """The latest first."""
        return self._store.all()

    def get(self, study: str) -> StudyRecord:
        """Raises UnknownThing."""
        return self._store.get(study)

    async def plan(self, document: StudyDocument) -> StudyPlan:
        """What a study would do. Nothing moves. Raises UnknownThing, WrongState where the device is not connected."""
        device, axis = self._of(document)
        device.session.require_connected()
        kind = KINDS[document.study.kind]
        document, no_twin = self._with_its_twin(document)
        plan = await kind.plan(device, axis, document)
        plan.goes_on = kind.goes_on
        plan.no_twin = no_twin if kind.on_twin else kind.no_twin or "no twin is known to be like the axis in this"
        plan.missing += self._in_the_way(device, axis)
        return plan

    def _of(self, document: StudyDocument) -> tuple[Device, int]:
        device = self._device_of(document.device)
        return device, device.axis(document.axis).index

    def _with_its_twin(self, document: StudyDocument) -> tuple[StudyDocument, str]:
        """The document with the twin that is tried first; or why there is none. Raises UnknownThing."""
        return with_its_twin(document, *self._of(document), self._store.all())

    def _in_the_way(self, device: Device, axis: int) -> list[str]:
        found = [f"a {one.kind} runs on axis {one.axis}: stop it first" for one in self._procedures.running(device)]
        if self._profiles.progress(device) is not None:
            found.append("a profile is being applied: wait until that is over")
        if self._profiles.unfinished(device) is not None:
            found.append("a profile is left half applied: take it back first (POST .../profile/apply/way-back)")
        for record in self._store.all():
            about = record.document
            if record.left and (about.device, about.axis) == (device.id, axis):
                found.append(f"study {record.id} has left the axis other than before: put that back first")
                break
        return found

    async def searchable(self, device: Device, axis: int) -> list[Searchable]:
        """Which settings of an axis an own search may try. Raises WrongState, BenchError."""
        missing: list[str] = []
        found = await axis_now(device, device.axis(axis).index, missing)
        if found is None:
            raise WrongState("; ".join(missing), "see to it first")
        return searchable(device, axis, found)

    # --- running --------------------------------------------------------------------------------

    async def start(self, document: StudyDocument, ready: Ready) -> StudyRecord:
        """Begin one as soon as the server is `ready`, and answer at once.

        Raises UnknownThing, and WrongState with what is missing, or where a stop of its axis comes first.
        """
        require_not_stopped = self._stop_guard(document)
        await ready()
        plan = await self.plan(document)
        if plan.missing:
            raise WrongState("; ".join(plan.missing), "see to it first: POST .../studies/plan tells the same")
        # The twin as it is now: a later study of motor and machine does not change this one when it is resumed.
        document, no_twin = self._with_its_twin(document)
        record = self._store.begin(document)
        record.no_twin = no_twin
        return await self._begin(record, plan.time_s, require_not_stopped)

    async def resume(self, study: str, ready: Ready) -> StudyRecord:
        """Put the axis back as it was, and go on where it was cut off: with the pieces that are whole where its kind
        `goes_on`, else anew. Raises UnknownThing, WrongState, BenchError."""
        record = self._store.get(study)
        if record.state in ("running", "done"):
            raise WrongState(f"the study {'runs' if record.state == 'running' else 'is over'}", "start a new one")
        require_not_stopped = self._stop_guard(record.document)
        await ready()
        kind = KINDS[record.document.study.kind]
        budget = record.document.budget
        far = budget.distance_fullsteps is not None and record.way_fullsteps > budget.distance_fullsteps
        if kind.goes_on and (far or record.ran_s > budget.time_s):
            raise WrongState("its budget is used up", "start a new one, with more")
        if record.left or (not kind.sets_nothing and await self._differences(record)):
            await self.restore(study)
        plan = await self.plan(record.document)
        # Cut off in its switch, it leaves that first.
        leaves = {pressed_told("left"), pressed_told("right")} if kind.goes_on and record.start is not None else set()
        missing = [line for line in plan.missing if line not in leaves]
        if missing:
            raise WrongState("; ".join(missing), "see to it first")
        record.state, record.ended_unix_s, record.message = "running", None, ""
        if not kind.goes_on:
            record.runs, record.way_fullsteps, record.ran_s, record.start = 0, 0.0, 0.0, None
        return await self._begin(record, plan.time_s, require_not_stopped)

    def _stop_guard(self, document: StudyDocument) -> Callable[[], None]:
        """Raises WrongState once its axis was stopped after this call: what takes a while must not begin after that."""
        device, axis = self._of(document)
        return device.session.stop_guard([axis])

    async def _begin(
        self, record: StudyRecord, planned_s: float, require_not_stopped: Callable[[], None]
    ) -> StudyRecord:
        await asyncio.to_thread(_import_scipy)
        device, axis = self._of(record.document)
        record.device_name, record.model = device.name, device.model
        kind = KINDS[record.document.study.kind]
        record.recording = await self._start_recording(device, axis, record, kind.channels)
        keeper = _Kept(self._store, record.id, self._note, record.recording)
        run = kind.make(device, axis, self._clock, record, keeper)
        run.over, run.executor = lambda: self._ended(record), self._executor
        run.planned_s = planned_s
        try:
            await keeper.save(record)
            require_not_stopped()
            self._procedures.start(run)
        except BenchError:
            record.state, record.phase, record.message = "failed", "over", "it could not begin"
            with contextlib.suppress(BenchError):  # else the next start would take it for one that was cut off
                await keeper.save(record)
            self._ended(record)
            raise
        self._runs[record.id] = run
        return record

    async def _start_recording(
        self, device: Device, axis: int, record: StudyRecord, quantities: Sequence[str]
    ) -> str | None:
        there = {channel.name for channel in device.telemetry.channels()}
        names = tuple(name for quantity in quantities if (name := f"{quantity}.{axis}") in there)
        label = Label(f"{record.document.title} of {device.name}"[:NAME_MAX], f"study {record.id}")
        try:
            configuration, axes = await configuration_of(device), await axes_of(device)
            return await self._recordings.start(
                device, names, RECORD_HZ, Trigger(), record.document.budget.time_s * 1.5, label, configuration, axes
            )
        except BenchError as error:
            log.warning("study %s is not recorded: %s", record.id, error)
            return None

    def _note(self, recording: str, text: str) -> None:
        try:
            self._recordings.note(recording, text)
        except BenchError as error:  # it is over: a full disk ends it
            log.info("%s is not in the recording: %s", text, error)

    def _ended(self, record: StudyRecord) -> None:
        self._runs.pop(record.id, None)
        if record.recording is not None:
            task = asyncio.create_task(self._stop_recording(record.recording), name=f"end of study {record.id}")
            self._ending.add(task)
            task.add_done_callback(self._ending.discard)

    async def _stop_recording(self, recording: str) -> None:
        try:
            await self._recordings.stop(recording)
        except BenchError as error:
            log.info("%s", error)

    async def stop(self, study: str) -> StudyRecord:
        """End it at once: the motor stops, and the setting before goes back. The record afterwards."""
        record = self._store.get(study)
        run = self._runs.get(study)
        if run is not None:
            await run.abort("stopped on request")
        elif record.state == "running":  # it is about to begin: a stop of its axis keeps it from that
            device, axis = self._of(record.document)
            await device.stop(axis)
        return record

    async def close(self) -> None:
        """For the end of the program: studies have been ended by their procedures."""
        await asyncio.gather(*(watch.end() for watch in self._watches.values()))
        if self._ending:
            await asyncio.wait(set(self._ending), timeout=1.0)

    async def delete(self, study: str) -> None:
        """Gone for good, but for its recording. Raises UnknownThing, WrongState, StoreUnavailable."""
        await asyncio.to_thread(self._store.delete, study)

    # --- moves by hand ----------------------------------------------------------------------------

    @property
    def watches(self) -> list[MoveWatch]:
        """Axes whose moves are noticed, whoever makes them."""
        for where, watch in list(self._watches.items()):
            if watch.over:
                del self._watches[where]
        return list(self._watches.values())

    def watch(self, device: Device, axis: int) -> MoveWatch:
        """Notice, record and score each move of that axis from now on; the same watch where that is so already.

        Raises UnknownThing, and WrongState without an encoder, or with too many axes watched.
        """
        where = device.id, device.axis(axis).index
        device.need(EncoderSetting).require_encoder(where[1])
        watches = self.watches
        if where not in self._watches:
            if len(watches) >= WATCHES_MAX:
                raise WrongState(f"moves of {WATCHES_MAX} axes are noticed already", "switch one of them off")
            self._watches[where] = MoveWatch(
                device,
                where[1],
                self._clock,
                self._hub,
                lambda: bool(self._procedures.running(device, where[1])),
                lambda *found: self._keep_noticed(device, where[1], *found),
            )
        return self._watches[where]

    async def unwatch(self, device: Device, axis: int) -> None:
        """Notice no more moves of that axis."""
        watch = self._watches.pop((device.id, axis), None)
        if watch is not None:
            await watch.end()

    async def _keep_noticed(
        self,
        device: Device,
        axis: int,
        move: NoticedMove,
        setting: Setting,
        joined: Joined,
        channels: tuple[str, ...],
    ) -> None:
        """Score a move that was noticed, and keep it with its recording. Raises WrongState, StoreUnavailable."""
        about = [record.document for record in self._store.all() if record.noticed]
        if sum((document.device, document.axis) == (device.id, axis) for document in about) >= NOTICED_MAX:
            raise WrongState(f"{NOTICED_MAX} noticed moves of this axis are kept", "delete some of them on Tune")
        distance, ground = move.target - move.sampled.start, setting.ground
        wanted = ScoredMove(distance=distance, repeats=1)
        record = self._store.begin(StudyDocument(device=device.id, axis=axis, study=wanted, name="Noticed move"))
        record.device_name, record.model, record.noticed, record.state = device.name, device.model, True, "done"
        rests_at = move.target if move.stalled_at is None else move.stalled_at
        band = wanted.band_fullsteps * ground.full_step
        figures = figures_of(move.sampled, rests_at, move.before, ground.full_step, band)
        if move.stalled_at is not None:
            figures = replace(figures, time_s=None)
        made = seen(figures, move.sampled, move.target, ground.full_step, move.stalled_at)
        tell(record, ground, scored(distance, [made], ground.stall_level))
        record.phase, record.progress, record.runs = "over", 1.0, 1
        record.way_fullsteps = abs(rests_at - move.sampled.start) / ground.full_step
        record.ended_unix_s = time.time()
        began_s = float(move.time_s[0] - move.sampled.time_s[0])
        marks = [Mark(began_s, "move", f"to {move.target}", axis)]
        label = Label(f"Noticed move of {device.name}"[:NAME_MAX], f"study {record.id}")
        rows = move.time_s, move.columns
        record.recording = await asyncio.to_thread(
            self._recordings.keep, device, channels, joined, rows, marks, label, setting.configuration, setting.axes
        )
        await self._store.save(record)

    # --- what came of it --------------------------------------------------------------------------

    def _registers(self, record: StudyRecord, which: Which | int) -> list[Held]:
        if which == "baseline":
            found = record.baseline
        else:
            others = [*record.front, *record.proved_alone]
            if which != "best" and which not in others:
                can = ", ".join(map(str, sorted(others)))
                told = f"{'the front' if record.front else 'it'} has {can}"
                if not can:
                    told = "it has no front: only its best setting can be taken"
                raise WrongState(f"trial {which} of study {record.id} is none that can be taken", told)
            trial = record.trial(record.best if which == "best" else which)
            found = [] if trial is None else trial.registers
        if not found:
            raise WrongState(f"study {record.id} has no {which} setting", "its record tells what came of it")
        return found

    async def take(self, study: str, which: Which | int) -> StudyRecord:
        """Set the axis to what the study found, to a trial of its front, to a threshold of StallGuard that is proved at
        one speed, or to what it was before: one transaction.

        which : a number is that of such a trial; one of the front held when it was tried, and only its best is proved.
        Raises UnknownThing, WrongState, and what `ProfileService.apply` does.
        """
        record = self._store.get(study)
        if record.state == "running":
            raise WrongState("the study runs", "stop it first, or wait for its end")
        device, _ = self._of(record.document)
        if record.model != device.model:
            raise WrongState(f"it was a study of a {record.model}, and {device.name} is a {device.model}", "")
        registers = self._registers(record, which)
        before = record.baseline
        if which == "best" and KINDS[record.document.study.kind].sets_nothing:
            held = await held_of(device)
            registers = as_in_a_move(device, record.document.axis, held, registers)
            now = [(each, value_now(device, held, each)) for each in registers]
            before = [each.model_copy(update={"value": value}) for each, value in now if value is not None]
        switched = record.left_switched if which == "baseline" else None
        if switched is not None:
            await device.registers.write(switched.name, switched.axis, None, {switched.field: switched.off})
        name = f"trial {which}" if isinstance(which, int) else which
        await self._profiles.apply(device, document_of(device, registers, f"{name} of study {study}"))
        if switched is not None:
            await device.registers.write(switched.name, switched.axis, None, {switched.field: switched.before})
        record.left, record.baseline = [], before
        trial = None if which == "baseline" else record.best if which == "best" else which
        proved = (trial == record.best and record.improved is True) or trial in record.proved_alone
        record.taken = None if trial is None else Taken(trial=trial, proved=proved)
        await self._store.save(record)
        return record

    async def restore(self, study: str) -> StudyRecord:
        """Put back what a study has left that was cut off. Raises as `take`."""
        return await self.take(study, "baseline")

    async def left(self, study: str) -> list[str]:
        """What is not as before now, register by register, of a study that was cut off. Raises BenchError."""
        record = self._store.get(study)
        return await self._differences(record) if record.left else []

    async def _differences(self, record: StudyRecord) -> list[str]:
        """What the axis is set to other than before the study, register by register. Raises BenchError."""
        device, _ = self._of(record.document)
        held = await held_of(device)
        told = []
        for each in record.baseline:
            now = value_now(device, held, each)
            if now != each.value:
                told.append(f"{each.name} is {'not known' if now is None else now}, and was {each.value}")
        if (switched := record.switched) is not None:
            now = (await device.registers.read(switched.name, switched.axis)).fields[switched.field]
            if now != switched.before:
                told.append(f"{switched.field} of {switched.name} is {now}, and was {switched.before}")
        return told

    async def keep(self, study: str) -> list[SavedProfile]:
        """Keep the setting before and the best one as whole profiles. Raises WrongState, StoreUnavailable."""
        record = self._store.get(study)
        device, _ = self._of(record.document)
        now = await capture(device)
        kept = []
        whiches: tuple[Which, ...] = ("baseline", "best")
        for which in whiches:
            try:
                registers = self._registers(record, which)
            except WrongState:
                continue
            name = f"{device.name}: {'before' if which == 'baseline' else 'best of'} {record.document.title}"[:100]
            document = with_registers(now, registers)
            kept.append(await self._profile_store.add(name, f"study {study}", document.model_dump(mode="json")))
        if not kept:
            raise WrongState(f"study {study} has no setting to be kept", "its record tells what came of it")
        return kept
