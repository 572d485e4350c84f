"""Between registers and physical units: pps, pps^2, turns, times, and how numbers are written."""
