"""Array types, vectors as columns, ramps, sparse factorisation, matrix products in blocks."""
