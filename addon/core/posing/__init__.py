"""Shapes between pose and form, everywhere or by limb."""
