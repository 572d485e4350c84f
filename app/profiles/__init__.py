"""Profiles: a device's whole configuration as a document, and from a document back into a device."""
