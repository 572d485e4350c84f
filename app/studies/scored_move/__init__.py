"""A move with the settings as they are, scored: for tuning by hand."""
