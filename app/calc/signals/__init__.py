"""Rows of samples: statistics, spectra, alignment, steps, filters."""
