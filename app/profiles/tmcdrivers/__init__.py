"""What this family has of its own in profiles."""
