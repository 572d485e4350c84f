"""The study of which setting of SpreadCycle shakes the motor least."""
