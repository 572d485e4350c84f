"""The drive's clockwork."""

from __future__ import annotations

TICK_CLOCKS = 256
"""Clocks from one tick to the next."""
