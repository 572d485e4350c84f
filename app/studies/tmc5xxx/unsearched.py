"""What of a TMC5xxx no search tries: short circuit protection, dead times, and how steps are counted (DS-TMC5160 6)."""

from __future__ import annotations

UNSEARCHED = frozenset({"diss2g", "diss2vs", "BBM_CLKS", "mres", "dedge"})
