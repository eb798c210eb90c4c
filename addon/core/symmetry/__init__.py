"""Left and right of a surface: limbs told apart, which vertices mirror each other, forms held to that and upright."""
