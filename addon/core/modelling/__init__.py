"""A human body made of simple solids, which provides the T-pose and the A-pose."""
