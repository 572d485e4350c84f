"""The 3D view behind our own origin."""
