"""Rigid alignment, mirror images, what is measured on a form."""
