"""Profiles and the programs made of them, over REST."""
