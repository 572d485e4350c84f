"""What every kind of reference search tells of itself."""

from __future__ import annotations

from abc import abstractmethod
from dataclasses import dataclass
from typing import Literal

from ..errors import OutOfRange
from .procedure import Procedure, State

Switch = Literal["left", "right", "reference"]

PHASES = ("prepare", "leave", "first edge", "second edge", "to the centre")
"""Of a search for both edges of a switch."""
SLACK_S = 5.0
"""What a phase may take beyond the time that its way takes at the search speed, device time [s]."""


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
    stall: bool = False
    """Whether it is a search by stall; `edges` are its hits."""


@dataclass(frozen=True, slots=True)
class SearchWanted:
    """What a search is to do; None: as the device has it.

    `switch` at `velocity_pps` for a chip; `mode` and its two speeds for a module, which searches by itself
    """

    switch: Switch = "reference"
    velocity_pps: float | None = None
    max_travel: int | None = None
    mode: int | None = None
    search_speed_pps: float | None = None
    switch_speed_pps: float | None = None


IDLE = ReferenceSearchState("idle", "", 0.0, [], None, None, "")


class Search(Procedure):
    """A reference search, whoever does it."""

    kind = "reference search"

    @property
    @abstractmethod
    def state(self) -> ReferenceSearchState:
        """How far it is, or how it ended."""


def check_figures(velocity_pps: float | None, max_travel: int | None, travel_bits: int) -> None:
    """Raises OutOfRange for a speed or a way that cannot be."""
    if velocity_pps is not None and not velocity_pps > 0:
        raise OutOfRange("velocity", velocity_pps, 0, None, "above 0")
    if max_travel is not None and not 1 <= max_travel < 1 << travel_bits:
        raise OutOfRange("max_travel", max_travel, 1, (1 << travel_bits) - 1)
