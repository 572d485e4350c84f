"""Microstep tables and the driver chain's RAM over REST."""
