"""Calculators of the TMC5xxx."""
