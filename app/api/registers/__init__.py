"""Registers and raw frames over REST."""
