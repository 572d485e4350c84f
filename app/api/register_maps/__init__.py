"""Register maps: kept, looked at, fetched and deleted."""
