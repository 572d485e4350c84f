"""TMCL programs as text and as bytes."""
