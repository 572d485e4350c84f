"""Tables of the TMC428 family."""
