"""Layouts of the page's panels."""
