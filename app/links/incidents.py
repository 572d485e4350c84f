"""What went wrong on a line and was put right, told to whoever wants to know why a value is late."""

from __future__ import annotations

import time
from collections import Counter, deque
from dataclasses import dataclass
from typing import Literal

IncidentKind = Literal[
    "timeout",  # no answer in time
    "short",  # half an answer
    "checksum",  # an answer with a wrong checksum
    "mismatch",  # an answer to another question, or of another module
    "damaged",  # the module could not read what we sent
    "foreign",  # bytes that nobody asked for: another master talks on the line
    "late",  # an answer that came after we had given it up, thrown away
    "resync",  # line and we are in step again
    "out of step",  # the question that gets us in step was not answered
    "opened",
    "down",  # gone, refused, taken by another process
]
INCIDENTS_KEPT = 200


@dataclass(frozen=True, slots=True)
class Incident:
    time_unix_s: float
    kind: IncidentKind
    text: str


class Incidents:
    """A ring of the last `INCIDENTS_KEPT`, and how many of each kind there ever were. Any thread may add."""

    def __init__(self) -> None:
        self._ring: deque[Incident] = deque(maxlen=INCIDENTS_KEPT)
        self._counts: Counter[IncidentKind] = Counter()

    def add(self, kind: IncidentKind, text: str) -> None:
        self._ring.append(Incident(time.time(), kind, text))
        self._counts[kind] += 1

    @property
    def counts(self) -> dict[IncidentKind, int]:
        """How many of each kind since the line was made, the forgotten ones too."""
        return dict(self._counts)

    def list(self) -> list[Incident]:
        """Oldest first."""
        return list(self._ring)
