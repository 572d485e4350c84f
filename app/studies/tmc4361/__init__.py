"""What studies know of the TMC4361 family alone."""
