"""Start-up over REST: tried dry, or applied."""
