"""Calculators of the TMC4361."""
