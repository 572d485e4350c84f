"""Between registers and the world: pps, pps^2, turns, times, and how numbers are written."""
