"""Drivers of chips of which a table of registers is known and nothing else, wherever the table came from."""
