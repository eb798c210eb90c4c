"""Shapes between pose and form, everywhere or by limb; the pose of another body."""
