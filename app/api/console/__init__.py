"""TMCL commands by hand."""
