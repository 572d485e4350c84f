"""Recordings over REST: begun, listed, compared, replayed."""
