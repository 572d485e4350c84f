"""Procedures that are the TMC4361's own."""
