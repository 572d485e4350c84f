"""Drivers of modules whose parameters are known by name: parts over TMCL, and what its standard meaning allows."""
