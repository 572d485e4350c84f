"""The 3D twin: one axis as a motor with what it moves, drawn by viser in a process of its own."""
