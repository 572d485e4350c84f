"""Register maps that people bring along: files that say what registers a chip has."""
