"""Register tables: rows, one file a chip, each with its source."""
