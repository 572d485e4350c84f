"""Settings tried on emulated twins of an axis: what a twin is, who runs it, and the search that asks them."""
