"""Axes: moving, stopping, procedures, limits, events."""
