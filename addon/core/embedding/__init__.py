"""Classical scaling, the layout, the push, SMACOF, the pairs of equation 10."""
