"""What studies know of TMCL modules alone."""
