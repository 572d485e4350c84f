"""One condition an axis: judged from what its driver tells, kept, and told to whoever listens."""
