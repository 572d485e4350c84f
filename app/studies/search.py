"""Which setting is tried next: Optuna, asked and told, with its memory in a SQLite file of the study, or in memory.

On the machine's clock everything of it runs in one thread of its own: neither its import nor its database holds up the
event loop, and the file has one writer. On a clock that waits for us there is nobody to hold up.
"""

from __future__ import annotations

import asyncio
import sqlite3
from collections.abc import Callable, Collection, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from .document import Sampler

T = TypeVar("T")
STUDY = "study"
LOST = "lost steps"
AGAIN = "again"
"""Of a trial that was cut off once: if it ends the study once more, it is left out."""
STARTUP_TRIALS = 8
"""Drawn at random before a model of them is made."""
WORSE = 1e9
"""CMA-ES knows no constraint, and goes by the order of its figures alone: what may not be is worse than all else."""


@dataclass(frozen=True, slots=True)
class Dimension:
    """One setting of the space: from low to high, in equal ratios where `log`."""

    name: str
    low: float
    high: float
    log: bool = True


@dataclass(frozen=True, slots=True)
class Asked:
    """What is to be tried next."""

    number: int
    values: Mapping[str, float]


@dataclass(frozen=True, slots=True)
class Space:
    """What is searched: its settings, how many objectives, and by which sampler."""

    dimensions: tuple[Dimension, ...]
    objectives: int
    sampler: Sampler


@dataclass(frozen=True, slots=True)
class Told:
    """What came of a setting: a figure an objective, the less the better; `violation` above 0 where it may not be."""

    values: Sequence[float]
    violation: float


def unbeaten(among: Sequence[T], costs: Callable[[T], Sequence[float]]) -> list[T]:
    """Those that no other beats: nowhere worse and somewhere better. costs : of each, the less the better"""

    def beats(one: T, other: T) -> bool:
        here, there = costs(one), costs(other)
        return all(a <= b for a, b in zip(here, there, strict=True)) and here != there

    return [one for one in among if not any(beats(other, one) for other in among)]


def _connected(path: Path) -> sqlite3.Connection:
    """To a file that outlives a killed server; what the last moments before a power cut told may be gone.

    Optuna commits some twenty times a setting: waiting for the disk each time took longer than many a move.
    """
    connection = sqlite3.connect(path, check_same_thread=False)
    for pragma in ("journal_mode=WAL", "synchronous=NORMAL"):
        connection.execute(f"PRAGMA {pragma}")
    return connection


class Searcher:
    """Asks Optuna for settings, and tells it what came of them. `close` it."""

    def __init__(
        self,
        path: Path | None,
        space: Space,
        seed: int,
        *,
        aside: bool = True,
    ) -> None:
        """`path` None: what it knows ends with it. `aside`: in a thread of its own."""
        self._path, self._space, self._seed = path, space, seed
        self._thread = ThreadPoolExecutor(1, "study search") if aside else None
        self._study: Any = None
        self._storage: Any = None
        self._open_trials: dict[int, Any] = {}

    async def open(self) -> int:
        """Begin, or go on where an earlier process was cut off; how many trials it knows."""
        return await self._do(self._open)

    def _open(self) -> int:
        import optuna
        from optuna.trial import TrialState

        optuna.logging.set_verbosity(optuna.logging.ERROR)
        if (path := self._path) is not None:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._storage = optuna.storages.RDBStorage(
                f"sqlite:///{path}", engine_kwargs={"creator": lambda: _connected(path)}
            )
        self._study = optuna.create_study(
            study_name=STUDY,
            storage=self._storage,
            load_if_exists=True,
            directions=["minimize"] * self._space.objectives,
            sampler=self._make_sampler(optuna),
            pruner=optuna.pruners.NopPruner(),
        )
        known = self._study.get_trials(deepcopy=False)
        for trial in known:
            if trial.state == TrialState.RUNNING:  # of a process that was cut off: it is tried once more
                self._study.tell(trial.number, state=TrialState.FAIL, skip_if_finished=True)
                if trial.params and AGAIN not in trial.user_attrs:
                    self._study.enqueue_trial(trial.params, {AGAIN: True})
        return len(known)

    def _make_sampler(self, optuna: Any) -> Any:
        samplers = optuna.samplers
        # Another seed after a restart: else it would ask for what it has asked for already.
        seed = self._seed
        if self._space.sampler == "cmaes":
            return samplers.CmaEsSampler(seed=seed, n_startup_trials=STARTUP_TRIALS)
        if self._space.sampler == "nsga2":
            return samplers.NSGAIISampler(seed=seed, population_size=max(8, STARTUP_TRIALS))
        return samplers.TPESampler(seed=seed, n_startup_trials=STARTUP_TRIALS)

    async def first(self, settings: Sequence[Mapping[str, float]]) -> None:
        """Ask for these before any other."""

        def work() -> None:
            for setting in settings:
                self._study.enqueue_trial(dict(setting), skip_if_exists=True)

        await self._do(work)

    async def ask(self, without: Collection[str] = ()) -> Asked:
        """What to try next; `without` settings that are left out of it."""

        def work() -> Asked:
            import optuna

            distributions = {
                each.name: optuna.distributions.FloatDistribution(each.low, each.high, log=each.log)
                for each in self._space.dimensions
                if each.name not in without
            }
            trial = self._study.ask(distributions)
            self._open_trials[trial.number] = trial
            return Asked(trial.number, dict(trial.params))

        return await self._do(work)

    async def tell(self, asked: Asked, values: Sequence[float], violation: float) -> None:
        """What came of it: a figure an objective, the less the better; `violation` above 0 where it may not be."""

        def work() -> None:
            trial = self._open_trials.pop(asked.number)
            if self._space.sampler == "cmaes":
                self._study.tell(trial, WORSE + violation if violation > 0 else values[0])
                return
            trial.set_constraint(LOST, violation)
            self._study.tell(trial, list(values))

        await self._do(work)

    async def prune(self, asked: Asked, value: float, violation: float = 0.0) -> None:
        """It was not tried: it could not be better than `value`, or above a `violation` of 0 it could not be at all."""

        def work() -> None:
            from optuna.trial import TrialState

            trial = self._open_trials.pop(asked.number)
            if self._space.sampler == "cmaes":  # it learns by whole generations, and would ask for the same for ever
                self._study.tell(trial, WORSE + violation if violation > 0 else value)
            elif self._space.objectives == 1:
                trial.report(value, 0)
                trial.set_constraint(LOST, 0.0)
                self._study.tell(trial, state=TrialState.PRUNED)
            else:
                self._study.tell(trial, state=TrialState.FAIL)

        await self._do(work)

    async def fail(self, asked: Asked) -> None:
        """It came to nothing."""

        def work() -> None:
            from optuna.trial import TrialState

            if self._open_trials.pop(asked.number, None) is not None:
                self._study.tell(asked.number, state=TrialState.FAIL, skip_if_finished=True)

        await self._do(work)

    async def _do(self, work: Callable[[], T]) -> T:
        if self._thread is None:
            return work()
        return await asyncio.get_running_loop().run_in_executor(self._thread, work)

    def close(self) -> None:
        """Let go of the file. What runs in the thread comes to its end."""

        def work() -> None:
            if self._storage is not None:
                self._storage.remove_session()
                self._storage.engine.dispose()

        if self._thread is None:
            work()
            return
        self._thread.submit(work)
        self._thread.shutdown(wait=False)
