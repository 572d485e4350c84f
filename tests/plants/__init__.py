"""Plants that are drawn from a seed: axes that no study knows."""
