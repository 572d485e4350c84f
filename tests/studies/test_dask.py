"""Twins on a Dask cluster: the same figures as here, a worker that is killed, and what is told where there is none."""

from __future__ import annotations

import asyncio
import copy
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest
from pydantic import ValidationError
from typer.testing import CliRunner

from app.cli import cli
from app.clock import WallClock
from app.errors import WrongState
from app.settings import Settings
from app.studies.twins.choice import executor_of
from app.studies.twins.dask_cluster import PACKAGES, DaskCluster, differences
from app.studies.twins.executor import TwinJob
from app.studies.twins.twin import run_job
from tests.studies.cluster import Cluster
from tests.studies.harness import studied
from tests.studies.twin_jobs import LOAD, move_job

JOBS = 5


@pytest.fixture
async def job(tmp_path: Path) -> TwinJob:
    async with studied(tmp_path, load=LOAD) as s:
        return await move_job(s, distance=60_000)


@pytest.fixture
def cluster(tmp_path: Path) -> Iterator[Cluster]:
    with Cluster(tmp_path) as made:
        yield made


async def test_a_cluster_tries_what_would_be_tried_here_and_a_killed_worker_loses_nothing_else(
    cluster: Cluster, job: TwinJob
) -> None:
    for _ in range(2):
        cluster.add_worker()
    here = await asyncio.to_thread(run_job, job)
    twins = DaskCluster(cluster.address)
    try:
        assert await twins.ready() >= 1, cluster.log()
        first = await twins.submit(job)
        assert first == here
        under_way = [asyncio.create_task(twins.submit(job)) for _ in range(JOBS)]
        await under_way[0]
        cluster.workers[0].kill()
        assert await asyncio.gather(*under_way) == [here] * JOBS
    finally:
        await twins.close()


async def test_a_scheduler_without_workers_says_how_to_start_one(
    cluster: Cluster, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("app.studies.twins.dask_cluster.WORKERS_S", 0.3)
    twins = DaskCluster(cluster.address)
    try:
        with pytest.raises(WrongState, match=r"has no worker; start one .*: dask worker tcp://"):
            await twins.ready()
    finally:
        await twins.close()


async def test_a_scheduler_that_does_not_answer_is_not_waited_for_long(
    monkeypatch: pytest.MonkeyPatch, unused_tcp_port: int
) -> None:
    monkeypatch.setattr("app.studies.twins.dask_cluster.ANSWER_S", 0.5)
    twins = DaskCluster(f"tcp://127.0.0.1:{unused_tcp_port}")
    began_s = asyncio.get_running_loop().time()
    with pytest.raises(WrongState, match=r"no Dask scheduler answers at tcp://.*; start one there \(dask scheduler\)"):
        await twins.ready()
    assert asyncio.get_running_loop().time() - began_s < 10
    await twins.close()


def test_without_the_package_the_server_says_which_extra_it_takes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(WrongState, match=r"Dask is not installed here; .*pip install 'stepscope\[dask\]'"):
        executor_of(WallClock(), "tcp://127.0.0.1:8786")


def test_an_address_has_a_protocol_and_a_port() -> None:
    assert Settings(dask="tcp://cluster.lab:8786").dask == "tcp://cluster.lab:8786"
    for wrong in ("cluster:8786", "tcp://cluster", "http://cluster:8787", ""):
        with pytest.raises(ValidationError, match="dask"):
            Settings(dask=wrong)
    told = CliRunner().invoke(cli, ["serve", "--dask", "cluster"])
    assert told.exit_code == 1
    assert "dask" in told.stderr


def test_a_worker_with_other_packages_is_named_with_what_differs() -> None:
    has: dict[str, dict[str, str | None]] = {
        "host": {"python": "3.11.7.final.0"},
        "packages": dict.fromkeys(PACKAGES, "1.0"),
    }
    old, bare = copy.deepcopy(has), copy.deepcopy(has)
    old["host"]["python"], old["packages"]["numba"] = "3.12.1.final.0", "0.9"
    bare["packages"]["stepscope"] = None
    told = {"client": has, "workers": {"tcp://a:1": has, "tcp://b:2": old, "tcp://c:3": bare}}
    assert differences(told) == [
        "tcp://b:2 has python 3.12, not 3.11, numba 0.9, not 1.0",
        "tcp://c:3 has stepscope not at all, not 1.0",
    ]
    many = {f"tcp://w{index}:1": old for index in range(9)}
    assert differences({"client": has, "workers": many})[-1] == "and 4 more"
