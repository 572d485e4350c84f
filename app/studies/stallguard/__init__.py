"""The study that finds StallGuard's threshold, by free runs and runs into a stop."""
