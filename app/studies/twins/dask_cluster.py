"""Twins on a Dask cluster: the same jobs, as tasks of its workers. `dask` is an extra, brought in when it is used."""

from __future__ import annotations

import asyncio
import importlib
from collections.abc import Mapping
from typing import Any

from ...errors import WrongState
from .executor import JOB_S, JobLost, TwinJob
from .twin import run_job

ANSWER_S = 5.0
"""A scheduler that has not answered by then is none [s]."""
WORKERS_S = 5.0
"""A scheduler without a worker is waited for so long [s]."""
PACKAGES = ("stepscope", "numpy", "numba", "scipy")
"""What has to be of the same version there as here: another one may come to other figures."""
EXTRA = "pip install 'stepscope[dask]'"


class DaskCluster:
    """Runs twins wherever the workers of one scheduler are. A worker that dies costs at most what it tried."""

    def __init__(self, address: str) -> None:
        """`address` of the scheduler: tcp://HOST:PORT."""
        self._address = address
        self._client: Any = None
        self._threads = 0

    @property
    def where(self) -> str:
        return f"by {self._threads} threads of the Dask cluster at {self._address}"

    async def ready(self) -> int:
        distributed = require_dask()
        try:
            self._client = await distributed.Client(
                self._address, asynchronous=True, timeout=ANSWER_S, set_as_default=False, name="stepscope"
            )
        except (OSError, TimeoutError) as error:
            raise WrongState(
                f"no Dask scheduler answers at {self._address} within {ANSWER_S:g} s",
                "start one there (dask scheduler), or start the server without --dask",
            ) from error
        try:
            await self._client.wait_for_workers(1, timeout=WORKERS_S)
        except TimeoutError as error:
            raise WrongState(
                f"the Dask scheduler at {self._address} has no worker",
                f"start one where stepscope is installed: dask worker {self._address}",
            ) from error
        told = await self._client.get_versions(check=False, packages=list(PACKAGES))
        others = differences(told)
        if others:
            raise WrongState(
                f"workers of the Dask cluster at {self._address} have other packages than this server: "
                + "; ".join(others),
                "install the same there: constraints.txt names what this version was tested with",
            )
        self._threads = sum((await self._client.ncores()).values())
        return self._threads

    async def submit(self, job: TwinJob) -> dict[str, Any]:
        # Impure: two jobs with the same contents are two jobs.
        future = self._client.submit(run_job, job, pure=False)
        try:
            answer: dict[str, Any] = await asyncio.wait_for(future.result(), JOB_S)
        except TimeoutError as error:
            raise JobLost(f"no worker has tried setting {job.number} within {JOB_S:g} s") from error
        except asyncio.CancelledError:
            raise
        except Exception as error:  # whatever a worker or the way to it raised: KilledWorker, CommClosedError
            raise JobLost(f"setting {job.number} is lost: {type(error).__name__}: {error}") from error
        finally:
            future.release()
        return answer

    async def close(self) -> None:
        if self._client is not None:
            await self._client.close(timeout=ANSWER_S)


def require_dask() -> Any:
    """The package `distributed`. Raises WrongState with what to install where it is not there."""
    try:
        return importlib.import_module("distributed")
    except ImportError as error:
        raise WrongState("Dask is not installed here", f"install it with the extra: {EXTRA}") from error


def differences(told: Mapping[str, Any]) -> list[str]:
    """What each worker has other than this process: "tcp://10.0.0.2:4711 has numba 0.62, not 0.63". At most five.

    `told` as Client.get_versions has it.
    """
    here = _versions(told["client"])
    found = []
    for worker, versions in sorted(told["workers"].items()):
        there = _versions(versions)
        wrong = [
            f"{name} {there.get(name) or 'not at all'}, not {version}"
            for name, version in here.items()
            if there.get(name) != version
        ]
        if wrong:
            found.append(f"{worker} has {', '.join(wrong)}")
    return found if len(found) <= 5 else [*found[:5], f"and {len(found) - 5} more"]


def _versions(of: Mapping[str, Any]) -> dict[str, str | None]:
    python = str(of["host"]["python"]).rsplit(".", 2)[0]
    return {"python": ".".join(python.split(".")[:2]), **{name: of["packages"].get(name) for name in PACKAGES}}
