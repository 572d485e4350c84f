"""What models, wires and channels there are."""
