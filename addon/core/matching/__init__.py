"""Two surfaces beside each other: which limbs are the same, and the motion that lays one form onto another."""
