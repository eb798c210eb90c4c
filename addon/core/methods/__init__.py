"""One file per method, discovered automatically: ours, readings of the paper, the rivals."""
