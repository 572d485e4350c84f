"""Studies of axes over REST."""
