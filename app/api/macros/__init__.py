"""Macros: kept with their revisions, made of the log, tried on a twin, and run."""
