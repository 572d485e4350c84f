"""What every emulated chip or module has: the far end of a wire, its faults, the truth behind it."""
