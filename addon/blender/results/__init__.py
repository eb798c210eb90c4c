"""Results on an object: written, varied, moved by sliders, and cleared."""
