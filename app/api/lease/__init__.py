"""Who has the bench: the one session that may change something."""
