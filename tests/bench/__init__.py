"""`make bench`: what was promised, measured, with its peer or limit in the same run."""
