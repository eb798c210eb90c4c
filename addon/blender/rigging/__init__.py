"""Gives bodies an armature, with skin bound to it and poses, and takes it away again."""
