"""TMCL modules on an emulated line, and their control port."""
