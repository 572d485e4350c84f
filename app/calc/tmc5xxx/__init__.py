"""Calculators of this family: what they know of each chip, coil current by scales and sense resistors, choppers."""
