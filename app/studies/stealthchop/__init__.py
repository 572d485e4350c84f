"""The study of StealthChop: its amplitudes, and the speed from which on SpreadCycle takes over without a jolt."""
