"""Who may come in: named tokens, sessions, logging out."""
