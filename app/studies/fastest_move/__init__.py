"""The study that finds the fastest ramp for a distance."""
