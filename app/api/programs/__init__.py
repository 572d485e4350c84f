"""Programs that a device executes by itself."""
