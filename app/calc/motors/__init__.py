"""Stepper motors by name."""
