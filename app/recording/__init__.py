"""Recordings as they are made, kept, and replayed. Nothing here knows HTTP."""
