"""Modules that the maker's Python package lists: their parameters, read from it when somebody asks for them."""
