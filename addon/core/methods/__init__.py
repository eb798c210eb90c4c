"""One file per method, discovered automatically: ours, the paper to the letter, the rivals."""
