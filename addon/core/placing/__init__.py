"""Position and orientation of a form: as posed, upright, or aligned to a reference whose numbering it takes over."""
