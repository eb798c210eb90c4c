"""Skeletons: which bones are arms and legs, where they stand in a T-pose, how the skin follows them."""
