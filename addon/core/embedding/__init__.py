"""Classical scaling, the stress and its pairs, SMACOF, the start, landmarks that push each other apart."""
