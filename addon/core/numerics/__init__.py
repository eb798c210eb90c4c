"""Array types, sparse factorisation, matrix products in blocks."""
