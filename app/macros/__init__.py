"""Macros: small sequences of steps for a device, made of what was done to it, tried on an emulator, and run."""
