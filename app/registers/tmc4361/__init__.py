"""Table of the TMC4361, by subject."""
