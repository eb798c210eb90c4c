"""Skeletons: which bones are arms and legs, where they stand in a T-pose, how skin follows; one fitted to a body."""
