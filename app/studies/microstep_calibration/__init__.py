"""The study that fits the microstep table to its motor."""
