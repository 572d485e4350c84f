"""Extended positions over REST: beyond a counter's range, and turns."""
