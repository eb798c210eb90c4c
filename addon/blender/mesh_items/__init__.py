"""Shape keys, vertex groups, colours and drivers, and which of them are active, by name; fingerprints; the palette."""
