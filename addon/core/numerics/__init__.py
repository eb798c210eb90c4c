"""Array types, vectors as columns, ramps, choice by shares, sparse factorisation, matrix products in blocks."""
