"""Macros of this server: made of the log, tried on twins, run one a device at a time."""

from __future__ import annotations

import asyncio
from collections import OrderedDict
from dataclasses import dataclass

from ..aside import NotWorkedOut, worked_out
from ..clock import Clock
from ..devices.core.actor import actor
from ..devices.core.device import Device
from ..errors import BenchError, OutOfRange, StoreUnavailable, UnknownThing, WrongState
from ..procedures.procedures import Procedures
from ..profiles.capture import capture
from ..profiles.document import parse
from ..profiles.service import ProfileService
from ..recording.service import RecordingService, axes_of, configuration_of
from ..store.audit import AuditLog
from ..store.audit_entries import Entry, EntryFilter
from ..store.profiles import ProfileStore
from ..store.recordings.library import Label
from ..telemetry.recorder import Trigger
from .document import LONGEST_S, ApplyProfile, MacroDocument, RecordStart
from .from_log import WITHOUT_DEVICE, Draft, draft_of
from .run import MacroRun, MacroState
from .trial import TrialJob, TrialResult, run_trial

TRIAL_WITHIN_S = 120.0
TRIALS_KEPT = 500
TRIALS_WAITING_MAX = 4
ENTRIES_MAX = 2000


@dataclass(frozen=True, slots=True)
class Kept:
    """A macro and where it stands. id : empty, and revision 0, for a document that is not kept"""

    document: MacroDocument
    id: str = ""
    revision: int = 0


class MacroService:
    """All macros of this server."""

    def __init__(
        self,
        clock: Clock,
        procedures: Procedures,
        profiles: ProfileService,
        profile_store: ProfileStore,
        recordings: RecordingService,
        audit: AuditLog,
    ) -> None:
        self._clock, self._procedures, self._profiles = clock, procedures, profiles
        self._profile_store, self._recordings, self._audit = profile_store, recordings, audit
        self._runs: dict[str, MacroRun] = {}
        """The latest of each device, by the device's id."""
        self._tried: OrderedDict[tuple[str, str, str, int], bool] = OrderedDict()
        self._trying = asyncio.Lock()
        self._waiting = 0

    # --- made of the log --------------------------------------------------------------------------

    async def draft(self, device: Device, after: int, until: int | None, longest_pause_s: float) -> Draft:
        """Steps of what was done to `device` behind the entry `after`, `until` included. Raises StoreUnavailable."""
        before = None if until is None else until + 1
        entries = await self._audit.search(EntryFilter(device=device.id, after=after), ENTRIES_MAX, before)
        for action in WITHOUT_DEVICE:
            entries += await self._audit.search(EntryFilter(action=action, after=after), ENTRIES_MAX, before)
        unique = {entry.id: entry for entry in entries}
        ordered: list[Entry] = [unique[number] for number in sorted(unique, key=lambda number: number or 0)]
        kept = {saved.name: saved.id for saved in reversed(await self._profile_store.all(model=device.model))}
        draft = draft_of(ordered, device.id, longest_pause_s, kept.get)
        if len(entries) >= ENTRIES_MAX:
            draft.left_out.append(f"what is older than the latest {ENTRIES_MAX} entries")
        return draft

    # --- tried ------------------------------------------------------------------------------------

    def passed(self, device: Device, kept: Kept) -> bool | None:
        """Whether this very revision came to its end on a twin of that device; None where it was not tried."""
        return self._tried.get(_key(device, kept))

    async def try_out(self, device: Device, kept: Kept) -> TrialResult:
        """Try it on a twin of `device` as it is set now. Nothing moves. What cannot be tried is told in the answer.

        Raises WrongState where too many wait.
        """
        if self._waiting >= TRIALS_WAITING_MAX:
            raise WrongState(f"{self._waiting} macros are being tried, one after the other", "ask again in a while")
        self._waiting += 1
        try:
            async with self._trying:
                result = await self._try_out(device, kept)
        finally:
            self._waiting -= 1
        if kept.id and not result.why_not:
            self._tried[_key(device, kept)] = result.passed
            while len(self._tried) > TRIALS_KEPT:
                self._tried.popitem(last=False)
        return result

    async def _try_out(self, device: Device, kept: Kept) -> TrialResult:
        try:
            self._require_fit(device, kept.document)
            setting = await capture(device)
            positions = [(await device.monitor.axis_state(axis.index)).position for axis in device.axes]
            documents = {
                step.profile: (await self._profile_store.get(step.profile)).document
                for step in kept.document.steps
                if isinstance(step, ApplyProfile)
            }
        except BenchError as error:
            return TrialResult(why_not=f"the twin could not be made: {error}")
        job = TrialJob(
            device.model,
            device.clock_hz,
            tuple(axis.settings for axis in device.axes),
            tuple(positions),
            setting.model_dump(mode="json"),
            kept.document.model_dump(mode="json"),
            documents,
        )
        try:
            return await worked_out(self._clock, run_trial, job, within_s=TRIAL_WITHIN_S)
        except NotWorkedOut as error:
            return TrialResult(why_not=str(error))

    # --- run --------------------------------------------------------------------------------------

    def start(self, device: Device, kept: Kept) -> MacroState:
        """Begin. Raises WrongState while something else drives the device, and for a macro that does not fit."""
        self._require_fit(device, kept.document)
        for running in self._procedures.running(device):
            raise WrongState(f"a {running.kind} runs on axis {running.axis} of {device.name}", "stop it first")
        if self._profiles.progress(device) is not None:
            raise WrongState(f"a profile is being applied to {device.name}", "wait until that is over")
        if not kept.document.steps:
            raise WrongState(f"the macro {kept.document.name!r} has no steps", "add some, or record it again")
        state = MacroState(macro=kept.id, revision=kept.revision, by=actor.get().name)
        aside = _Aside(self._profiles, self._profile_store, self._recordings)
        run = MacroRun(device, self._clock, kept.document, aside, state, lambda told: self._over(device, told))
        self._procedures.start(run)
        self._runs[device.id] = run
        return run.state

    def _over(self, device: Device, told: MacroState) -> None:
        outcome = "done" if told.state == "done" else f"not proven: {told.message}"
        self._audit.note(
            "macro over",
            told.name,
            device=device.id,
            new=f"{len(told.done)} of {told.steps} steps",
            outcome=outcome,
            detail=f"{told.took_s:.3g} s",
        )

    def state(self, device: Device) -> MacroState:
        """How the present run goes, or how the latest one went."""
        run = self._runs.get(device.id)
        return MacroState() if run is None else run.state

    async def stop(self, device: Device) -> MacroState:
        """End it at once, and stop what it has moved; the state afterwards."""
        run = self._runs.get(device.id)
        if run is not None:
            await run.abort("stopped on request")
        return self.state(device)

    def _require_fit(self, device: Device, document: MacroDocument) -> None:
        if document.model and document.model != device.model:
            raise WrongState(
                f"the macro {document.name!r} is for a {document.model}, and {device.name} is a {device.model}",
                "save a copy for this model, and look at its figures",
            )
        for number, step in enumerate(document.steps, 1):
            axis = getattr(step, "axis", None)
            if axis is not None and axis >= len(device.axes):
                raise OutOfRange(f"axis of step {number}", axis, 0, len(device.axes) - 1)


def _key(device: Device, kept: Kept) -> tuple[str, str, str, int]:
    return device.id, device.model, kept.id, kept.revision


class _Aside:
    """Recordings and profiles of one run."""

    def __init__(self, profiles: ProfileService, store: ProfileStore, recordings: RecordingService) -> None:
        self._profiles, self._store, self._recordings = profiles, store, recordings
        self._recording: str | None = None

    async def record(self, device: Device, step: RecordStart) -> str:
        known = {channel.name for channel in device.telemetry.channels()}
        for name in step.channels:
            if name not in known:
                raise UnknownThing("channel", name, sorted(known))
        configuration, axes = await configuration_of(device), await axes_of(device)
        self._recording = await self._recordings.start(
            device,
            tuple(dict.fromkeys(step.channels)),
            step.rate_hz,
            Trigger(),
            LONGEST_S,
            Label(step.name, "by a macro"),
            configuration,
            axes,
        )
        return self._recording

    async def stop_recording(self) -> str:
        recording, self._recording = self._recording, None
        if recording is not None:
            await self._recordings.stop(recording)
        return recording or ""

    async def apply(self, device: Device, step: ApplyProfile) -> str:
        saved = await self._store.get(step.profile)
        try:
            outcome = await self._profiles.apply(device, parse(saved.document))
        except StoreUnavailable as error:
            raise WrongState(str(error), error.way_out) from error
        return f"{len(outcome.applied.written)} registers were written"
