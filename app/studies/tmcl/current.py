"""Where a TMCL module keeps its current: 255 is its greatest, of which the driver makes 32 steps (FM-PD42-1241 4)."""

from __future__ import annotations

from ..current_settings import CurrentPlaces
from ..field_settings import Place

CURRENT = CurrentPlaces(Place("maximum_current"), Place("standby_current"), steps=32, per=8)
