"""Profiles of modules of which only names are known."""
