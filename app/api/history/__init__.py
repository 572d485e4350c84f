"""What was done to a device, and how it is undone, over REST."""
