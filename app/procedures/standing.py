"""Whether a motor stands where it was seen."""

from __future__ import annotations

from ..devices.core.results import AxisState


class Standing:
    """Whether a motor stands, by two looks in a row that find it at the same place.

    Position and velocity are read one after the other: the last step may be done in between, and then one look shows
    a motor at rest where it is not any more.
    """

    def __init__(self) -> None:
        self._at: int | None = None

    def seen(self, state: AxisState) -> bool:
        """Take a look, and say whether it stands now."""
        at = None if state.moving else state.position
        stands = at is not None and at == self._at
        self._at = at
        return stands
