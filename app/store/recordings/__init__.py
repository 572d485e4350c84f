"""Recordings on disk: rows as they come (`file`), what happened meanwhile (`marks`), and all of them (`library`)."""
