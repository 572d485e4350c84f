"""The study whose space, moves and objectives its document states."""
