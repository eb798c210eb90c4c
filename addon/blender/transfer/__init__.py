"""Taking over what another object has: weights, UV maps, colours, shape keys and materials."""
