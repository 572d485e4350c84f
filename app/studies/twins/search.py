"""The search on twins: settings asked of Optuna here, tried wherever the executor runs twins."""

from __future__ import annotations

import asyncio
from collections import deque
from collections.abc import Mapping, Sequence

from ...clock import WallClock
from ...devices.core.device import Device
from ...errors import BenchError, WrongState
from ...profiles.capture import capture
from ...profiles.document import ProfileDocument
from ..document import StudyDocument, Twin, TwinMotor
from ..record import Finding, Trial, TwinSetting
from ..run import StudyRun
from ..search import Asked, Searcher, Space
from .executor import Executor, JobLost, TwinJob
from .on_twin import OnTwin

AHEAD = 2
"""So many settings a worker are under way: it never waits for the next one."""
APART = 0.08
"""Share of the first objective that two settings of a twin have to be apart to be worth a trial each."""
PROGRESS = (0.05, 0.1)
"""Of the whole study: where the twin begins and ends."""
LOST_MAX = 3
"""So many settings lost one after the other: nothing there tries any."""
TIME_SHARE = 0.5
"""Of the time that the study may cost: no new setting is asked for afterwards."""


async def look_on_twins(
    run: StudyRun, on_twin: OnTwin, twin: Twin, space: Space, first: Sequence[Mapping[str, float]]
) -> None:
    """Search on twins, and leave the best settings in the record, the best first; the motor rests meanwhile.

    What fails there costs nothing here: it is told in the record, and the study goes on. `first` is tried first.
    Raises BenchError where the device or the disk does not answer.
    """
    record = run.record
    run.tell("twin", PROGRESS[0], f"trying {twin.trials} settings on an emulated twin")
    profile = await capture(run.device)
    searcher = Searcher(None, space, record.document.seed, aside=isinstance(run.clock, WallClock))
    search = TwinSearch(run, on_twin, twin, searcher, profile)
    try:
        await searcher.open()
        await searcher.first(first)
        found = Finding(name="twin", text=await search.search())
    except (BenchError, ValueError, OSError) as error:
        found = Finding(name="twin", text=f"could not be tried: {error}", sure="missing")
    finally:
        searcher.close()
    record.findings.append(found)
    await run.keeper.save(record)


def job_of(
    device: Device, axis: int, profile: ProfileDocument, motor: TwinMotor, document: StudyDocument, asked: Asked
) -> TwinJob:
    """A setting to be tried on a twin of an axis: its registers, and the motor as it is told."""
    return TwinJob(
        model=device.model,
        clock_hz=device.clock_hz,
        axes=tuple(each.settings for each in device.axes),
        axis=axis,
        profile=profile.model_dump(mode="json"),
        motor=motor.model_dump(mode="json"),
        document=document.model_dump(mode="json"),
        number=asked.number,
        values=asked.values,
    )


class TwinSearch:
    """One search: several settings under way, told in the order in which they were asked for."""

    def __init__(
        self, run: StudyRun, on_twin: OnTwin, twin: Twin, searcher: Searcher, profile: ProfileDocument
    ) -> None:
        self._run, self._on_twin, self._twin, self._searcher = run, on_twin, twin, searcher
        self._profile = profile
        self._held: list[TwinSetting] = []
        self._failed: list[str] = []
        self._lost = self._lost_running = self._done = 0
        self._began_s = run.since_s

    async def search(self) -> str:
        """Try as many settings as the twin is worth; what came of it, in words. Raises BenchError where none can be."""
        executor = self._run.executor()
        under_way: deque[tuple[Asked, asyncio.Task[dict[str, object]]]] = deque()
        try:
            at_once = await executor.ready()
            asked_for = 0
            while True:
                while asked_for < self._twin.trials and len(under_way) < AHEAD * at_once and not self._late():
                    asked = await self._searcher.ask()
                    under_way.append((asked, asyncio.create_task(executor.submit(self._job(asked)), name="twin")))
                    asked_for += 1
                if not under_way:
                    return self._text(executor)
                asked, trying = under_way.popleft()
                await self._heard(asked, trying)
        finally:
            for _, trying in under_way:
                trying.cancel()
            await executor.close()

    def _late(self) -> bool:
        return self._run.spent(share=TIME_SHARE)

    def _job(self, asked: Asked) -> TwinJob:
        run = self._run
        return job_of(run.device, run.axis, self._profile, self._twin.motor, run.record.document, asked)

    async def _heard(self, asked: Asked, trying: asyncio.Task[dict[str, object]]) -> None:
        try:
            trial = Trial.model_validate(await trying)
        except JobLost as error:
            self._lost, self._lost_running = self._lost + 1, self._lost_running + 1
            await self._searcher.fail(asked)
            if self._lost_running >= LOST_MAX:
                raise WrongState(f"{LOST_MAX} settings in turn were lost: {error}", "see to the workers") from error
        else:
            self._lost_running = 0
            await self._judge(asked, trial)
        self._done += 1
        left = self._twin.trials - self._done
        low, high = PROGRESS
        self._run.tell(
            "twin",
            low + (high - low) * self._done / self._twin.trials,
            f"{self._done} of {self._twin.trials} settings tried on an emulated twin",
            left * (self._run.since_s - self._began_s) / self._done,
        )

    async def _judge(self, asked: Asked, trial: Trial) -> None:
        if trial.state == "failed":
            self._failed.append(trial.why)
            await self._searcher.fail(asked)
            return
        told = self._on_twin.told(self._run.record.document, trial)
        await self._searcher.tell(asked, told.values, told.violation)
        if trial.state == "feasible":
            self._held.append(
                TwinSetting(setting=trial.setting, time_s=trial.figures.time_s, value=float(told.values[0]))
            )
            self._held.sort(key=lambda setting: setting.value)
            self._run.record.twin = apart(self._held, self._twin.best)

    def _text(self, executor: Executor) -> str:
        parts = [f"{len(self._held)} of {self._done} settings held on an emulated twin, tried {executor.where}"]
        if self._failed:
            parts.append(f"{len(self._failed)} came to nothing: {self._failed[0]}")
        if self._lost:
            parts.append(f"{self._lost} lost with a worker")
        return "; ".join(parts)


def apart(settings: Sequence[TwinSetting], count: int) -> list[TwinSetting]:
    """Up to `count` of them, the best first, each worse than the one before by `APART`. `settings`: the best first.

    So one of the slower ones holds where the axis is weaker than its twin.
    """
    chosen: list[TwinSetting] = []
    for setting in settings:
        if len(chosen) < count and (not chosen or setting.value >= chosen[-1].value + APART * abs(chosen[-1].value)):
            chosen.append(setting)
    return chosen
