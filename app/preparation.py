"""Compiles the kernels in the background while the server already answers.

`python -m stepscope.preparation` compiles them all, for an image or an installation; with the name of a job it compiles
what that needs, which is what this module starts: a thread of the server would keep it from answering for a minute.
"""

from __future__ import annotations

import asyncio
import contextlib
import logging
import os
import sys
import tempfile
from collections.abc import Callable, Collection, Mapping
from pathlib import Path

from .calc.motors import ring_down
from .calc.ramps import sramp
from .calc.ramps.ticked import RampParameters, exact_ramp
from .emulators.drive import DRIVE_JOB
from .emulators.drive import warm_up as warm_up_drive
from .emulators.families import FAMILIES
from .kernels import (
    Progress,
    all_compiled,
    can_keep,
    compiles_here,
    keep_in,
    kept_in,
    plain_meanwhile,
    serves_plain,
    tell_compiled,
)

log = logging.getLogger("stepscope.preparation")

PAGE_FIRST_S = 2.0
"""How long a start leaves the core to the page, unless somebody waits for a kernel [s]: looking for machine code
imports Numba, which is half a second in which little else is answered."""
LOADED_WITHIN_S = 20.0
"""How long who needs compiled code waits while it is taken from disk, some 2 s of work [s]."""
JOB_WITHIN_S = 600.0
"""What takes longer to compile is given up, and compiled by whoever needs it [s]."""

BEHIND = 5
"""How far behind the server's own those processes stand that compile: a Unix niceness."""


def _exact_ramp() -> None:
    exact_ramp(RampParameters(v_min=1, v_max=1000, a_max=100, ramp_div=5, pulse_div=5, pmul=100, pdiv=4), 1000, 10)


JOBS: Mapping[str, Callable[[], None]] = {
    **{family.name: family.warm_up for family in FAMILIES},
    DRIVE_JOB: warm_up_drive,
    "S-ramps": sramp.warm_up,
    "ramps": _exact_ramp,
    "swings": ring_down.warm_up,
}
"""What compiles, or takes from disk, by what it is for: families of emulators, what they share, then calculators."""
NEEDS: Mapping[str, tuple[str, ...]] = {family.name: family.needs for family in FAMILIES}
"""Jobs that have to be done before: two processes at the same time would both compile what both need."""
PLAIN = frozenset(family.name for family in FAMILIES)
"""What nobody has to wait for: plain Python serves until it is compiled, all chips and motors, only slower."""


def jobs_of(family: str) -> Mapping[str, Callable[[], None]]:
    """What compiles for the emulators of one family, and for nothing else; nothing where they have no kernels."""
    return {name: JOBS[name] for name in (*NEEDS.get(family, ()), family) if name in JOBS}


def compile_kernels() -> None:
    """Compile all in this process, or take it from disk: else the first move would wait for it."""
    for job in JOBS.values():
        job()
    tell_compiled()


class Preparation:
    """Has the kernels compiled, by as many processes as there are cores.

    plain : jobs that nobody waits for
    after_s : how long it leaves the core to others before it begins, unless somebody waits [s]
    """

    def __init__(
        self,
        processes: int | None = None,
        jobs: Mapping[str, Callable[[], None]] = JOBS,
        needs: Mapping[str, tuple[str, ...]] = NEEDS,
        plain: Collection[str] = PLAIN,
        after_s: float = 0.0,
    ) -> None:
        self.progress = Progress(total=0)
        self._jobs = jobs
        self._needs = {name: tuple(need for need in needs.get(name, ()) if need in jobs) for name in jobs}
        self._plain = plain
        self._processes = processes or os.cpu_count() or 1
        self._after_s = after_s
        self._wanted = asyncio.Event()
        self._looked = asyncio.Event()
        self._compiling = asyncio.Event()
        self._pending = list(jobs)
        self._done = {name: asyncio.Event() for name in jobs}
        self._workers: list[asyncio.Task[None]] = []
        self._folder: tempfile.TemporaryDirectory[str] | None = None
        self._failed = False

    async def start(self) -> None:
        """Look what is on disk, then begin to take it from there, or else to compile, and return.

        From the first moment on plain Python serves what it can.
        """
        plain_meanwhile(on=bool(self._plain))
        with contextlib.suppress(TimeoutError):
            await asyncio.wait_for(self._wanted.wait(), self._after_s)
        if not await asyncio.to_thread(all_compiled, self._jobs):
            if not await asyncio.to_thread(can_keep):
                self._keep_for_now()
            self.progress.total = len(self._jobs)
            self._compiling.set()
            log.warning("the first start compiles emulators in the background, for a minute; the rest works already")
        self.progress.looked = True
        self._looked.set()
        # Taking one from disk is 0.2 s at most: nobody needs to be told, and one process is enough.
        count = self._processes if self._compiling.is_set() else 1
        self._workers = [asyncio.create_task(self._work()) for _ in range(count)]

    async def compiles(self) -> None:
        """Wait until it turns out that something has to be compiled; for ever where all is on disk."""
        await self._compiling.wait()

    async def ready(self, name: str) -> None:
        """Wait until what the job of that name compiles can be used; it is the next that begins.

        Names of no job are ready, and so is what plain Python serves meanwhile.
        """
        for one in (name, *self._needs.get(name, ())):
            if one in self._pending:
                self._pending.remove(one)
                self._pending.insert(0, one)
        if self.delays(name):
            self._wanted.set()
            await self._done[name].wait()

    async def compiled(self) -> bool:
        """Whether no plain Python serves any more. What is on disk is waited for; nobody waits for a compiler."""
        if serves_plain():
            self._wanted.set()
            with contextlib.suppress(TimeoutError):
                async with asyncio.timeout(LOADED_WITHIN_S):
                    await self._looked.wait()
                    if not self._compiling.is_set():
                        await asyncio.gather(*(done.wait() for done in self._done.values()))
        return not serves_plain() and self.progress.done == self.progress.total

    def delays(self, name: str) -> bool:
        """Whether whoever needs what the job of that name compiles has to wait."""
        return name in self._done and not self._done[name].is_set() and name not in self._plain

    async def close(self) -> None:
        """End what is under way."""
        for worker in self._workers:
            worker.cancel()
        await asyncio.gather(*self._workers, return_exceptions=True)
        plain_meanwhile(on=False)
        if self._folder is not None:
            self._folder.cleanup()

    def _keep_for_now(self) -> None:
        """Where nothing can be kept, as in a container with a read-only root: at least from the processes that compile
        to this one, which would not answer while it compiles itself."""
        with contextlib.suppress(OSError):  # nor may temporary files be written
            self._folder = tempfile.TemporaryDirectory(prefix="stepscope-", ignore_cleanup_errors=True)
            keep_in(Path(self._folder.name))

    async def _work(self) -> None:
        compiling = self._compiling.is_set()
        while self._pending:
            name = next((one for one in self._pending if not self._missing(one)), None)
            if name is None:  # what the first needs is under way in another process
                await self._done[self._missing(self._pending[0])[0]].wait()
                continue
            self._pending.remove(name)
            try:
                if compiling:
                    self.progress.doing.append(name)
                    if kept_in() is not None:
                        await _compiled_by_a_child(name)
                await asyncio.to_thread(_now, self._jobs[name])  # from disk, or here where nothing can be kept
                if compiling:
                    tell_compiled(name)
            except Exception:  # whoever needs it compiles it, and is told why it fails
                self._failed = True
                log.exception("%s could not be %s beforehand", name, "compiled" if compiling else "loaded")
            finally:
                if compiling:
                    self.progress.doing.remove(name)
                    self.progress.done += 1
                self._done[name].set()
        if all(done.is_set() for done in self._done.values()):
            plain_meanwhile(on=False)
            if compiling and not self._failed and self._jobs.keys() >= JOBS.keys():
                tell_compiled()

    def _missing(self, name: str) -> list[str]:
        """Jobs that have to be done before this one and are not."""
        return [need for need in self._needs[name] if not self._done[need].is_set()]


def _now(job: Callable[[], None]) -> None:
    with compiles_here():
        job()


async def _compiled_by_a_child(name: str) -> None:
    """Have a process of its own compile it into the cache; what goes wrong there is found out here, later."""
    environment = {**os.environ, "PYTHONPATH": str(Path(__file__).parents[1])}
    process = await asyncio.create_subprocess_exec(
        *(sys.executable, "-P", "-m", f"{__package__}.preparation", name),
        stdin=asyncio.subprocess.DEVNULL,
        stdout=asyncio.subprocess.DEVNULL,
        stderr=asyncio.subprocess.DEVNULL,
        env=environment,
        start_new_session=True,  # Ctrl-C in the terminal is the server's
    )
    if hasattr(os, "setpriority"):
        with contextlib.suppress(OSError):
            os.setpriority(os.PRIO_PROCESS, process.pid, BEHIND)
    try:
        async with asyncio.timeout(JOB_WITHIN_S):
            await process.wait()
    except TimeoutError:
        log.warning("compiling %s took more than %g s", name, JOB_WITHIN_S)
    finally:
        if process.returncode is None:
            with contextlib.suppress(ProcessLookupError):
                process.kill()
            await process.wait()


async def compile_all(tell: Callable[[str], None], jobs: Mapping[str, Callable[[], None]] = JOBS) -> None:
    """Have all compiled, each job told as it is done: an image or an installation is left with nothing to compile."""
    preparation = Preparation(jobs=jobs, plain=())
    await preparation.start()
    for name in jobs:
        await preparation.ready(name)
        tell(f"compiled {name}")
    await preparation.close()


def _tell(line: str) -> None:
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


if __name__ == "__main__":
    if sys.argv[1:]:
        for job in sys.argv[1:]:
            JOBS[job]()
    else:
        asyncio.run(compile_all(_tell))
