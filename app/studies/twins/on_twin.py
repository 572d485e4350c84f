"""What a kind of study gives so that its search may run on twins."""

from __future__ import annotations

from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from typing import Any

from ...clock import Clock
from ...devices.core.device import Device
from ..document import StudyDocument
from ..record import Trial
from ..search import Asked, Told


@dataclass(frozen=True, slots=True)
class OnTwin:
    """How one of its settings is tried, and what the search is told of it.

    try_one : on a twin that is used for nothing else, set as the axis is. Raises Failed, BenchError
    told : of a trial that is feasible or infeasible
    """

    try_one: Callable[[Device, int, Clock, StudyDocument, Asked], Coroutine[Any, Any, Trial]]
    told: Callable[[StudyDocument, Trial], Told]
