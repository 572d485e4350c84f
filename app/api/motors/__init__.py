"""Motors by name."""
