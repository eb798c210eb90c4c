"""Rigid alignment, mirror images, crossings, measures of a form and of the detail that it keeps."""
