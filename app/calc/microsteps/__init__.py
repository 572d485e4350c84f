"""Microstep tables: shapes, words, what a table does to current and torque."""
