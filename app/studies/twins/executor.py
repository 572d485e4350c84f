"""Who runs twins: one interface, whether here, in processes of this machine, or on a cluster."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Protocol

from ...devices.core.config import AxisSettings
from ...errors import WrongState

JOB_S = 120.0
"""A setting that no worker has answered for after that long is lost [s]."""


@dataclass(frozen=True, slots=True)
class TwinJob:
    """One setting to be tried on a twin: all that a worker needs to know. It can be pickled."""

    model: str
    clock_hz: float
    axes: tuple[AxisSettings, ...]
    axis: int
    profile: Mapping[str, Any]
    motor: Mapping[str, Any]
    document: Mapping[str, Any]
    number: int
    values: Mapping[str, float]


class JobLost(Exception):
    """Its worker is gone, or does not answer: that setting is not known, and nothing else is lost."""


class Executor(Protocol):
    """Runs twins. `close` it, whatever happened."""

    @property
    def where(self) -> str:
        """Where it runs them, as it stands behind a verb: "in 2 processes"."""
        ...

    async def ready(self) -> int:
        """How many settings it tries at once. Raises BenchError where it can run none."""
        ...

    async def submit(self, job: TwinJob) -> dict[str, Any]:
        """The trial that came of it, as JSON. Raises JobLost."""
        ...

    async def close(self) -> None:
        """End what runs yet, and let go of everything."""
        ...


def no_executor() -> Executor:
    """Where nobody said who runs twins. Raises WrongState."""
    raise WrongState("nothing runs twins here", "a server does")
