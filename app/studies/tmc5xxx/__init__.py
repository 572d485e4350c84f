"""What studies know of the TMC5xxx family alone."""
