"""Skin that has grown together: found by what the body underneath explains, and parted."""
