"""Settings tried on twins: what a second Dask worker brings, and what a killed one costs.

The scheduler and its workers are processes of this machine, of one thread each. One worker and two try the same jobs in
turn, many times, as a machine that has other work too would spoil one look; the figure is the median of the ratios.
Then a study's whole search runs on two workers, and one is killed in the middle of it.
"""

from __future__ import annotations

import asyncio
import re
import statistics
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from app.studies.record import StudyRecord
from app.studies.twins.dask_cluster import DaskCluster
from app.studies.twins.executor import TwinJob
from app.studies.twins.search import AHEAD
from tests.bench.table import Row
from tests.studies.cluster import Cluster
from tests.studies.harness import STEP_S, studied
from tests.studies.twin_jobs import LOAD, MOTOR, MOVE, move_job

REQUIRED = 1.7
TRIALS = 40
DISTANCE = 400_000
"""So long that a job is a second or so: what a search of long moves asks for."""


async def _job(folder: Path) -> TwinJob:
    async with studied(folder, load=LOAD) as s:
        return await move_job(s, distance=DISTANCE)


async def _ratios(one: Cluster, two: Cluster, job: TwinJob, jobs: int, turns: int) -> list[float]:
    """How many times as fast two workers are as one, in each of `turns`."""
    alone, both = DaskCluster(one.address), DaskCluster(two.address)

    async def seconds(twins: DaskCluster, workers: int) -> float:
        under_way = asyncio.Semaphore(AHEAD * workers)  # as a search has it: what waits is not lost to a busy machine

        async def submit() -> None:
            async with under_way:
                await twins.submit(job)

        began_s = time.perf_counter()
        await asyncio.gather(*(submit() for _ in range(jobs)))
        return time.perf_counter() - began_s

    try:
        assert (await alone.ready(), await both.ready()) == (1, 2)
        for twins, workers in ((alone, 1), (both, 2)):
            await seconds(twins, workers)  # all of them warm
        return [await seconds(alone, 1) / await seconds(both, 2) for _ in range(turns)]
    finally:
        await alone.close()
        await both.close()


@contextmanager
def _cluster(folder: Path, workers: int) -> Iterator[Cluster]:
    folder.mkdir()
    with Cluster(folder) as cluster:
        for _ in range(workers):
            cluster.add_worker()
        until_s = time.monotonic() + 60
        while cluster.log().count("Registered to:") < workers and time.monotonic() < until_s:
            time.sleep(0.1)
        yield cluster


async def _killed(cluster: Cluster, folder: Path) -> StudyRecord:
    """A study whose search runs on the cluster; one worker is killed after a quarter of it."""
    async with studied(folder, load=LOAD) as s:
        study: dict[str, Any] = {**MOVE, "twin": {"trials": TRIALS, "motor": MOTOR}}
        run = s.begin(s.document(study, budget={"trials": 3, "time_s": 80_000.0}))
        run.executor = lambda: DaskCluster(cluster.address)
        until_s = time.monotonic() + 300
        while run.running and time.monotonic() < until_s:
            if run.record.message.startswith(f"{TRIALS // 4} of") and cluster.workers[0].poll() is None:
                cluster.workers[0].kill()
            await s.clock.advance(STEP_S)
            await asyncio.sleep(0.002 if run.record.phase == "twin" else 0)  # the cluster's time is the machine's
        return run.record


def measure(quick: bool) -> Sequence[Row]:
    jobs, turns = (8, 3) if quick else (16, 11)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        job = asyncio.run(_job(folder))
        with _cluster(folder / "one", 1) as one, _cluster(folder / "two", 2) as two:
            ratios = asyncio.run(_ratios(one, two, job, jobs, turns))
            record = asyncio.run(_killed(two, folder / "study"))
            died = two.workers[0].poll() is not None
    text = next((each.text for each in record.findings if each.name == "twin"), "nothing")
    told = re.search(r"([0-9]+) lost with a worker", text)
    lost = int(told[1]) if told else 0
    ratio = statistics.median(ratios)
    return [
        Row(
            what=f"{jobs} settings on twins: two Dask workers beside one",
            measured=f"{ratio:.2f} times as fast",
            peer="one worker",
            ratio=ratio,
            required=f">= {REQUIRED:g}",
            ok=ratio >= REQUIRED,
            notes=(f"of {turns} turns: " + ", ".join(f"{one:.2f}" for one in sorted(ratios)),),
        ),
        Row(
            what=f"a Dask worker killed in a search of {TRIALS} settings",
            measured=f"{lost} settings lost",
            peer="1",
            ratio=float(lost),
            required="<= 1, study done",
            ok=lost <= 1 and died and record.state == "done" and "held" in text,
            notes=(text,),
        ),
    ]
