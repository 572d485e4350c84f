"""What the calculators know of the drivers alone."""
