"""The study that finds out what an axis is."""
