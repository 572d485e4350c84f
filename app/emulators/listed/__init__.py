"""Plain emulated modules of the package: parameters hold what was written, and axes move by their own."""
