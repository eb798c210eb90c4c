"""Gives bodies an armature: the one that lends its bones read, the armature made, skin bound to it, and removed."""
