"""Modules that the maker's Python package lists: their parameters, read from it on demand."""
