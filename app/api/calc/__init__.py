"""Calculators over REST: ramps, pmul and pdiv, currents, units, input filters."""
