"""TMCL: commands, and the parameters of modules."""
