"""Where a TMC5xxx keeps the scales of its current (DS-TMC5160 6.1)."""

from __future__ import annotations

from ..current_settings import CurrentPlaces
from ..field_settings import Place

CURRENT = CurrentPlaces(Place("IHOLD_IRUN", "irun"), Place("IHOLD_IRUN", "ihold"), steps=32)
