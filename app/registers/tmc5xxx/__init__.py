"""Tables of the TMC5xxx, by subject."""
