"""Two surfaces compared: corresponding limbs, alignment of one form to another, corresponding points."""
