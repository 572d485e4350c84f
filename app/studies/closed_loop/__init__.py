"""The study that finds the gains of a position loop."""
