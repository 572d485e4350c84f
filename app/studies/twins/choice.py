"""Which executor a server has: a Dask cluster where its settings name one, else processes of its own."""

from __future__ import annotations

from collections.abc import Callable

from ...clock import Clock, WallClock
from .dask_cluster import DaskCluster, require_dask
from .executor import Executor
from .local import Here, Processes


def executor_of(clock: Clock, dask: str | None) -> Callable[[], Executor]:
    """What makes one for each search. Raises WrongState for a cluster without the package that it takes."""
    if dask is not None:
        require_dask()
        return lambda: DaskCluster(dask)
    return Processes if isinstance(clock, WallClock) else Here
