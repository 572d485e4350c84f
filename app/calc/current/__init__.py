"""Coil current: sense resistors, scales, choppers."""
