"""Array types, ramps, sparse factorisation, matrix products in blocks."""
