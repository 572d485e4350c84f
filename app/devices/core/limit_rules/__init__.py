"""What a family says of its registers for soft limits to be kept: tables, frames, and an axis as it is now."""
