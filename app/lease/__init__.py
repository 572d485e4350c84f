"""Who has the bench: the one session that may change something. Nothing here knows HTTP."""
