"""Procedures that are the TMC5xxx's own."""
