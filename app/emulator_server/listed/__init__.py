"""Chips and modules of which only names are known on a line, and their control port."""
