"""What the calculators know of each chip of this family."""
