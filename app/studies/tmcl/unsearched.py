"""What of a TMCL module no search tries: short circuit protection (FM-TMCM-1161 6)."""

from __future__ import annotations

UNSEARCHED = frozenset({"short_protection_disable", "short_detection_time"})
