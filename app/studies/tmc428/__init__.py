"""What studies know of the TMC428 family alone."""
