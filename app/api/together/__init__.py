"""Several devices as one machine: wires between emulated chips, and moves that start together."""
