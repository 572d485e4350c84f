"""Procedures that a TMCL module runs by itself."""
