"""Ramps of every family: what a chip does with its parameters, and parameters for what is wanted."""
