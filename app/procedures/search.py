"""What every kind of reference search tells of itself."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Literal

from .procedure import Procedure

State = Literal["idle", "running", "done", "failed", "aborted"]


@dataclass(frozen=True, slots=True)
class ReferenceSearchState:
    """Names as in the REST contract. Positions in microsteps, as counted before the search set zero."""

    state: State
    phase: str
    progress: float
    edges: list[int]
    centre: int | None
    offset: int | None
    message: str
    mode: int | None = None
    """Of a search by the module itself (AP 193); None for one that stepscope does."""
    distance: int | None = None
    """Between the two stop switches, where the mode measures it (AP 196)."""
    last_position: int | None = None
    """Where the counter stood when it was set to 0 (AP 197)."""


IDLE = ReferenceSearchState("idle", "", 0.0, [], None, None, "")


class Search(Procedure):
    """A reference search, whoever does it."""

    kind = "reference search"

    @property
    @abstractmethod
    def state(self) -> ReferenceSearchState:
        """How far it is, or how it ended."""
