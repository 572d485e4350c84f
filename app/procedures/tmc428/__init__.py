"""Procedures that are the TMC428 family's own."""
