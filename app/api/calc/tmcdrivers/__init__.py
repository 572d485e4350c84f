"""Calculators of the drivers alone."""
