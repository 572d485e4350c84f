"""Positions: beyond a counter, within a turn, by an encoder."""
