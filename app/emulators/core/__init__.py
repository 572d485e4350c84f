"""What every emulated chip or module has: the emulator base, its faults, the ground truth behind it."""
