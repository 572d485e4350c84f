"""The log of what was done by whom: its routes, its wording, and who listens for it."""
