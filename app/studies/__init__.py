"""Studies: find a setting of an axis by trying, prove that it is better, and put it back when it is not."""
